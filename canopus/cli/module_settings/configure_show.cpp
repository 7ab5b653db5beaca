// Commands that list the settings of a module, without a project.

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/cli/module_settings/configure_command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/module_settings/mappable_objects.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using module_settings::Field;
using module_settings::Window;
using DescriptionJson = text::Json;

void print_window_head(const Window& window) {
  print_line("{} ({})", window.title, window.word);
  if (!window.key.empty()) {
    print_line("  {:<38} the number of a row; 1 to {}; at most {}", window.key, window.most_key,
               ascii::counted(window.most_rows, "row"));
  }
  if (!window.name_field.empty()) print_line("  {:<38} 1 to 256 characters; CANopen node", window.name_field);
  if (window.mapping != 0) {
    print_line("  {:<38} the PDO is there (bit 31 of COB-ID); Not selected, Selected; PDO 1 to 4: Selected",
               "valid");
    print_line("  {:<38} 0x000 to 0x57F; PDO 1 to 4: those of CiA 301, others 0x000", "CAN-ID (11-bit)");
    print_line("  {:<38} mapped objects, INDEX:SUB:BITS each; at most 64 bits", "map");
  }
}

/// The description of a window's fields for a form.
DescriptionJson window_json(const Window& window) {
  DescriptionJson json;
  json["window"] = window.word;
  json["title"] = window.title;
  json["part"] = window.part;
  if (!window.key.empty()) {
    json["key"] = window.key;
    json["most_key"] = window.most_key;
    json["most_rows"] = window.most_rows;
  }
  if (!window.name_field.empty()) json["name_field"] = window.name_field;
  json["maps_objects"] = window.mapping != 0;
  return json;
}

DescriptionJson field_json(const Window& window, const Field& field) {
  DescriptionJson json;
  json["window"] = window.word;
  json["field"] = field.name;
  json["range"] = module_settings::shown_range(field);
  json["default"] = module_settings::shown_value(field, field.factory);
  json["description"] = field.description;
  json["unit"] = field.unit;
  json["lowest"] = field.lowest;
  json["highest"] = field.highest;
  json["step"] = field.step;
  json["hexadecimal"] = field.hexadecimal;
  json["read_only"] = field.read_only;
  if (!field.choices.empty())
    json["choices"] = std::vector<std::uint32_t>(field.choices.begin(), field.choices.end());
  if (!field.words.empty())
    json["words"] = std::vector<std::string_view>(field.words.begin(), field.words.end());
  return json;
}

}  // namespace

int describe_windows(const ConfigureArguments& arguments) {
  const module::ConfigurationTool* const tool =
      module_settings::find_tool(plant::configuration_tools(), arguments.model);
  for (const Window& window : tool->windows) {
    if (!arguments.window.empty() && arguments.window != window.word) continue;
    if (arguments.json) {
      print_json(window_json(window));
    } else {
      print_window_head(window);
    }
    for (const Field& field : window.fields) {
      if (arguments.json) {
        print_json(field_json(window, field));
      } else {
        print_line("  {:<38} {}; {}; {}", field.name, field.description, module_settings::shown_range(field),
                   module_settings::shown_value(field, field.factory));
      }
    }
  }
  return configure_code::done;
}

int list_mappable_objects(const ConfigureArguments& arguments) {
  const module::ConfigurationTool* const tool =
      module_settings::find_tool(plant::configuration_tools(), arguments.model);
  for (const Window& window : tool->windows) {
    if (window.mapping == 0 || (!arguments.window.empty() && arguments.window != window.word)) continue;
    for (const module_settings::MappableObjects& named : module_settings::mappable_objects(*tool, window)) {
      DescriptionJson json{{"window", window.word}, {"name", named.name}, {"bits", named.bits}};
      for (const auto& [index, sub, description] : named.objects) {
        if (arguments.json) {
          json["objects"].push_back(DescriptionJson::array({index, sub, description}));
        } else {
          print_line("{} {}:{} {}{}{}", window.word, canopen::object_text(index, sub), named.bits, named.name,
                     description.empty() ? "" : ", ", description);
        }
      }
      if (arguments.json) print_json(json);
    }
  }
  return configure_code::done;
}

}  // namespace canopus::cli
