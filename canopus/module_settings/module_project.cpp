#include "canopus/module_settings/module_project.hpp"

#include <algorithm>
#include <chrono>
#include <sstream>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/xml/document.hpp"
#include "canopus/manager/nmt/flying_master.hpp"

namespace canopus::module_settings {
namespace {

constexpr std::uint32_t highest_can_id = 0x57F;
constexpr std::size_t longest_name = 256;  // [RJ71CN91 3.1]
constexpr std::string_view new_name = "CANopen node";
constexpr std::size_t most_from_cpu = 60;  // nodes whose settings the CPU module holds [RJ71CN91 3.1]
constexpr std::uint32_t from_cpu = 0, from_here = 1;  // Download target

const Field* field_of(const Window& window, std::string_view name) noexcept {
  const auto found =
      std::ranges::find_if(window.fields, [&](const Field& field) { return field.name == name; });
  return found == window.fields.end() ? nullptr : &*found;
}

std::string place_of(const Window& window, std::uint32_t key) {
  return window.key.empty() ? std::string(window.word) : fmt::format("{} {}", window.word, key);
}

/// A field that the range alone does not judge; empty: good.
std::string why_not_cob_id(std::uint32_t value) {
  if ((value & 0x7FF) <= highest_can_id && (value & 0x3FFF'F800) == 0) return {};
  if ((value & 0x3FFF'F800) != 0)
    return fmt::format("COB-ID = 0x{:08X}: expected an 11-bit CAN-ID, and bits 30 and 31", value);
  return fmt::format("CAN-ID (11-bit) = 0x{:03X}: expected 0x000 to 0x{:03X}", value & 0x7FF, highest_can_id);
}

std::string why_not_value(const Field& field, std::uint32_t value) {
  if (std::string wrong = why_not(field, value); !wrong.empty()) return wrong;
  return field.name == "COB-ID" ? why_not_cob_id(value) : std::string();
}

}  // namespace

std::string why_no_mapping(const std::vector<std::uint32_t>& mapping) {
  unsigned bits = 0;
  for (const std::uint32_t entry : mapping) {
    const unsigned length = entry & 0xFF;
    if (length == 0 || length > 64 || length % 8 != 0) {
      return fmt::format("mapped object 0x{:08X}: {}; expected 8, 16, 32 and so on", entry,
                         ascii::counted(length, "bit"));
    }
    bits += length;
  }
  if (mapping.size() > 8) return fmt::format("{} mapped objects: expected at most 8", mapping.size());
  return bits <= 64 ? std::string()
                    : fmt::format("the mapped objects have {} bits: expected at most 64", bits);
}

std::string why_no_name(std::string_view name) {
  std::size_t characters = 0;
  for (std::size_t at = 0; at < name.size(); ++characters) {
    const auto first = static_cast<unsigned char>(name[at]);
    const std::size_t bytes = first < 0x80    ? 1
                              : first >= 0xF0 ? 4
                              : first >= 0xE0 ? 3
                              : first >= 0xC2 ? 2
                                              : 0;
    bool good = bytes != 0 && first < 0xF5 && at + bytes <= name.size() && first >= 0x20 && first != 0x7F;
    for (std::size_t i = 1; good && i < bytes; ++i)
      good = (static_cast<unsigned char>(name[at + i]) & 0xC0) == 0x80;
    if (!good) return fmt::format("character {} cannot be in a name", characters + 1);
    at += bytes;
  }
  if (characters > 0 && name.find_first_not_of(' ') == std::string_view::npos)
    return "blanks alone are no name";
  if (characters >= 1 && characters <= longest_name) return {};
  return fmt::format("{} characters: expected 1 to {}", characters, longest_name);
}

ModuleProject::ModuleProject(const module::ConfigurationTool& tool) : tool_(&tool) {
  for (const Window& window : tool.windows) restore_defaults(window);
}

const Window* ModuleProject::window(std::string_view word) const noexcept {
  const auto found =
      std::ranges::find_if(tool_->windows, [&](const Window& window) { return window.word == word; });
  return found == tool_->windows.end() ? nullptr : &*found;
}

const std::map<std::uint32_t, Row>& ModuleProject::rows(const Window& window) const {
  return rows_.at(window.word);
}

std::uint32_t ModuleProject::value(std::string_view word, std::string_view name,
                                   std::uint32_t key) const noexcept {
  const Window* const in = window(word);
  const Field* const field = in == nullptr ? nullptr : field_of(*in, name);
  if (field == nullptr) return 0;
  const auto window_rows = rows_.find(in->word);
  if (window_rows == rows_.end()) return field->factory;
  const auto row = window_rows->second.find(key);
  return row == window_rows->second.end()
             ? field->factory
             : row->second.values[static_cast<std::size_t>(field - in->fields.data())];
}

Row ModuleProject::factory_row(const Window& window, std::uint32_t key) const {
  Row row;
  for (const Field& field : window.fields) row.values.push_back(factory_value(window, field, key, node_id()));
  if (!window.name_field.empty()) {
    row.name = new_name;
    row.values[0] = key != node_id() && from_cpu_beside(window, key) >= most_from_cpu ? from_here : from_cpu;
  }
  return row;
}

std::size_t ModuleProject::from_cpu_beside(const Window& window, std::uint32_t key) const {
  const auto& all = rows_.at(window.word);
  return static_cast<std::size_t>(std::ranges::count_if(all, [&](const auto& each) {
    return each.first != key && each.first != node_id() && each.second.values[0] == from_cpu;
  }));
}

std::string ModuleProject::why_not_target(const Window& window, std::uint32_t key,
                                          std::uint32_t target) const {
  if (window.name_field.empty()) return {};
  if (key == node_id() && target != from_cpu)
    return "Download target: this module is written through the CPU module";
  if (key != node_id() && target == from_cpu && from_cpu_beside(window, key) >= most_from_cpu) {
    return fmt::format(
        "Download target: the CPU module holds the settings of {} nodes at most; expected Target node",
        most_from_cpu);
  }
  return {};
}

void ModuleProject::restore_defaults(const Window& window) {
  rows_[window.word].clear();
  if (window.key.empty()) rows_[window.word][0] = factory_row(window, 0);
}

std::expected<void, std::string> ModuleProject::add(const Window& window, std::uint32_t key) {
  if (window.key.empty()) return std::unexpected(fmt::format("{} has no rows", window.word));
  if (key < 1 || key > window.most_key) {
    return std::unexpected(fmt::format("{} = {}: expected 1 to {}", window.key, key, window.most_key));
  }
  auto& rows = rows_[window.word];
  if (rows.contains(key)) return std::unexpected(fmt::format("{} is there already", place_of(window, key)));
  if (rows.size() >= window.most_rows) {
    return std::unexpected(
        fmt::format("{}: at most {}", window.word, ascii::counted(window.most_rows, "row")));
  }
  if (window.word == "slave" && value("master", "NMT master") == 0) {
    return std::unexpected(
        "slave: only an NMT master assigns slaves; set master \"NMT master=Selected\" first");
  }
  rows[key] = factory_row(window, key);
  return {};
}

bool ModuleProject::remove(const Window& window, std::uint32_t key) {
  return rows_[window.word].erase(key) != 0;
}

std::expected<void, std::string> ModuleProject::set_value(const Window& window, std::uint32_t key,
                                                          const Field& field, std::uint32_t value) {
  if (std::string wrong = why_not_value(field, value); !wrong.empty()) {
    return std::unexpected(fmt::format("{}: {}", place_of(window, key), wrong));
  }
  rows_[window.word][key].values[static_cast<std::size_t>(&field - window.fields.data())] = value;
  return {};
}

// The details window shows a COB-ID in two parts [FX3U-CAN 15.1.2 4)] [RJ71CN91 3.1].
std::expected<void, std::string> ModuleProject::set_part_of_cob_id(const Window& window, std::uint32_t key,
                                                                   const Field& cob_id, std::string_view name,
                                                                   std::string_view text) {
  const std::uint32_t before =
      rows_[window.word][key].values[static_cast<std::size_t>(&cob_id - window.fields.data())];
  const Field part{.name = name,
                   .unit = "",
                   .highest = name == "valid" ? 1 : highest_can_id,
                   .hexadecimal = name != "valid"};
  auto value = parse_value(part, text);
  if (name == "valid" && (text == "Selected" || text == "Not selected")) value = text == "Selected" ? 1 : 0;
  if (!value)
    return std::unexpected(
        fmt::format("{}: {} = \"{}\": expected {}", place_of(window, key), name, text,
                    name == "valid" ? "Selected, Not selected" : "0x000 to 0x57F, decimal or as 0x1F"));
  if (std::string wrong = name == "valid" ? why_not(part, *value) : why_not_cob_id(*value); !wrong.empty()) {
    return std::unexpected(fmt::format("{}: {}", place_of(window, key), wrong));
  }
  return set_value(
      window, key, cob_id,
      name == "valid" ? (before & ~not_valid) | (*value != 0 ? 0 : not_valid) : (before & ~0x7FFU) | *value);
}

std::expected<void, std::string> ModuleProject::set(const Window& window, std::uint32_t key,
                                                    std::string_view name, std::string_view text) {
  const auto row = rows_[window.word].find(key);
  if (row == rows_[window.word].end())
    return std::unexpected(fmt::format("{} is not there", place_of(window, key)));
  if (const Field* const cob_id = field_of(window, "COB-ID");
      cob_id != nullptr && (name == "valid" || name == "CAN-ID (11-bit)")) {
    return set_part_of_cob_id(window, key, *cob_id, name, text);
  }
  if (!window.name_field.empty() && name == window.name_field) {
    if (std::string wrong = why_no_name(text); !wrong.empty())
      return std::unexpected(fmt::format("{}: {}: {}", place_of(window, key), name, wrong));
    row->second.name = text;
    return {};
  }
  const Field* const field = field_of(window, name);
  if (field == nullptr) {
    std::vector<std::string_view> known;
    if (!window.name_field.empty()) known.push_back(window.name_field);
    for (const Field& each : window.fields) known.push_back(each.name);
    return std::unexpected(fmt::format("{} has no field \"{}\"; expected one of: {}", window.word, name,
                                       fmt::join(known, ", ")));
  }
  if (field->read_only)
    return std::unexpected(fmt::format("{}: {} is shown, and cannot be set here", window.word, name));
  const auto value = parse_value(*field, text);
  if (!value) {
    return std::unexpected(fmt::format("{}: {} = \"{}\": expected {}{}", place_of(window, key), name, text,
                                       shown_range(*field),
                                       field->words.empty() ? ", decimal or as 0x1F" : ""));
  }
  if (std::string wrong = why_not_target(window, key, *value); !wrong.empty())
    return std::unexpected(fmt::format("{}: {}", place_of(window, key), wrong));
  return set_value(window, key, *field, *value);
}

std::expected<void, std::string> ModuleProject::set_mapping(const Window& window, std::uint32_t key,
                                                            std::vector<std::uint32_t> mapping) {
  const auto row = rows_[window.word].find(key);
  if (window.mapping == 0) return std::unexpected(fmt::format("{} has no mapped objects", window.word));
  if (row == rows_[window.word].end())
    return std::unexpected(fmt::format("{} is not there", place_of(window, key)));
  if (std::string wrong = why_no_mapping(mapping); !wrong.empty()) {
    return std::unexpected(fmt::format("{}: {}", place_of(window, key), wrong));
  }
  row->second.mapping = std::move(mapping);
  return {};
}

std::vector<ProjectFinding> ModuleProject::check() const {
  std::vector<ProjectFinding> found;
  std::map<std::uint32_t, std::string> senders;  // CAN-IDs that this module would send
  for (const Window& window : tool_->windows) {
    for (const auto& [key, row] : rows_.at(window.word)) {
      const std::string place = place_of(window, key);
      for (std::size_t i = 0; i < window.fields.size(); ++i) {
        const Field& field = window.fields[i];
        if (std::string wrong = why_not_value(field, row.values[i]); !wrong.empty())
          found.push_back({true, place + ": " + wrong});
        if (field.name == "Transmission type" && row.values[i] >= 0xF1 && row.values[i] <= 0xFD) {
          found.push_back(
              {false, fmt::format("{}: Transmission type = 0x{:02X}: 0xF1 to 0xFD are system-reserved", place,
                                  row.values[i])});
        }
      }
      if (std::string wrong = why_no_mapping(row.mapping); !wrong.empty())
        found.push_back({true, place + ": " + wrong});
      for (const std::uint32_t entry : row.mapping) {
        if (tool_->object_name(entry).empty()) {
          found.push_back({false, fmt::format("{}: mapped object {} with {} is none of the module's", place,
                                              canopen::object_text(entry >> 16, entry >> 8 & 0xFF),
                                              ascii::counted(entry & 0xFF, "bit"))});
        }
      }
      if (!window.name_field.empty()) {
        for (const std::string& wrong : {why_no_name(row.name), why_not_target(window, key, row.values[0])}) {
          if (!wrong.empty()) found.push_back({true, place + ": " + wrong});
        }
      }
      if (window.mapping != 0x1A00 || (row.values[0] & not_valid) != 0) continue;
      const auto [other, is_new] = senders.emplace(row.values[0] & 0x7FF, place);
      if (!is_new) {
        found.push_back({true, fmt::format("{}: CAN-ID 0x{:03X} is sent by {}, too", place,
                                           row.values[0] & 0x7FF, other->second)});
      }
    }
  }
  const auto& assigned = rows_.at("slave");
  if (!assigned.empty() && value("master", "NMT master") == 0) {
    found.push_back({true, "slave: only an NMT master assigns slaves (master: NMT master)"});
  }
  for (const auto& [key, row] : assigned) {
    for (const std::string_view name :
         {"Device type", "Vendor-ID", "Product code", "Revision number", "Serial number"}) {
      if (value("slave", name, key) == 0 || value("slave", "NMT boot slave", key) != 0) continue;
      found.push_back(
          {false, fmt::format("slave {}: {} is compared when NMT boot slave is selected", key, name)});
      break;
    }
  }
  if (value("master", "Reset all nodes") != 0 && value("master", "Stop all nodes") != 0) {
    found.push_back({false, "master: Reset all nodes is without effect: Stop all nodes is selected"});
  }
  if (assigned.contains(node_id())) {
    found.push_back({true, fmt::format("slave {}: this is the module's own node-ID", node_id())});
  }
  if (!overlapping_slots().empty()) {
    found.push_back(
        {true,
         fmt::format(
             "master: Priority time slot = {}: expected more than \"CANopen device time slot\" x 127 = {}",
             value("master", "Priority time slot"), value("master", "CANopen device time slot") * 127)});
  }
  return found;
}

manager::FlyingMasterTiming ModuleProject::flying_timing() const {
  const auto time = [this](std::string_view field) {
    return std::chrono::milliseconds(value("master", field));
  };
  manager::FlyingMasterTiming timing;
  timing.time_out = time("Timeout");
  timing.negotiation_delay = time("NMT master negotiation time delay");
  timing.level = static_cast<std::uint8_t>(value("master", "NMT master priority"));
  timing.priority_slot = time("Priority time slot");
  timing.device_slot = time("CANopen device time slot");
  return timing;
}

std::string ModuleProject::negotiation() const {
  return manager::negotiation_words(flying_timing(), static_cast<std::uint8_t>(node_id()));
}

std::string ModuleProject::overlapping_slots() const { return manager::overlapping_slots(flying_timing()); }

namespace {

constexpr const char* root_name = "canopus-module";

/// Reads a file and keeps its place for messages.
class Reader {
 public:
  Reader(const eds::xml::Document& document, Tools tools) : document_(document), tools_(tools) {}

  std::expected<ModuleProject, std::string> read() {
    const pugi::xml_node root = document_.root();
    if (std::string_view(root.name()) != root_name)
      return std::unexpected(at(root, fmt::format("no <{}>: this is no project of a module", root_name)));
    if (const unsigned format = root.attribute("format").as_uint(0); format != project_format) {
      return std::unexpected(at(
          root, fmt::format("format \"{}\": this version reads format {}{}", root.attribute("format").value(),
                            project_format, format > project_format ? "; the file is newer" : "")));
    }
    const module::ConfigurationTool* const tool = find_tool(tools_, root.attribute("model").value());
    if (tool == nullptr) {
      return std::unexpected(at(root, fmt::format("model \"{}\": expected one of {}",
                                                  root.attribute("model").value(), models_of(tools_))));
    }
    ModuleProject project(*tool);
    // The master's settings decide whether slaves may be assigned, at any place in the file; node-IDs decide
    // defaults.
    for (const bool rows : {false, true}) {
      for (const pugi::xml_node node : root.children()) {
        if (node.type() != pugi::node_element) continue;
        if (auto read = read_window(project, node, rows); !read) return std::unexpected(read.error());
      }
    }
    return project;
  }

 private:
  std::string at(const pugi::xml_node& node, std::string_view what) const {
    return fmt::format("{}: {}", document_.position(node).line, what);
  }

  std::expected<void, std::string> read_window(ModuleProject& project, const pugi::xml_node& node,
                                               bool rows) const {
    const Window* const window =
        std::string_view(node.name()) == "window" ? project.window(node.attribute("name").value()) : nullptr;
    if (window == nullptr) {
      return std::unexpected(at(node, fmt::format("<{} name=\"{}\">: the {} has no such window", node.name(),
                                                  node.attribute("name").value(), project.tool().model)));
    }
    if (window->key.empty() == rows) return {};
    std::uint32_t key = 0;
    if (rows) {
      key = node.attribute("number").as_uint(0);
      if (auto added = project.add(*window, key); !added) return std::unexpected(at(node, added.error()));
    }
    std::vector<std::uint32_t> mapping;
    for (const pugi::xml_node child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      const std::string_view name = child.name();
      if (name == "field") {
        const std::string_view field = child.attribute("name").value();
        if (is_read_only(*window, field)) continue;
        if (auto set = project.set(*window, key, field, child.text().get()); !set)
          return std::unexpected(at(child, set.error()));
      } else if (name == "object" && window->mapping != 0) {
        const std::uint32_t index = child.attribute("index").as_uint(any),
                            sub = child.attribute("sub-index").as_uint(any),
                            bits = child.attribute("bits").as_uint(any);
        if (index > 0xFFFF || sub > 0xFF || bits > 64) {
          return std::unexpected(at(
              child, "<object>: expected index 0x0000 to 0xFFFF, sub-index 0x00 to 0xFF and bits 8 to 64"));
        }
        mapping.push_back(index << 16 | sub << 8 | bits);
      } else {
        return std::unexpected(at(child, fmt::format("<{}> is unknown here", name)));
      }
    }
    if (window->mapping == 0) return {};
    if (auto set = project.set_mapping(*window, key, std::move(mapping)); !set)
      return std::unexpected(at(node, set.error()));
    return {};
  }

  static bool is_read_only(const Window& window, std::string_view name) {
    return std::ranges::any_of(window.fields,
                               [&](const Field& field) { return field.read_only && field.name == name; });
  }

  static constexpr unsigned any = 0xFFFF'FFFF;
  const eds::xml::Document& document_;
  Tools tools_;
};

}  // namespace

std::string to_xml(const ModuleProject& project) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = document.append_child(root_name);
  root.append_attribute("model") = std::string(project.tool().model).c_str();
  root.append_attribute("format") = project_format;
  for (const Window& window : project.tool().windows) {
    for (const auto& [key, row] : project.rows(window)) {
      pugi::xml_node node = root.append_child("window");
      node.append_attribute("name") = std::string(window.word).c_str();
      if (!window.key.empty()) node.append_attribute("number") = key;
      if (!window.name_field.empty()) {
        pugi::xml_node field = node.append_child("field");
        field.append_attribute("name") = std::string(window.name_field).c_str();
        field.text() = row.name.c_str();
      }
      for (std::size_t i = 0; i < window.fields.size(); ++i) {
        pugi::xml_node field = node.append_child("field");
        field.append_attribute("name") = std::string(window.fields[i].name).c_str();
        field.text() = shown_value(window.fields[i], row.values[i]).c_str();
      }
      for (const std::uint32_t entry : row.mapping) {
        pugi::xml_node object = node.append_child("object");
        object.append_attribute("index") = fmt::format("0x{:04X}", entry >> 16).c_str();
        object.append_attribute("sub-index") = fmt::format("0x{:02X}", entry >> 8 & 0xFF).c_str();
        object.append_attribute("bits") = entry & 0xFF;
      }
    }
  }
  std::ostringstream out;
  document.save(out, "  ");
  return out.str();
}

std::expected<ModuleProject, std::string> from_xml(std::string_view text, Tools tools) {
  const auto document = eds::xml::Document::parse(text);
  if (document) return Reader(**document, tools).read();
  return std::unexpected(fmt::format("{}: {}", document.error().position.line, document.error().message));
}

}  // namespace canopus::module_settings
