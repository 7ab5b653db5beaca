#include "canopus/module_settings/mappable_objects.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace canopus::module_settings {
namespace {

// The network variables of CiA 405 that the modules have: outputs of the PLC from A000H on, inputs from A480H on [CiA 405 6].
constexpr std::uint16_t first_mappable_variable = 0xA000;
constexpr std::uint16_t distance_to_received = 0x480;
constexpr std::uint8_t last_sub_index = 0xFE;
constexpr std::uint16_t last_dummy = 7;  // [CiA 301 7.4.7.1]
constexpr std::array<std::uint8_t, 3> widths{8, 16, 32};

std::string name_of_object(const module::ConfigurationTool& model, std::uint32_t index, std::uint32_t sub,
                           std::uint32_t bits) {
  return model.object_name(index << 16 | sub << 8 | bits);
}

void add_object(std::vector<MappableObjects>& all, const std::string& text, std::uint8_t bits,
                MappableObject object) {
  const std::size_t comma = text.find(", ");
  std::string name = text.substr(0, comma);
  if (comma != std::string::npos) object.description = text.substr(comma + 2);
  auto found = std::ranges::find_if(
      all, [&](const MappableObjects& one) { return one.bits == bits && one.name == name; });
  if (found == all.end()) found = all.insert(all.end(), {.name = std::move(name), .bits = bits});
  found->objects.push_back(std::move(object));
}

void add_variables_of(const module::ConfigurationTool& model, std::uint16_t index,
                      std::vector<MappableObjects>& all) {
  for (const std::uint8_t bits : widths) {
    for (std::uint8_t sub = 1; sub <= last_sub_index; ++sub) {
      const std::string text = name_of_object(model, index, sub, bits);
      if (text.empty()) break;
      add_object(all, text, bits, {.index = index, .sub = sub});
    }
  }
}

}  // namespace

std::vector<MappableObjects> mappable_objects(const module::ConfigurationTool& model, const Window& window) {
  std::vector<MappableObjects> all;
  if (window.mapping == 0) return all;
  constexpr std::uint16_t transmit_mapping = 0x1A00;
  const bool receives = window.mapping != transmit_mapping;
  const std::uint16_t first =
      static_cast<std::uint16_t>(first_mappable_variable + (receives ? distance_to_received : 0));
  for (std::uint16_t index = first; index < first + distance_to_received; ++index)
    add_variables_of(model, index, all);
  // Nothing can be sent from a dummy.
  for (std::uint16_t index = 1; receives && index <= last_dummy; ++index) {
    for (const std::uint8_t bits : widths) {
      const std::string text = name_of_object(model, index, 0, bits);
      if (text.ends_with(" " + std::to_string(bits) + " bit")) add_object(all, text, bits, {.index = index});
    }
  }
  return all;
}

}  // namespace canopus::module_settings
