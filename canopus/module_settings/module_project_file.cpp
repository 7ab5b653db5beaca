#include "canopus/module_settings/module_project_file.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "canopus/eds/xml/document.hpp"

namespace canopus::module_settings {
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
