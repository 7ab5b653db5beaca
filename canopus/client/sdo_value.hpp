#pragma once
// Values of objects as people write and read them on the command line, and the bytes an SDO carries for them.

#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/data_type.hpp"
#include "canopus/text/json.hpp"

namespace canopus::client {

/// bool; i8 i16 i24 i32 i40 i48 i56 i64, u8 ... u64; f32 f64; text (VISIBLE_STRING), unicode
/// (UNICODE_STRING), bytes (OCTET_STRING), domain.
[[nodiscard]] std::optional<canopen::DataType> parse_type(std::string_view name);
/// All names.
[[nodiscard]] std::vector<std::string_view> type_names();
/// "u32"; empty for a type that has no name here.
[[nodiscard]] std::string_view type_name(canopen::DataType type);

/// The bytes for a value as text: numbers decimal, 0x.. or ..H, negative where the type is signed; bytes and
/// domains in hexadecimal digits, blanks between them allowed; true false 1 0; text as it is. The error is a
/// sentence: "300 does not fit u8: expected 0 to 255".
[[nodiscard]] std::expected<std::vector<std::uint8_t>, std::string> encode_value(std::string_view text,
                                                                                 canopen::DataType type);

/// The value as text: "405  00000195H", "-5  FFFBH", "1.5", "\"drive\"", "true", "11 22 33". The error is a
/// wrong length for the type: "4 bytes came, u16 has 2".
[[nodiscard]] std::expected<std::string, std::string> show_value(std::span<const std::uint8_t> bytes,
                                                                 canopen::DataType type);
/// The same for bytes of unknown type: the hexadecimal bytes, and what they mean as a number or as text if
/// they can mean it.
[[nodiscard]] std::string show_bytes(std::span<const std::uint8_t> bytes);
/// The value as JSON; null when the length does not fit the type.
[[nodiscard]] text::Json json_value(std::span<const std::uint8_t> bytes, canopen::DataType type);

/// "00 11 AA", without a blank "0011AA".
[[nodiscard]] std::string hexadecimal(std::span<const std::uint8_t> bytes, std::string_view between = " ");

}  // namespace canopus::client
