#include "canopus/trace/decode/value_words.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "canopus/canopen/service/nmt.hpp"
#include "canopus/trace/decode/object_facts.hpp"

namespace canopus::trace {
namespace {

using canopen::DictionaryDescription;

struct Choice {
  std::int64_t value;
  std::string_view text;
};

/// A state is shown by some bits of a word.
struct StateRow {
  std::uint16_t mask;
  std::uint16_t value;
  std::string_view text;
};

constexpr std::array<std::string_view, 8> register_bits{"generic",        "current",       "voltage",
                                                        "temperature",    "communication", "device profile",
                                                        "reserved bit 6", "manufacturer"};

// [CiA 402-2 8.4.2]
constexpr std::array drive_states{
    StateRow{0x4F, 0x00, "not ready to switch on"}, StateRow{0x4F, 0x40, "switch on disabled"},
    StateRow{0x6F, 0x21, "ready to switch on"},     StateRow{0x6F, 0x23, "switched on"},
    StateRow{0x6F, 0x27, "operation enabled"},      StateRow{0x6F, 0x07, "quick stop active"},
    StateRow{0x4F, 0x0F, "fault reaction active"},  StateRow{0x4F, 0x08, "fault"},
};
constexpr std::array<std::string_view, 16> statusword_bits{
    "ready to switch on", "switched on", "operation enabled",   "fault",
    "voltage enabled",    "quick stop",  "switch on disabled",  "warning",
    "manufacturer bit 8", "remote",      "target reached",      "internal limit active",
    "mode bit 12",        "mode bit 13", "manufacturer bit 14", "manufacturer bit 15"};

// [CiA 402-2 8.4.1]. Bit 3 alone tells "switch on" from "enable operation".
constexpr std::array drive_commands{
    StateRow{0x87, 0x06, "shutdown"},         StateRow{0x8F, 0x07, "switch on, or disable operation"},
    StateRow{0x8F, 0x0F, "enable operation"}, StateRow{0x82, 0x00, "disable voltage"},
    StateRow{0x86, 0x02, "quick stop"},       StateRow{0x80, 0x80, "fault reset"},
};
constexpr std::array<std::string_view, 16> controlword_bits{
    "switch on",           "enable voltage",      "quick stop",
    "enable operation",    "mode bit 4",          "mode bit 5",
    "mode bit 6",          "fault reset",         "halt",
    "mode bit 9",          "reserved bit 10",     "manufacturer bit 11",
    "manufacturer bit 12", "manufacturer bit 13", "manufacturer bit 14",
    "manufacturer bit 15"};

// 6060H and 6061H [CiA 402-2 8.4.4].
constexpr std::array drive_modes{
    Choice{0, "no mode"},
    Choice{1, "profile position"},
    Choice{2, "velocity"},
    Choice{3, "profile velocity"},
    Choice{4, "profile torque"},
    Choice{6, "homing"},
    Choice{7, "interpolated position"},
    Choice{8, "cyclic synchronous position"},
    Choice{9, "cyclic synchronous velocity"},
    Choice{10, "cyclic synchronous torque"},
    Choice{11, "cyclic synchronous torque with commutation angle"},
};
constexpr std::array mode_objects{0x6060, 0x6061};

// 1F82H when it is read [CiA 302-2]; the states of a running node are those of its heartbeat.
constexpr std::array node_states{
    Choice{0, "state unknown"},
    Choice{1, "node missing"},
};
constexpr std::array error_behaviours{
    Choice{0, "to pre-operational"},
    Choice{1, "no change"},
    Choice{2, "to stopped"},
};
constexpr std::array program_states{
    Choice{0, "stopped"},
    Choice{1, "started"},
    Choice{2, "no program"},
};

struct UnitRow {
  std::uint16_t index;
  std::string_view unit;
};
// Objects whose unit CiA 402-2 fixes; positions and velocities are in the device's own.
constexpr std::array drive_units{
    UnitRow{0x6066, "ms"},      UnitRow{0x6068, "ms"},      UnitRow{0x606E, "ms"},
    UnitRow{0x6070, "ms"},      UnitRow{0x6071, "x 0.1 %"}, UnitRow{0x6072, "x 0.1 %"},
    UnitRow{0x6073, "x 0.1 %"}, UnitRow{0x6074, "x 0.1 %"}, UnitRow{0x6075, "mA"},
    UnitRow{0x6076, "mNm"},     UnitRow{0x6077, "x 0.1 %"}, UnitRow{0x6078, "x 0.1 %"},
    UnitRow{0x6079, "mV"},
};

bool is_drive(const DictionaryDescription* dictionary) noexcept {
  if (dictionary == nullptr) return false;
  const canopen::Entry type = dictionary->find(0x1000, 0);
  constexpr std::uint64_t profile = 0xFFFF;
  constexpr std::uint64_t drives = 402;
  return type && (dictionary->default_value(type, 1) & profile) == drives;
}

std::string_view choice(std::span<const Choice> choices, std::int64_t value) {
  const auto found = std::ranges::find(choices, value, &Choice::value);
  return found == choices.end() ? std::string_view{} : found->text;
}

std::string_view state(std::span<const StateRow> rows, std::uint64_t value) {
  const auto found =
      std::ranges::find_if(rows, [value](const StateRow& row) { return (value & row.mask) == row.value; });
  return found == rows.end() ? std::string_view{} : found->text;
}

std::vector<std::string_view> bits(std::span<const std::string_view> names, std::uint64_t value) {
  std::vector<std::string_view> set;
  for (std::size_t bit = 0; bit < names.size(); ++bit) {
    if ((value >> bit & 1U) != 0) set.push_back(names[bit]);
  }
  return set;
}

std::string_view mode_name(std::uint64_t value) {
  const auto mode = static_cast<std::int8_t>(value);
  return mode < 0 ? "mode of the manufacturer" : choice(drive_modes, mode);
}

/// 6502H has bit 0 for mode 1.
std::vector<std::string_view> supported_modes(std::uint64_t value) {
  std::vector<std::string_view> modes;
  for (const Choice& mode : drive_modes) {
    if (mode.value > 0 && (value >> (mode.value - 1) & 1U) != 0) modes.push_back(mode.text);
  }
  return modes;
}

std::string_view node_state(std::uint64_t value) {
  if (const std::string_view text = choice(node_states, static_cast<std::int64_t>(value)); !text.empty())
    return text;
  if (value > 0xFF) return {};
  const std::string_view text = canopen::name(static_cast<canopen::NmtState>(value));
  return text == "unknown" ? std::string_view{} : text;
}

ValueWords drive_words(std::uint16_t index, std::uint64_t value) {
  if (index == 0x6040) return {state(drive_commands, value), bits(controlword_bits, value)};
  if (index == 0x6041) return {state(drive_states, value), bits(statusword_bits, value)};
  if (index == 0x6502) return {{}, supported_modes(value)};
  if (std::ranges::find(mode_objects, index) != mode_objects.end()) return {mode_name(value), {}};
  return {};
}

}  // namespace

std::string ValueWords::text() const {
  std::string list;
  for (const std::string_view bit : bits) {
    if (bit == state) continue;
    if (!list.empty()) list += ", ";
    list += bit;
  }
  if (state.empty()) return list;
  return list.empty() ? std::string(state) : std::string(state) + " (" + list + ")";
}

ValueWords value_words(const DictionaryDescription* dictionary, std::uint16_t index, std::uint8_t sub,
                       std::uint64_t value) {
  const auto number = static_cast<std::int64_t>(value);
  switch (index) {
    case 0x1001:
      if (value == 0) return {"no error", {}};
      return {{}, error_register_bits(static_cast<std::uint8_t>(value))};
    case 0x1029: return {sub != 0 ? choice(error_behaviours, number) : std::string_view{}, {}};
    case 0x1F51: return {sub != 0 ? choice(program_states, number) : std::string_view{}, {}};
    case 0x1F82: return {sub != 0 ? node_state(value) : std::string_view{}, {}};
    default: break;
  }
  return is_drive(dictionary) ? drive_words(index, value) : ValueWords{};
}

std::string_view value_unit(const DictionaryDescription* dictionary, std::uint16_t index,
                            std::uint8_t sub) noexcept {
  if (index < 0x6000) return object_unit(index, sub);
  const auto found = std::ranges::find(drive_units, index, &UnitRow::index);
  return found != drive_units.end() && is_drive(dictionary) ? found->unit : std::string_view{};
}

std::vector<std::string_view> error_register_bits(std::uint8_t error_register) {
  return bits(register_bits, error_register);
}

}  // namespace canopus::trace
