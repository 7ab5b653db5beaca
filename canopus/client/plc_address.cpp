#include "canopus/client/plc_address.hpp"

#include <charconv>
#include <optional>

#include <fmt/format.h>

namespace canopus::client {

namespace {

using plc::melsec::Target;

/// Device numbers have 24 bits on the wire.
constexpr std::uint32_t last_number = 0xFFFFFF;
constexpr std::uint32_t last_unit = 0xFF;

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& character : result)
    if (character >= 'a' && character <= 'z') character = static_cast<char>(character - 'a' + 'A');
  return result;
}

std::optional<std::int64_t> number(std::string_view digits, int base) {
  std::int64_t value = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value, base);
  if (digits.empty() || error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

std::unexpected<std::string> not_an_address(std::string_view text, std::string_view why) {
  return std::unexpected(
      fmt::format("'{}' {}; expected a device (D100, M0, X1F, W2A) or buffer memory (U0\\G25)", text, why));
}

std::expected<Target, std::string> parse_buffer(std::string_view text, const std::string& upper_text) {
  const std::size_t slash = upper_text.find_first_of("\\/");
  const auto unit = number(std::string_view(upper_text).substr(1, slash - 1), 16);
  if (!unit || *unit < 0 || *unit > last_unit)
    return not_an_address(text, "has no unit number 0 to FF behind the U");
  const std::string_view behind = std::string_view(upper_text).substr(slash + 1);
  if (!behind.starts_with('G')) return not_an_address(text, "has no G behind the unit");
  const auto address = number(behind.substr(1), 10);
  if (!address || *address < 0 || *address > last_number)
    return not_an_address(text, "has no decimal buffer memory address behind the G");
  return Target{true, plc::Device::d, static_cast<std::uint16_t>(16 * *unit),
                static_cast<std::uint32_t>(*address)};
}

}  // namespace

std::expected<Target, std::string> parse_plc_address(std::string_view text) {
  const std::string upper_text = upper(text);
  if (upper_text.starts_with('U') && upper_text.find_first_of("\\/") != std::string::npos)
    return parse_buffer(text, upper_text);
  // The longest name that is a device: SB before S, ZR before Z. B in "XB" is a digit.
  for (std::size_t length = 3; length > 0; --length) {
    if (upper_text.size() <= length) continue;
    const auto device = plc::device_named(std::string_view(upper_text).substr(0, length));
    if (!device) continue;
    const bool hexadecimal = plc::device_info(*device).hexadecimal;
    const auto found = number(std::string_view(upper_text).substr(length), hexadecimal ? 16 : 10);
    if (found && *found >= 0 && *found <= last_number)
      return Target{false, *device, 0, static_cast<std::uint32_t>(*found)};
    return not_an_address(text, hexadecimal ? "has no hexadecimal number" : "has no decimal number");
  }
  if (upper_text.starts_with('U') && upper_text.find('G') != std::string::npos)
    return not_an_address(text, "lacks the backslash, which the shell eats unless it is quoted");
  return not_an_address(text, "is no device");
}

std::string plc_address(const Target& target, std::uint32_t offset) {
  const std::uint32_t at = target.number + offset;
  if (target.is_buffer) return fmt::format("U{:X}\\G{}", target.head_address / 16, at);
  const plc::DeviceInfo& info = plc::device_info(target.device);
  return info.hexadecimal ? fmt::format("{}{:X}", info.name, at) : fmt::format("{}{}", info.name, at);
}

std::expected<std::uint16_t, std::string> parse_plc_word(std::string_view text) {
  const std::string all = upper(text);
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
  const auto value = number(digits, base);
  const std::int64_t least = base == 16 ? 0 : -32768;
  if (!value || *value < least || *value > 0xFFFF)
    return std::unexpected(
        fmt::format("'{}' is no 16-bit value; expected -32768 to 65535, 0x0 to 0xFFFF or 0H to FFFFH", text));
  return static_cast<std::uint16_t>(*value);
}

std::expected<bool, std::string> parse_plc_bit(std::string_view text) {
  const std::string all = upper(text);
  if (all == "1" || all == "ON") return true;
  if (all == "0" || all == "OFF") return false;
  return std::unexpected(fmt::format("'{}' is no bit; expected 1, 0, ON or OFF", text));
}

}  // namespace canopus::client
