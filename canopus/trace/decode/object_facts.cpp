#include "canopus/trace/decode/object_facts.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/trace/decode/value_text.hpp"

namespace canopus::trace {
namespace {

using canopen::DataType;
using enum canopen::DataType;

struct Row {
  std::uint16_t index;
  std::string_view name;
  DataType type;          // of sub-index 00H of a VAR, or of 01H.. of an array
  bool has_subs = false;  // sub-index 00H is a count then
};

// [CiA 301 7.5.2, CiA 302-2, CiA 302-3]
constexpr std::array rows{
    Row{0x1000, "Device type", unsigned32},
    Row{0x1001, "Error register", unsigned8},
    Row{0x1002, "Manufacturer status register", unsigned32},
    Row{0x1003, "Pre-defined error field", unsigned32, true},
    Row{0x1005, "COB-ID SYNC message", unsigned32},
    Row{0x1006, "Communication cycle period", unsigned32},
    Row{0x1007, "Synchronous window length", unsigned32},
    Row{0x1008, "Manufacturer device name", visible_string},
    Row{0x1009, "Manufacturer hardware version", visible_string},
    Row{0x100A, "Manufacturer software version", visible_string},
    Row{0x100C, "Guard time", unsigned16},
    Row{0x100D, "Life time factor", unsigned8},
    Row{0x1010, "Store parameters", unsigned32, true},
    Row{0x1011, "Restore default parameters", unsigned32, true},
    Row{0x1012, "COB-ID time stamp object", unsigned32},
    Row{0x1013, "High resolution time stamp", unsigned32},
    Row{0x1014, "COB-ID EMCY", unsigned32},
    Row{0x1015, "Inhibit time EMCY", unsigned16},
    Row{0x1016, "Consumer heartbeat time", unsigned32, true},
    Row{0x1017, "Producer heartbeat time", unsigned16},
    Row{0x1018, "Identity object", unsigned32, true},
    Row{0x1019, "Synchronous counter overflow value", unsigned8},
    Row{0x1020, "Verify configuration", unsigned32, true},
    Row{0x1021, "Store EDS", domain},
    Row{0x1022, "Store format", unsigned8},
    Row{0x1028, "Emergency consumer", unsigned32, true},
    Row{0x1029, "Error behaviour", unsigned8, true},
    Row{0x102A, "NMT inhibit time", unsigned16},
    Row{0x1F20, "Store DCF", domain, true},
    Row{0x1F22, "Concise DCF", domain, true},
    Row{0x1F25, "Configuration request", unsigned32, true},
    Row{0x1F26, "Expected configuration date", unsigned32, true},
    Row{0x1F27, "Expected configuration time", unsigned32, true},
    Row{0x1F50, "Program data", domain, true},
    Row{0x1F51, "Program control", unsigned8, true},
    Row{0x1F56, "Program software identification", unsigned32, true},
    Row{0x1F57, "Flash status identification", unsigned32, true},
    Row{0x1F80, "NMT startup", unsigned32},
    Row{0x1F81, "NMT slave assignment", unsigned32, true},
    Row{0x1F82, "Request NMT", unsigned8, true},
    Row{0x1F83, "Request node guarding", unsigned8, true},
    Row{0x1F84, "Device type identification", unsigned32, true},
    Row{0x1F85, "Vendor identification", unsigned32, true},
    Row{0x1F86, "Product code", unsigned32, true},
    Row{0x1F87, "Revision number", unsigned32, true},
    Row{0x1F88, "Serial number", unsigned32, true},
    Row{0x1F89, "Boot time", unsigned32},
};

ObjectFacts pdo_facts(std::uint16_t index, std::uint8_t sub) {
  const bool transmits = index >= 0x1800;
  const bool mapping = (index & 0x0200U) != 0;
  const std::string head = fmt::format("{}PDO{} ", transmits ? "T" : "R", (index & 0x1FFU) + 1);
  if (mapping) return {head + "mapping", sub == 0 ? unsigned8 : unsigned32};
  switch (sub) {
    case 0: return {head + "communication", unsigned8};
    case 1: return {head + "COB-ID", unsigned32};
    case 2: return {head + "transmission type", unsigned8};
    case 3: return {head + "inhibit time", unsigned16};
    case 5: return {head + "event timer", unsigned16};
    case 6: return {head + "SYNC start value", unsigned8};
    default: return {head + "communication", none};
  }
}

bool is_pdo_communication(std::uint16_t index) noexcept {
  return (index >= 0x1400 && index <= 0x15FF) || (index >= 0x1800 && index <= 0x19FF);
}

}  // namespace

ObjectFacts object_facts(const canopen::DictionaryDescription* dictionary, std::uint16_t index,
                         std::uint8_t sub) {
  if (dictionary != nullptr) {
    if (const auto* object = dictionary->find(index)) {
      const auto entry = dictionary->find(*object, sub);
      const std::string_view whole = dictionary->name(*object);
      if (!entry) return {std::string(whole), none};
      const std::string_view own = dictionary->name(entry);
      if (object->uniform && sub != 0)  // its sub-indexes share one name
        return {fmt::format("{} [{:02X}]", whole, sub), entry.description->type};
      if (own.empty() || own == whole || object->highest_sub == 0)
        return {std::string(whole), entry.description->type};
      if (whole.empty() || own.starts_with(whole)) return {std::string(own), entry.description->type};
      return {fmt::format("{}: {}", whole, own), entry.description->type};
    }
  }
  if (index >= 0x1400 && index <= 0x1BFF) return pdo_facts(index, sub);
  if (index >= 0x1200 && index <= 0x12FF) {
    const bool server = index < 0x1280;
    return {fmt::format("SDO {} {}", server ? "server" : "client", (index & 0x7FU) + 1),
            sub == 0 || sub == 3 ? unsigned8 : unsigned32};
  }
  const auto* const row = std::ranges::lower_bound(rows, index, {}, &Row::index);
  if (row == rows.end() || row->index != index) return {};
  return {std::string(row->name), row->has_subs && sub == 0 ? unsigned8 : row->type};
}

std::string_view object_unit(std::uint16_t index, std::uint8_t sub) noexcept {
  if (is_pdo_communication(index)) return sub == 3 ? "x 100 us" : sub == 5 ? "ms" : "";
  switch (index) {
    case 0x1006:
    case 0x1007: return "us";
    case 0x100C:
    case 0x1017:
    case 0x1F89: return "ms";
    case 0x1F90: return sub == 0 || sub == 3 ? "" : "ms";
    case 0x1015:
    case 0x102A: return "x 100 us";
    default: return "";
  }
}

std::string object_value_text(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> value,
                              canopen::DataType type) {
  if (value.size() == 4) {
    const std::uint32_t number = can::load_u32(value);
    const bool is_mapping =
        ((index >= 0x1600 && index <= 0x17FF) || (index >= 0x1A00 && index <= 0x1BFF)) && sub != 0;
    if (is_mapping)
      return fmt::format("{}, {} bits", canopen::object_text(number >> 16, number >> 8 & 0xFFU),
                         number & 0xFFU);
    const bool is_cob_id =
        ((is_pdo_communication(index) || (index >= 0x1200 && index <= 0x12FF)) && (sub == 1 || sub == 2)) ||
        index == 0x1005 || index == 0x1012 || index == 0x1014 || index == 0x1028;
    if (is_cob_id || index == 0x1000 || index == 0x1018) return fmt::format("{:08X}H", number);
    if (index == 0x1010 && number == 0x65766173) return "\"save\"";
    if (index == 0x1011 && number == 0x64616F6C) return "\"load\"";
    if (index == 0x1016 && sub != 0)
      return fmt::format("node {}, {} ms", number >> 16 & 0xFFU, number & 0xFFFFU);
  }
  std::string text = value_text(value, type);
  if (const auto unit = object_unit(index, sub); !unit.empty()) text += fmt::format(" {}", unit);
  return text;
}

}  // namespace canopus::trace
