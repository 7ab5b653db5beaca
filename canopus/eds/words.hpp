#pragma once
// The words of EDS files and how people misspell them.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "canopus/canopen/dictionary/data_type.hpp"

namespace canopus::eds {

/// Without what these files have as blanks at both ends: also vertical tabulators, form feeds and carriage returns.
[[nodiscard]] std::string_view trim(std::string_view text) noexcept;
/// Lower case, without blanks, underscores and hyphens: what section and key names are compared by.
[[nodiscard]] std::string folded(std::string_view text);
/// True when one word can be meant by the other: at most two letters wrong, missing, too many or swapped in a
/// word of eight or more, one in a shorter one of five or more.
[[nodiscard]] bool is_misspelt(std::string_view word, std::string_view meant);
/// The one of `known` (all folded) that `word` is a misspelling of, or an empty view.
[[nodiscard]] std::string_view nearest(std::string_view word, std::span<const std::string_view> known);

/// As it is when it is UTF-8, else read as Windows Latin and converted.
[[nodiscard]] std::string to_utf8(std::string_view text);
/// UTF-16 without its byte order mark, to UTF-8. Half a pair is replaced.
[[nodiscard]] std::string from_utf16(std::string_view text, bool big_endian);
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

/// "UNSIGNED8", "U8", "uint8" ...
[[nodiscard]] std::optional<canopen::DataType> data_type(std::string_view word);
/// True for the indexes that canopen::DataType names (none excluded).
[[nodiscard]] bool is_data_type(std::uint64_t index) noexcept;
/// "VAR", "ARRAY", "RECORD" ...
[[nodiscard]] std::optional<canopen::ObjectCode> object_code(std::string_view word);
[[nodiscard]] bool is_object_code(std::uint64_t code) noexcept;
/// ro, wo, rw, rwr, rww, const in any case. `exact`: set to false when the word was another one for it.
[[nodiscard]] std::optional<canopen::Access> access(std::string_view word, bool& exact);

/// "VAR", "ARRAY" ...
[[nodiscard]] std::string_view name(canopen::ObjectCode code) noexcept;
/// "ro", "rwr" ...
[[nodiscard]] std::string_view name(canopen::Access access) noexcept;

}  // namespace canopus::eds
