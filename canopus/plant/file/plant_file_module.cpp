// The settings in a module's section of a plant file: objects, words, and the parameters of the engineering
// tools.

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/plc/rack/module_refresh.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

namespace {

std::optional<text::Scalar> scalar(const toml::node& node) {
  if (const auto* value = node.as_boolean()) return value->get();
  if (const auto* value = node.as_integer()) return value->get();
  if (const auto* value = node.as_floating_point()) return value->get();
  if (const auto* value = node.as_string()) return value->get();
  return std::nullopt;
}

/// "D1000", of devices that the CPU has.
std::expected<std::pair<plc::Device, std::uint32_t>, std::string> parse_refresh_device(
    std::string_view text, const plc::CpuModel& cpu) {
  const auto digits = static_cast<std::size_t>(std::ranges::find_if(text, ascii::is_digit) - text.begin());
  const auto device = plc::device_named(text.substr(0, digits));
  const auto wrong = [text](std::string_view why) {
    return std::unexpected(
        fmt::format("\"{}\": {}; expected a device of the CPU such as \"D1000\", or \"label\"", text, why));
  };
  if (!device) return wrong("there is no such device");
  const plc::DeviceInfo& info = plc::device_info(*device);
  const auto number = ascii::parse_number<std::uint32_t>(text.substr(digits), info.hexadecimal ? 16 : 10);
  if (!number) return wrong("its number is missing or wrong");
  const std::uint32_t points = plc::ModuleRefresh::block_words * (info.is_bit ? 16 : 1);
  if (cpu.points_of(*device) == 0) return wrong("the CPU does not have it");
  if (!cpu.has(*device, *number, points))
    return wrong(fmt::format("the CPU's last one is nearer than {} more", points));
  return std::pair{*device, *number};
}

std::optional<std::uint8_t> read_refresh_group(text::TableReader& table, bool required) {
  const auto group = table.integer("refresh_group", 1, 64, "a refresh group is 1 to 64", required);
  if (!group) return std::nullopt;
  return static_cast<std::uint8_t>(*group);
}

ParametersSection::Node read_parameter_node(text::TableReader& table) {
  ParametersSection::Node node{.place = table.place("node"), .eds_place = table.place("eds")};
  node.node =
      static_cast<std::uint8_t>(table.integer("node", 1, 127, "a node-ID is 1 to 127", true).value_or(0));
  node.eds = table.text("eds").value_or("");
  node.objects = read_objects(table, "objects");
  return node;
}

}  // namespace

std::vector<text::ObjectSetting> read_objects(text::TableReader& table, std::string_view key) {
  std::vector<text::ObjectSetting> settings;
  std::map<std::pair<unsigned, unsigned>, text::Place> seen;  // the table is in the order of its keys
  table.entries(key, [&](std::string_view name, const toml::node& node, text::Place place) {
    const auto object = text::parse_object(name);
    if (!object) return table.error(place, object.error());
    const auto value = scalar(node);
    if (!value) {
      return table.error(text::place_of(node.source()),
                         fmt::format("{} = {}: expected a number, a string, true or false", name,
                                     text::describe_found(node)));
    }
    const auto [other, is_new] = seen.try_emplace({object->index, object->sub}, place);
    if (!is_new) {
      const auto [first, second] = std::minmax(place, other->second);
      return table.error(second, fmt::format("{}: {} is there already, in line {}", key,
                                             canopen::object_text(object->index, object->sub), first.line));
    }
    settings.push_back({place, *object, *value});
  });
  return settings;
}

std::vector<BufferSetting> read_words(text::TableReader& table, std::string_view key) {
  std::vector<BufferSetting> settings;
  std::map<std::uint32_t, text::Place> seen;
  table.entries(key, [&](std::string_view name, const toml::node& node, text::Place place) {
    const auto address = text::parse_buffer_address(name);
    if (!address) return table.error(place, address.error());
    const auto* value = node.as_integer();
    if (value == nullptr || value->get() < -32768 || value->get() > 65535) {
      return table.error(text::place_of(node.source()),
                         fmt::format("{} = {}: a word is -32768 to 65535", name, text::describe_found(node)));
    }
    const auto [other, is_new] = seen.try_emplace(*address, place);
    if (!is_new) {
      const auto [first, second] = std::minmax(place, other->second);
      return table.error(second,
                         fmt::format("{}: G{} is there already, in line {}", key, *address, first.line));
    }
    settings.push_back({place, *address, static_cast<std::uint16_t>(value->get())});
  });
  std::ranges::sort(settings, {}, &BufferSetting::address);
  return settings;
}

