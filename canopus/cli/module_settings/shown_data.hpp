#pragma once
// Bytes of an object in the forms in which the configuration tool shows them.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace canopus::cli {

/// "hexadecimal", "decimal", "floating point" (4 or 8 bytes) and "ASCII", each with its text; of more than 8 bytes no numbers.
[[nodiscard]] std::vector<std::pair<std::string_view, std::string>> shown_data(
    std::span<const std::uint8_t> bytes);

}  // namespace canopus::cli
