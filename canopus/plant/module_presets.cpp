#include <algorithm>

#include <fmt/ranges.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/plant/module_network.hpp"
#include "canopus/plant/plant_assembly.hpp"
#include "canopus/plc/rack/module_refresh.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::plant {

std::vector<unsigned> bit_rates_of(const module::DataSheet& data_sheet) {
  std::vector<unsigned> rates;
  for (const module::BusLength& length : data_sheet.bus_lengths) rates.push_back(length.kbps * 1000);
  std::ranges::sort(rates);
  return rates;
}

std::vector<text::FileError> preset_words(module::CommunicationModule& module,
                                          const module::DataSheet& data_sheet, const ModuleSection& section,
                                          const BusSection& bus) {
  text::FileErrors errors;
  const std::string_view model = section.model;
  if (!module.preset_bit_rate(bus.bit_rate)) {
    errors.add(section.place,
               "module: bus \"{}\" has {} bit/s, which the {} does not have; expected one of {}", bus.name,
               bus.bit_rate, model, fmt::join(bit_rates_of(data_sheet), ", "));
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
  return errors.release();
}

std::vector<text::FileError> preset_objects(module::CommunicationModule& module,
                                            const ModuleSection& section) {
  text::FileErrors errors;
  // Function modes may have dictionaries of their own: the one that it starts in counts.
  const auto initial = module.initial_node();
  const canopen::DictionaryDescription& objects =
      initial ? initial->objects.description() : module.node().dictionary().description();
  for (const text::ObjectSetting& setting : section.objects) {
    const auto [index, sub] = setting.object;
    const canopen::Entry entry = objects.find(index, sub);
    if (!entry) {
      errors.add(setting.place, "the {} has no object {}", section.model, canopen::object_text(index, sub));
      continue;
    }
    const auto bytes = text::encode(setting.value, entry.description->type);
    if (!bytes) {
      errors.add(setting.place, "{}: {}", canopen::object_text(index, sub), bytes.error());
    } else if (const auto code = module.preset_object(index, sub, *bytes); code != canopen::AbortCode::none) {
      errors.add(setting.place, "{}: the {} refuses the value: {}", canopen::object_text(index, sub),
                 section.model, canopen::describe(code));
    }
  }
  return errors.release();
}

std::vector<text::FileError> give_parameters(module::CommunicationModule& module,
                                             const ModuleSection& section) {
  text::FileErrors errors;
  if (!section.parameters) return errors.release();
  const ParametersSection& parameters = *section.parameters;
  if (!module.takes_parameters()) {
    errors.add(parameters.place, "parameters: the {} takes none from its CPU", section.model);
    return errors.release();
  }
  for (const BufferSetting& setting : parameters.buffer) {
    if (module.parameter_word(setting.address, setting.value)) continue;
    errors.add(setting.place,
               "parameters: G{} = {}: the {} does not take this value, or no parameter is this word",
               setting.address, setting.value, section.model);
  }
  for (const text::ObjectSetting& setting : parameters.objects) {
    const auto [index, sub] = setting.object;
    const canopen::Entry entry = module.node().dictionary().description().find(index, sub);
    if (!entry) {
      errors.add(setting.place, "parameters: the {} has no object {}", section.model,
                 canopen::object_text(index, sub));
      continue;
    }
    const auto bytes = text::encode(setting.value, entry.description->type);
    if (!bytes) {
      errors.add(setting.place, "parameters: {}: {}", canopen::object_text(index, sub), bytes.error());
    } else if (const auto code = module.parameter_object(index, sub, *bytes);
               code != canopen::AbortCode::none) {
      errors.add(setting.place, "parameters: {}: the {} refuses the value: {}",
                 canopen::object_text(index, sub), section.model, canopen::describe(code));
    }
  }
  const module::DataExchangeLayout& words = module.program_interface().process_data;
  constexpr std::uint32_t block = plc::ModuleRefresh::block_words;
  for (const ParametersSection::Block& wanted : parameters.blocks) {
    const auto fits = [&](module::BufferAddress first) {
      return wanted.address >= first && wanted.address - first + block <= words.words &&
             (wanted.address - first) % block == 0;
    };
    if (fits(words.receive_first) || fits(words.transmit_first)) continue;
    errors.add(
        wanted.place,
        "refresh: G{}: expected the first of 64 words of the RPDOs (G{}, G{} ...) or TPDOs (G{}, G{} ...)",
        wanted.address, words.receive_first, words.receive_first + block, words.transmit_first,
        words.transmit_first + block);
  }
  if (parameters.refresh) module.use_refresh();
  return errors.release();
}

std::vector<std::uint8_t> concise_dcf_of(const ParametersSection::Node& node,
                                         const canopen::DictionaryDescription& dictionary,
                                         text::FileErrors& errors) {
  const auto is_pdo = [](std::uint16_t index, std::uint16_t first) {
    return index >= first && index < first + 0x200;
  };
  struct Value {
    text::ObjectName object;
    std::vector<std::uint8_t> bytes;
    unsigned step;
  };
  std::vector<Value> values;
  for (const text::ObjectSetting& setting : node.objects) {
    const auto [index, sub] = setting.object;
    const canopen::Entry entry = dictionary.find(index, sub);
    if (!entry) {
      errors.add(setting.place, "parameters: node {} has no object {}", node.node,
                 canopen::object_text(index, sub));
      continue;
    }
    auto bytes = text::encode(setting.value, entry.description->type);
    if (!bytes) {
      errors.add(setting.place, "parameters: {}: {}", canopen::object_text(index, sub), bytes.error());
      continue;
    }
    const bool is_cob_id = sub == 1 && (is_pdo(index, 0x1400) || is_pdo(index, 0x1800));
    const bool is_count = sub == 0 && (is_pdo(index, 0x1600) || is_pdo(index, 0x1A00));
    const bool is_mapping = sub != 0 && (is_pdo(index, 0x1600) || is_pdo(index, 0x1A00));
    if (is_cob_id && bytes->size() == 4) {
      auto off = *bytes;
      off[3] |= 0x80;
      values.push_back({setting.object, std::move(off), 0});
    }
    if (is_count) values.push_back({setting.object, std::vector<std::uint8_t>(bytes->size(), 0), 1});
    values.push_back({setting.object, std::move(*bytes),
                      is_cob_id    ? 5U
                      : is_count   ? 4U
                      : is_mapping ? 3U
                                   : 2U});
  }
  std::ranges::stable_sort(values, {}, &Value::step);
  manager::ConciseDcfWriter writer;
  for (const Value& value : values) writer.add(value.object.index, value.object.sub, value.bytes);
  return writer.file();
}

}  // namespace canopus::plant