ParametersSection read_parameters(text::TableReader& table, const plc::CpuModel& cpu) {
  ParametersSection parameters{.place = table.place(),
                               .refresh_place = table.place("refresh"),
                               .refresh_group_place = table.place("refresh_group")};
  parameters.buffer = read_words(table, "buffer");
  parameters.objects = read_objects(table, "objects");
  if (const auto way = table.text("data_exchange")) {
    if (*way != "refresh" && *way != "request")
      table.error("data_exchange", "expected \"request\" or \"refresh\"");
    parameters.refresh = *way == "refresh";
  }
  table.entries("refresh", [&](std::string_view name, const toml::node& node, text::Place place) {
    const auto address = text::parse_buffer_address(name);
    if (!address) return table.error(place, address.error());
    const auto* target = node.as_string();
    if (target != nullptr && target->get() == "label") {
      parameters.blocks.push_back({.place = place, .address = *address});
      return;
    }
    const auto device = target == nullptr
                            ? std::unexpected(fmt::format("{}: expected a device of the CPU such as "
                                                          "\"D1000\", or \"label\"",
                                                          text::describe_found(node)))
                            : parse_refresh_device(target->get(), cpu);
    if (!device)
      return table.error(text::place_of(node.source()),
                         fmt::format("refresh: {} = {}", name, device.error()));
    parameters.blocks.push_back({place, *address, device->first, device->second});
  });
  if (!parameters.blocks.empty() && !parameters.refresh) {
    table.error("refresh", "is for data_exchange = \"refresh\"");
  }
  if (const auto group = read_refresh_group(table, false)) {
    parameters.refresh_group = *group;
    if (!parameters.refresh) table.error("refresh_group", "is for data_exchange = \"refresh\"");
  }
  std::map<unsigned, text::Place> seen;
  table.tables("node", "plc.module.parameters.node", [&](text::TableReader& inner) {
    auto node = read_parameter_node(inner);
    if (node.node == 0) return;
    if (const auto [other, is_new] = seen.try_emplace(node.node, node.place); !is_new) {
      return inner.error("node",
                         fmt::format("node {} is there already, in line {}", node.node, other->second.line));
    }
    parameters.nodes.push_back(std::move(node));
  });
  return parameters;
}

/// Structured Text, an instruction list, PLCopen XML, a shared object, or a library that the program has.
static bool is_program_file(const std::string& path) {
  const std::string lower = ascii::lower(path);
  return lower.ends_with(".st") || lower.ends_with(".csv") || lower.ends_with(".xml") ||
         path.ends_with(".so") || path.starts_with(ProgramFile::library);
}

std::vector<ProgramFile> read_program_files(text::TableReader& table) {
  constexpr std::string_view expected =
      "expected files of Structured Text or instruction lists, such as [\"main.st\", \"MAIN.csv\"]";
  constexpr std::size_t most_files = 100;
  std::vector<ProgramFile> files;
  table.elements("program", [&](const toml::node& element) {
    const auto* const path = element.as_string();
    const text::Place place = text::place_of(element.source());
    if (path == nullptr || !is_program_file(path->get()))
      return table.error(place, fmt::format("program = {}: {}", text::describe_found(element), expected));
    if (files.size() == most_files)
      return table.error(place, fmt::format("program: expected at most {} files", most_files));
    files.push_back({place, path->get()});
  });
  if (files.empty() && !table.is_wrong("program") && table.errors().empty()) table.error("program", expected);
  return files;
}

bool has_program_files(text::TableReader& table) {
  const toml::node* const node = table.find("program");
  if (node == nullptr) return false;
  const auto* const list = node->as_array();
  return list == nullptr ||
         !std::ranges::any_of(*list, [](const toml::node& element) { return element.is_table(); });
}

std::vector<ProgramSection> read_programs(text::TableReader& table, const plc::CpuModel& cpu) {
  std::vector<ProgramSection> programs;
  std::map<std::string, text::Place> seen;
  table.tables("program", "plc.program", [&](text::TableReader& inner) {
    ProgramSection program{.place = inner.place(), .name = inner.text("name", true).value_or("")};
    program.refresh_group = read_refresh_group(inner, true).value_or(0);
    program.interval = inner.parsed("interval", text::parse_duration);
    if (program.interval && *program.interval < plc::Scan::shortest_period) {
      inner.error("interval", "a program is executed every 100us or less often");
      program.interval.reset();
    }
    if (cpu.family != plc::CpuFamily::iqr) {
      inner.error(inner.place(), "programs with a refresh group are a CPU's of the family iQ-R");
    }
    if (const auto [other, is_new] = seen.try_emplace(program.name, inner.place("name"));
        !is_new && !program.name.empty()) {
      inner.error("name", fmt::format("another program is \"{}\" already, in line {}", program.name,
                                      other->second.line));
    }
    programs.push_back(std::move(program));
  });
  return programs;
}

}  // namespace canopus::plant
