#include "canopus/campaign/plant_access.hpp"

#include <span>

#include <fmt/format.h>

#include "canopus/module/interface/module.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::campaign {
namespace {

module::BufferMemoryAccess* buffer_of(const plc::Rack& rack, const plc::RackAddress& address) {
  module::Module* const module = rack.module_at(address.head_address);
  return module == nullptr ? nullptr : module->buffer_memory();
}

bool is_bit(const plc::RackAddress& address) { return plc::device_info(address.device).is_bit; }

}  // namespace

std::string names_there_are(std::string_view name, const std::vector<std::string>& known) {
  constexpr std::size_t shown = 12;
  std::vector<std::string_view> names;
  for (const std::string& each : known) {
    if (!each.empty()) names.push_back(each);
  }
  if (const std::string_view meant = text::nearest(name, names); !meant.empty())
    return fmt::format("; did you mean \"{}\"?", meant);
  if (names.empty()) return "; it has none with a name";
  if (names.size() > shown) {
    names.resize(shown);
    return "; expected " + text::one_of(names) + ", or one of those after them";
  }
  return "; expected " + text::one_of(names);
}

FoundNumber find_device(const plant::Plant& plant, const std::string& name) {
  const auto& devices = plant.file().devices;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (devices[i].name == name) return i;
  }
  std::vector<std::string> names;
  for (const plant::DeviceSection& device : devices) names.push_back(device.name);
  return std::unexpected(fmt::format("device = \"{}\": the plant has no device of this name{}", name,
                                     names_there_are(name, names)));
}

FoundNumber find_plc(const plant::Plant& plant, const std::string& name) {
  if (name.empty() && plant.plc_count() == 1) return 0U;
  for (std::size_t i = 0; i < plant.plc_count(); ++i) {
    if (!name.empty() && plant.plc_section(i).name == name) return i;
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < plant.plc_count(); ++i) names.push_back(plant.plc_section(i).name);
  if (name.empty())
    return std::unexpected(fmt::format("plc is missing; the plant has {} of them{}", plant.plc_count(),
                                       names_there_are("", names)));
  return std::unexpected(
      fmt::format("plc = \"{}\": the plant has no PLC of this name{}", name, names_there_are(name, names)));
}

std::expected<plc::RackAddress, std::string> find_word(plc::Rack& rack, const std::string& word) {
  const auto address = plc::parse_rack_address(word, rack.model().number_base(plc::Device::x));
  if (!address) return std::unexpected("word: " + address.error());
  const module::BufferMemoryAccess* const buffer = address->is_buffer ? buffer_of(rack, *address) : nullptr;
  const bool is_there = address->is_buffer
                            ? buffer != nullptr && address->number < buffer->buffer_memory_size()
                            : rack.model().has(address->device, address->number, 1);
  if (!is_there) return std::unexpected(fmt::format("word: the PLC has no {}", word));
  return *address;
}

std::optional<std::uint16_t> peek(plc::Rack& rack, const plc::RackAddress& address, can::Time now) {
  if (address.is_buffer) {
    const module::BufferMemoryAccess* const buffer = buffer_of(rack, address);
    return buffer == nullptr ? std::nullopt : std::optional(buffer->peek(address.number, now));
  }
  std::uint16_t word = 0;
  if (is_bit(address)) {
    std::uint8_t bit = 0;
    if (!rack.read_bits(address.device, address.number, std::span(&bit, 1), now)) return std::nullopt;
    word = bit;
  } else if (!rack.read_words(address.device, address.number, std::span(&word, 1), now)) {
    return std::nullopt;
  }
  return word;
}

void write_word(plc::Rack& rack, const plc::RackAddress& address, std::uint16_t value, can::Time now) {
  const std::uint8_t bit = value == 0 ? 0 : 1;
  if (address.is_buffer) {
    (void)rack.write_buffer(address.head_address, address.number, std::span(&value, 1), now);
  } else if (is_bit(address)) {
    (void)rack.write_bits(address.device, address.number, std::span(&bit, 1), now);
  } else {
    (void)rack.write_words(address.device, address.number, std::span(&value, 1), now);
  }
}

}  // namespace canopus::campaign
