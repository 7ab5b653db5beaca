#include "canopus/client/plc_point.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::client {
namespace {

using Kind = PlcPoint::Kind;
using plc::Device;

struct TableName {
  std::string_view name;
  Kind kind;
};
constexpr std::array tables = {TableName{"coil", Kind::coils}, TableName{"discrete", Kind::discrete_inputs},
                               TableName{"holding", Kind::holding_registers},
                               TableName{"input", Kind::input_registers}};

/// Device names of an AS300; HC alone is a 32-bit value, which one word cannot show.
struct DeviceName {
  std::string_view name;
  Device device;
};
constexpr std::array devices_of_as300 = {
    DeviceName{"M", Device::m},   DeviceName{"SM", Device::sm}, DeviceName{"S", Device::s},
    DeviceName{"TS", Device::ts}, DeviceName{"T", Device::tn},  DeviceName{"CS", Device::cs},
    DeviceName{"C", Device::cn},  DeviceName{"D", Device::d},   DeviceName{"SR", Device::sd},
    DeviceName{"X", Device::x},   DeviceName{"Y", Device::y},   DeviceName{"HCS", Device::hcs},
};

std::optional<std::uint32_t> number_up_to(std::string_view digits, std::uint32_t last) {
  const auto value = ascii::parse_number<std::uint32_t>(digits);
  return value && *value <= last ? value : std::nullopt;
}

std::unexpected<std::string> no_point(std::string_view text, std::string_view why) {
  return std::unexpected(
      fmt::format("'{}' {}; expected a device of an AS300 (D100, SR7, M0, X0.5, X0, Y1.15, T5) or a Modbus "
                  "address (coil:5, "
                  "discrete:5, holding:5, input:5)",
                  text, why));
}

constexpr std::uint32_t last_address = 0xFFFF;

std::expected<PlcPoint, std::string> parse_modbus(std::string_view text) {
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    const auto* table = std::ranges::find(tables, text.substr(0, colon), &TableName::name);
    if (table == tables.end()) return no_point(text, "has no table before the colon");
    const auto address = number_up_to(text.substr(colon + 1), last_address);
    if (!address) return no_point(text, "has no address 0 to 65535 behind the colon");
    return PlcPoint{table->kind, {.number = *address}};
  }
  const std::string all = ascii::upper(text);
  const std::size_t letters = std::min(all.find_first_of("0123456789"), all.size());
  const std::string_view name = std::string_view(all).substr(0, letters);
  std::string_view digits = std::string_view(all).substr(letters);
  if (name == "HC")
    return no_point(text, "has 32 bits: its contact is HCS, its value two words from holding:64512 on");
  const auto* found = std::ranges::find(devices_of_as300, name, &DeviceName::name);
  if (found == devices_of_as300.end()) return no_point(text, "is no device");
  const bool has_words = found->device == Device::x || found->device == Device::y;
  const std::size_t dot = digits.find('.');
  if (has_words && dot != std::string_view::npos) {
    const auto word = number_up_to(digits.substr(0, dot), last_address);
    const auto bit = number_up_to(digits.substr(dot + 1), 15);
    if (!word || !bit) return no_point(text, "has no word and bit 0 to 15");
    return PlcPoint{Kind::rack, {.device = found->device, .number = 16 * *word + *bit}};
  }
  const auto at = number_up_to(digits, last_address);
  if (!at) return no_point(text, "has no decimal number");
  return PlcPoint{has_words ? Kind::words_of_bits : Kind::rack, {.device = found->device, .number = *at}};
}

std::string modbus_text(const PlcPoint& point, std::uint32_t number) {
  const auto* table = std::ranges::find(tables, point.kind, &TableName::kind);
  if (table != tables.end()) return fmt::format("{}:{}", table->name, number);
  const auto* name = std::ranges::find(devices_of_as300, point.at.device, &DeviceName::device);
  const std::string_view letters = name == devices_of_as300.end() ? "" : name->name;
  const bool is_io = point.at.device == Device::x || point.at.device == Device::y;
  if (is_io && point.kind == Kind::rack) return fmt::format("{}{}.{}", letters, number / 16, number % 16);
  return fmt::format("{}{}", letters, number);
}

unsigned io_base(PlcNotation notation) { return notation == PlcNotation::melsec_octal ? 8 : 16; }

}  // namespace

bool PlcPoint::is_bit() const noexcept {
  switch (kind) {
    case Kind::rack: return !at.is_buffer && plc::device_info(at.device).is_bit;
    case Kind::coils:
    case Kind::discrete_inputs: return true;
    case Kind::words_of_bits:
    case Kind::holding_registers:
    case Kind::input_registers: break;
  }
  return false;
}

bool PlcPoint::is_in_one_row_with(const PlcPoint& other) const noexcept {
  return kind == other.kind && at.is_buffer == other.at.is_buffer &&
         (at.is_buffer ? at.head_address == other.at.head_address : at.device == other.at.device);
}

std::expected<PlcPoint, std::string> parse_plc_point(std::string_view text, PlcNotation notation) {
  if (notation == PlcNotation::modbus) return parse_modbus(text);
  const auto found = plc::parse_rack_address(text, io_base(notation));
  if (!found) return std::unexpected(found.error());
  return PlcPoint{Kind::rack, *found};
}

std::string to_text(const PlcPoint& point, std::uint32_t offset, PlcNotation notation) {
  if (notation == PlcNotation::modbus) return modbus_text(point, point.at.number + offset);
  return plc::to_text(point.at, offset, io_base(notation));
}

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
