#pragma once
// Values as the ASCII gateway of CiA 309-3 writes them, and the bytes that an SDO or PDO carries for them.

#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::client {

/// Takes the next word off the front: up to a blank, or a string in double quotes with them. Empty: there is none.
[[nodiscard]] std::string_view next_gateway_word(std::string_view& line) noexcept;
/// A whole word as a number the way C writes it: 12, 0x0C, 014. None: it is no number, or too large.
[[nodiscard]] std::optional<std::uint64_t> gateway_number(std::string_view word) noexcept;

/// b; i8 ... i64, u8 ... u64 in whole bytes; x8 ... x64 (unsigned, shown in hexadecimal, as CANopenNode has it); r32 r64;
/// t td (days and ms); vs; os us d (base64); hex (bytes in hexadecimal digits, as CANopenNode has it).
struct GatewayType {
  enum class Kind : std::uint8_t {
    boolean,
    integer,
    unsigned_integer,
    hexadecimal,
    real,
    time,
    text,
    base64,
    bytes
  };
  Kind kind = Kind::bytes;
  unsigned bits = 0;  ///< of numbers; 1 for a boolean, 48 for times

  friend bool operator==(const GatewayType&, const GatewayType&) = default;
};
[[nodiscard]] std::optional<GatewayType> parse_gateway_type(std::string_view name) noexcept;

/// The bytes of the value that the rest of a line gives. None: it is no such value.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> encode_gateway_value(std::string_view text,
                                                                            GatewayType type);
/// The value as text, in one line. None: the bytes are not as long as the type.
[[nodiscard]] std::optional<std::string> show_gateway_value(std::span<const std::uint8_t> bytes,
                                                            GatewayType type);

}  // namespace canopus::client
