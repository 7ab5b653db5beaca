#include "canopus/client/plc_address.hpp"

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::client {

std::expected<std::uint16_t, std::string> parse_plc_word(std::string_view text) {
  const std::string all = ascii::upper(text);
  std::string_view digits = all;
  int base = 10;
  if (digits.starts_with("0X")) {
    digits.remove_prefix(2);
    base = 16;
  } else if (digits.starts_with('H')) {
    digits.remove_prefix(1);
    base = 16;
  } else if (digits.ends_with('H')) {
    digits.remove_suffix(1);
    base = 16;
  } else if (digits.starts_with('K')) {
    digits.remove_prefix(1);
  }
  const auto value = ascii::parse_number<std::int64_t>(digits, base);
  const std::int64_t least = base == 16 ? 0 : -32768;
  if (!value || *value < least || *value > 0xFFFF)
    return std::unexpected(
        fmt::format("'{}' is no 16-bit value; expected -32768 to 65535, 0x0 to 0xFFFF or 0H to FFFFH", text));
  return static_cast<std::uint16_t>(*value);
}

std::expected<bool, std::string> parse_plc_bit(std::string_view text) {
  const std::string all = ascii::upper(text);
  if (all == "1" || all == "ON") return true;
  if (all == "0" || all == "OFF") return false;
  return std::unexpected(fmt::format("'{}' is no bit; expected 1, 0, ON or OFF", text));
}

}  // namespace canopus::client
