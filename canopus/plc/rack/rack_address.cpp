#include "canopus/plc/rack/rack_address.hpp"

#include <array>
#include <charconv>
#include <optional>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::plc {

namespace {

/// Device numbers have 24 bits on the wire.
constexpr std::uint32_t last_number = 0xFFFFFF;
constexpr std::uint32_t last_unit = 0xFF;
constexpr std::uint32_t own_cpu = 0x3E0;

std::optional<std::uint32_t> number(std::string_view digits, int base, std::uint32_t last) {
  const auto value = ascii::parse_number<std::uint32_t>(digits, base);
  return value && *value <= last ? value : std::nullopt;
}

std::string in_base(std::uint32_t value, int base) {
  std::array<char, 12> memory{};
  const auto [end, error] = std::to_chars(memory.data(), memory.data() + memory.size(), value, base);
  return ascii::upper({memory.data(), end});
}

/// In which the numbers of a device are written.
int base_of(Device device, unsigned io_base) {
  if (device == Device::x || device == Device::y) return static_cast<int>(io_base);
  return device_info(device).hexadecimal ? 16 : 10;
}

std::unexpected<std::string> not_an_address(std::string_view text, std::string_view why) {
  return std::unexpected("'" + std::string(text) + "' " + std::string(why) +
                         "; expected a device (D100, M0, X1F, W2A) or buffer memory (U0\\G25)");
}

std::expected<RackAddress, std::string> parse_buffer(std::string_view text, std::string_view upper_text) {
  const std::size_t slash = upper_text.find_first_of("\\/");
  const auto unit = number(upper_text.substr(1, slash - 1), 16, own_cpu);
  const std::string_view behind = upper_text.substr(slash + 1);
  if (behind.starts_with("HG")) {
    if (unit != own_cpu) return not_an_address(text, "has HG, which is the CPU's alone (U3E0\\HG0)");
    const auto address = number(behind.substr(2), 10, last_number);
    if (!address) return not_an_address(text, "has no decimal buffer memory address behind the HG");
    return RackAddress{false, Device::hg, 0, *address};
  }
  if (!unit || *unit > last_unit) return not_an_address(text, "has no unit number 0 to FF behind the U");
  if (!behind.starts_with('G')) return not_an_address(text, "has no G behind the unit");
  const auto address = number(behind.substr(1), 10, last_number);
  if (!address) return not_an_address(text, "has no decimal buffer memory address behind the G");
  return RackAddress{true, Device::d, static_cast<std::uint16_t>(16 * *unit), *address};
}

}  // namespace

std::expected<RackAddress, std::string> parse_rack_address(std::string_view text, unsigned io_base) {
  const std::string upper_text = ascii::upper(text);
  if (upper_text.starts_with('U') && upper_text.find_first_of("\\/") != std::string::npos)
    return parse_buffer(text, upper_text);
  // The longest name that is a device: SB before S, ZR before Z. B in "XB" is a digit.
  for (std::size_t length = 3; length > 0; --length) {
    if (upper_text.size() <= length) continue;
    const auto device = device_named(std::string_view(upper_text).substr(0, length));
    if (!device) continue;
    const int base = base_of(*device, io_base);
    const auto found = number(std::string_view(upper_text).substr(length), base, last_number);
    if (found) return RackAddress{false, *device, 0, *found};
    return not_an_address(text, base == 16  ? "has no hexadecimal number"
                                : base == 8 ? "has no octal number"
                                            : "has no decimal number");
  }
  if (upper_text.starts_with('U') && upper_text.find('G') != std::string::npos)
    return not_an_address(text, "lacks the backslash, which the shell eats unless it is quoted");
  return not_an_address(text, "is no device");
}

std::string to_text(const RackAddress& address, std::uint32_t offset, unsigned io_base) {
  const std::uint32_t at = address.number + offset;
  if (address.is_buffer) return "U" + in_base(address.head_address / 16, 16) + "\\G" + in_base(at, 10);
  const std::string_view name = device_info(address.device).name;
  return std::string(name) + in_base(at, base_of(address.device, io_base));
}

}  // namespace canopus::plc
