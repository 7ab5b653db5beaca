#include "canopus/trace/decode/object_facts.hpp"

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/standard_objects.hpp"
#include "canopus/trace/decode/value_text.hpp"

namespace canopus::trace {
namespace {

using canopen::DataType;
using enum canopen::DataType;

ObjectFacts pdo_facts(std::uint16_t index, std::uint8_t sub) {
  const bool transmits = index >= 0x1800;
  const bool mapping = (index & 0x0200U) != 0;
  const std::string head = fmt::format("{}PDO{} ", transmits ? "T" : "R", (index & 0x1FFU) + 1);
  const DataType type = eds::standard_type(index, sub).value_or(none);
  if (mapping) return {head + "mapping", type};
  switch (sub) {
    case 1: return {head + "COB-ID", type};
    case 2: return {head + "transmission type", type};
    case 3: return {head + "inhibit time", type};
    case 5: return {head + "event timer", type};
    case 6: return {head + "SYNC start value", type};
    default: return {head + "communication", type};
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
            eds::standard_type(index, sub).value_or(none)};
  }
  return {std::string(eds::standard_name(index)), eds::standard_type(index, sub).value_or(none)};
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
      return fmt::format("{}, {}", canopen::object_text(number >> 16, number >> 8 & 0xFFU),
                         ascii::counted(number & 0xFFU, "bit"));
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
