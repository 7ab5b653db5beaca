#include "canopus/plant/module_presets.hpp"

#include <algorithm>

#include <fmt/ranges.h>

#include "canopus/plant/module_network.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::plant {

namespace {

std::vector<unsigned> bit_rates(const module::DataSheet& data_sheet) {
  std::vector<unsigned> rates;
  for (const module::BusLength& length : data_sheet.bus_lengths) rates.push_back(length.kbps * 1000);
  std::ranges::sort(rates);
  return rates;
}

}  // namespace

std::vector<text::FileError> preset_words(module::CommunicationModule& module,
                                          const module::DataSheet& data_sheet, const ModuleSection& section,
                                          const BusSection& bus) {
  text::FileErrors errors;
  const std::string_view model = section.model;
  if (!module.preset_bit_rate(bus.bit_rate)) {
    errors.add(section.place,
               "module: bus \"{}\" has {} bit/s, which the {} does not have; expected one of {}", bus.name,
               bus.bit_rate, model, fmt::join(bit_rates(data_sheet), ", "));
  }
  if (section.node != 0 && !module.preset_node_id(section.node)) {
    errors.add(section.place, "module: node = {}: the {} cannot have this node-ID", section.node, model);
  }
  for (const BufferSetting& setting : section.buffer) {
    if (module.preset_word(setting.address, setting.value)) continue;
    errors.add(setting.place, "G{} = {}: the {} does not take this value, or does not save this word",
               setting.address, setting.value, model);
  }
  if (const auto wrong = module.layer2_preset_error()) {
    const auto setting = std::ranges::find(section.buffer, *wrong, &BufferSetting::address);
    errors.add(setting == section.buffer.end() ? section.place : setting->place,
               "G{}: the {} does not go online in its Layer 2 mode with this word, or without it", *wrong,
               model);
  }
  if (section.online && module.program_interface().online.kind == module::ProgramRequest::Kind::none) {
    errors.add(section.place, "module: online = true: the {} has no Layer 2 mode", model);
  }
  for (const BufferSetting& word : section.writes) {
    if (module.takes_word(word.address, word.value)) continue;
    errors.add(word.place, "write: G{} = {}: the {} does not take this", word.address, word.value, model);
  }
  const module::BufferMemoryAccess* buffer = module.buffer_memory();
  const module::BufferAddress words = buffer == nullptr ? 0 : buffer->buffer_memory_size();
  for (const std::uint32_t address : section.watch) {
    if (address < words) continue;
    errors.add(section.place, "module: watch: G{}: the {} has {} words of buffer memory", address, model,
               words);
  }
  return errors.take();
}

std::vector<text::FileError> preset_objects(module::CommunicationModule& module,
                                            const ModuleSection& section) {
  text::FileErrors errors;
  for (const text::ObjectSetting& setting : section.objects) {
    const auto [index, sub] = setting.object;
    const canopen::Entry entry = module.node().dictionary().description().find(index, sub);
    if (!entry) {
      errors.add(setting.place, "the {} has no object {:04X}H:{:02X}H", section.model, index, sub);
      continue;
    }
    const auto bytes = text::encode(setting.value, entry.description->type);
    if (!bytes) {
      errors.add(setting.place, "{:04X}H:{:02X}H: {}", index, sub, bytes.error());
    } else if (const auto code = module.preset_object(index, sub, *bytes); code != canopen::AbortCode::none) {
      errors.add(setting.place, "{:04X}H:{:02X}H: the {} refuses the value: {}", index, sub, section.model,
                 canopen::describe(code));
    }
  }
  return errors.take();
}

}  // namespace canopus::plant
