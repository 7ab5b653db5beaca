#include "canopus/eds/configuration_text.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "canopus/eds/draft.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/eds/xdd.hpp"

namespace canopus::eds {
namespace {

using Done = std::expected<void, std::string>;

constexpr std::string_view xml_is_no_ini = "this is XML, an XDD or XDC, and no EDS or DCF";

/// The section and key of a value in the file.
struct ValuePlace {
  std::string section;
  std::string key;
  bool is_list = false;  // of a compact object
};

std::expected<ValuePlace, std::string> value_place(const IniText& file, const DeviceFile& device,
                                                   std::uint16_t index, std::uint8_t sub) {
  const canopen::ObjectDescription* object = device.dictionary->find(index);
  if (object == nullptr) return std::unexpected("the file has no object " + object_name(index));
  const EntryFacts* facts = device.find_facts(index, sub);
  if (facts == nullptr || !device.dictionary->find(index, sub)) {
    return std::unexpected("the file has no sub-index " + object_text(index, sub));
  }
  std::string head;
  for (const std::string& section : file.sections()) {
    const auto meaning = object_section(section);
    if (!meaning || meaning->index != index) continue;
    if (meaning->kind == ObjectSection::Kind::head && head.empty()) head = section;
    // By its line: some files count sub-indexes in decimal, which the reader has found out.
    if (meaning->kind == ObjectSection::Kind::sub && file.section_line(section) == facts->line) {
      return ValuePlace{section, "ParameterValue", false};
    }
  }
  const auto compact = read_number(file.value(head, "CompactSubObj").value_or(""));
  if (!head.empty() && compact && compact->magnitude != 0 && sub != 0) {
    return ValuePlace{file.has_section(head + "values") ? head + "values" : head + "value",
                      std::to_string(sub), true};
  }
  if (!head.empty() && sub == 0 && file.section_line(head) == facts->line &&
      (!compact || compact->magnitude == 0)) {
    const auto code = device.dictionary->find(index)->code;
    if (code == canopen::ObjectCode::variable || code == canopen::ObjectCode::domain) {
      return ValuePlace{head, "ParameterValue", false};
    }
  }
  return std::unexpected("the file has no section for " + object_text(index, sub) +
                         ", so no place for its value");
}

/// NrOfEntries of a list of values follows.
Done count_entries(IniText& file, const std::string& section) {
  const auto keys = file.keys(section);
  const auto count = std::ranges::count_if(keys, [](const std::string& key) {
    return key.find_first_not_of("0123456789abcdefx") == std::string::npos;
  });
  const auto announced = read_number(file.value(section, "NrOfEntries").value_or(""));
  if (announced && announced->magnitude == static_cast<std::uint64_t>(count)) return {};
  return file.set(section, "NrOfEntries", std::to_string(count));
}

Done set_in_list(IniText& file, const ValuePlace& place, std::uint16_t index, std::string_view value) {
  std::string section = place.section;
  if (!file.has_section(section)) {
    const std::string name = object_name(index);  // 2000H
    section = name.substr(0, 4) + "Value";
    if (const Done done = file.set(section, "NrOfEntries", "0"); !done) return done;
  }
  if (const Done done = file.set(section, place.key, value); !done) return done;
  return count_entries(file, section);
}

/// "; expected 0 to 255"; nothing for types that are no whole numbers.
std::string expected_range(canopen::DataType type) {
  if (!is_number(type) || type == canopen::DataType::real32 || type == canopen::DataType::real64) return {};
  const auto [low, high] = range(type);
  const auto text = [&](std::uint64_t value) {
    return canopen::is_signed(type) ? std::to_string(static_cast<std::int64_t>(value))
                                    : std::to_string(value);
  };
  return "; expected " + text(low) + " to " + text(high);
}

Done set_key(IniText& file, std::string_view section, std::string_view key, std::string_view value) {
  if (value.empty()) return {};
  return file.set(section, key, value);
}

}  // namespace

std::string value_problem(const canopen::DictionaryDescription& dictionary, const canopen::Entry& entry,
                          std::string_view key, std::string_view value) {
  const canopen::DataType type = entry.description->type;
  Problems problems;
  Item item;
  item.key = key;
  item.value = value;
  const auto read = read_value(type, {problems, item, entry.index, entry.sub});
  for (const Problem& problem : problems.release()) {
    if (problem.severity == Problem::Severity::note) continue;
    return problem.message.substr(0, problem.message.find(": taken as")) + expected_range(type);
  }
  if (!read)
    return '"' + printable(value) + "\" is no value of " + object_text(entry.index, entry.sub) +
           expected_range(type);
  const canopen::Limits& limits = dictionary.limits(entry);
  if (read->adds_node_id || !is_number(type)) return {};
  const std::uint64_t number = pattern(type, read->bytes);
  const bool is_low = limits.low && less(type, number, *limits.low);
  if (!is_low && !(limits.high && less(type, *limits.high, number))) return {};
  return item.key + '=' + printable(value) + " of " + object_text(entry.index, entry.sub) + " is " +
         (is_low ? "below its LowLimit" : "above its HighLimit");
}

std::string commissioning_problem(const Commissioning& commissioning) {
  constexpr std::size_t longest_name = 246;  // [CiA 306-1]
  if (!commissioning.node_id || *commissioning.node_id < 1 || *commissioning.node_id > 127) {
    return "a node-ID is 1 to 127";
  }
  for (const std::string* name : {&commissioning.node_name, &commissioning.network_name}) {
    if (name->size() <= longest_name) continue;
    return "\"" + printable(*name) + "\": a name has at most " + std::to_string(longest_name) + " letters";
  }
  return {};
}

Done set_parameter_value(IniText& file, std::uint16_t index, std::uint8_t sub, std::string_view value) {
  if (trim(value).empty()) return std::unexpected("no value is given for " + object_text(index, sub));
  const std::string text = file.text();
  if (is_xml(text)) return std::unexpected(std::string(xml_is_no_ini));
  const ReadResult read = read_device_file(text);
  if (read.file == nullptr) return std::unexpected(read.problems.front().message);
  const auto place = value_place(file, *read.file, index, sub);
  if (!place) return std::unexpected(place.error());
  const auto& dictionary = *read.file->dictionary;
  std::string problem = value_problem(dictionary, dictionary.find(index, sub), "ParameterValue", value);
  if (!problem.empty()) return std::unexpected(std::move(problem));
  IniText changed = file;
  const Done done = place->is_list ? set_in_list(changed, *place, index, value)
                                   : changed.set(place->section, place->key, value);
  if (!done) return done;
  file = std::move(changed);
  return {};
}

Done remove_parameter_value(IniText& file, std::uint16_t index, std::uint8_t sub) {
  const std::string text = file.text();
  if (is_xml(text)) return std::unexpected(std::string(xml_is_no_ini));
  const ReadResult read = read_device_file(text);
  if (read.file == nullptr) return std::unexpected(read.problems.front().message);
  const auto place = value_place(file, *read.file, index, sub);
  if (!place) return std::unexpected(place.error());
  if (!file.value(place->section, place->key)) return {};
  IniText changed = file;
  if (const Done done = changed.remove(place->section, place->key); !done) return done;
  if (place->is_list) {
    if (const Done done = count_entries(changed, place->section); !done) return done;
  }
  file = std::move(changed);
  return {};
}

std::expected<IniText, std::string> make_configuration(std::string_view eds, const ConfigurationNames& names,
                                                       const Commissioning& commissioning) {
  if (is_xml(eds)) return std::unexpected("line 1: " + std::string(xml_is_no_ini));
  IniText file(eds);
  const ReadResult read = read_device_file(eds);
  if (read.file == nullptr) {
    return std::unexpected("line " + std::to_string(read.problems.front().line) + ": " +
                           read.problems.front().message);
  }
  if (std::string problem = commissioning_problem(commissioning); !problem.empty()) {
    return std::unexpected(std::move(problem));
  }
  const auto number = [](std::uint64_t value) { return value == 0 ? std::string() : std::to_string(value); };
  // [CiA 306] spells it with one m; others do not, and the reader takes either.
  const bool is_spelt_well =
      !file.has_section("DeviceComissioning") && file.has_section("DeviceCommissioning");
  const std::string_view section = is_spelt_well ? "DeviceCommissioning" : "DeviceComissioning";
  struct Row {
    std::string_view section;
    std::string_view key;
    std::string value;
  };
  const std::array rows = {
      Row{"FileInfo", "FileName", names.file_name},
      Row{"FileInfo", "LastEDS", names.eds_name},
      Row{section, "NodeID", number(*commissioning.node_id)},
      Row{section, "NodeName", commissioning.node_name},
      Row{section, "Baudrate", number(commissioning.bit_rate / 1000)},
      Row{section, "NetNumber", number(commissioning.net_number)},
      Row{section, "NetworkName", commissioning.network_name},
      Row{section, "CANopenManager", commissioning.canopen_manager ? "1" : ""},
      Row{section, "LSS_SerialNumber", number(commissioning.lss_serial_number)},
  };
  for (const Row& row : rows) {
    if (const Done done = set_key(file, row.section, row.key, row.value); !done) {
      return std::unexpected(std::string(row.key) + ": " + done.error());
    }
  }
  return file;
}

}  // namespace canopus::eds
