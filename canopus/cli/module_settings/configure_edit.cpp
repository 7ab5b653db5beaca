// Commands that work on the file of a project alone.

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/cli/module_settings/configure_command.hpp"
#include "canopus/cli/module_settings/module_access.hpp"
#include "canopus/cli/module_settings/settings_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/module_settings/module_project.hpp"
#include "canopus/module_settings/recent_projects.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using module_settings::ModuleProject;
using module_settings::Row;
using module_settings::Window;
using Json = text::Json;

/// "tpdo/3": a window and the number of a row.
struct Place {
  const Window* window = nullptr;
  std::uint32_t key = 0;
};

std::expected<Place, std::string> place_of(const ModuleProject& project, const std::string& text) {
  const std::size_t slash = text.find('/');
  const Window* const window = project.window(text.substr(0, slash));
  if (window == nullptr) {
    std::vector<std::string_view> known;
    for (const Window& each : project.tool().windows) known.push_back(each.word);
    return std::unexpected(fmt::format("\"{}\" is no window; expected one of {}", text.substr(0, slash),
                                       fmt::join(known, ", ")));
  }
  if (slash == std::string::npos) {
    if (window->key.empty()) return Place{window, 0};
    return std::unexpected(
        fmt::format("{} has rows; expected {}/NUMBER, the number 1 to {}", text, text, window->most_key));
  }
  const auto number = parse_area(text.substr(slash + 1), window->most_key);
  if (window->key.empty() || !number || number->first != number->last) {
    return std::unexpected(fmt::format(
        "\"{}\": expected {}", text,
        window->key.empty() ? std::string(window->word)
                            : fmt::format("{}/1 to {}/{}", window->word, window->word, window->most_key)));
  }
  return Place{window, number->first};
}

/// Loads, changes, saves; nothing is saved when something was refused. `title`: the change, for the undo
/// list.
template <typename Change>
int change_project(const std::string& path, const std::string& title, Change change) {
  auto file = ChangingProject::open(path);
  if (!file) return configure_failed(configure_code::usage, file.error());
  auto project = file->read();
  if (!project) return configure_failed(configure_code::usage, project.error());
  if (const std::string wrong = change(*project); !wrong.empty()) {
    return configure_failed(configure_code::usage, fmt::format("{}: {}", path, wrong));
  }
  if (const std::string wrong = file->save(*project, title); !wrong.empty()) {
    return configure_failed(configure_code::failed, wrong);
  }
  module_settings::remember_project(path);
  return configure_code::done;
}

/// "A100:01:16": index, sub-index and bits.
std::optional<std::uint32_t> parse_mapped_object(std::string_view text) {
  const std::size_t first = std::min(text.find(':'), text.size());
  const std::size_t second = std::min(text.find(':', first + 1), text.size());
  if (first > 4 || second - first > 3 || text.size() - second > 3 || second == text.size())
    return std::nullopt;
  const auto index = ascii::parse_number<std::uint16_t>(text.substr(0, first), 16);
  const auto sub = ascii::parse_number<std::uint8_t>(text.substr(first + 1, second - first - 1), 16);
  const auto bits = ascii::parse_number<std::uint8_t>(text.substr(second + 1));
  if (!index || !sub || !bits) return std::nullopt;
  return std::uint32_t{*index} << 16 | std::uint32_t{*sub} << 8 | *bits;
}

/// "A100:01:16 A100:02:16", separated by spaces or commas; "" for nothing.
std::expected<std::vector<std::uint32_t>, std::string> parse_mapping(std::string_view text) {
  const auto is_between = [](char c) { return c == ' ' || c == ','; };
  std::vector<std::uint32_t> mapping;
  for (auto word = ascii::next_word(text, is_between); !word.empty();
       word = ascii::next_word(text, is_between)) {
    const auto entry = parse_mapped_object(word);
    if (!entry) {
      return std::unexpected(
          fmt::format("\"{}\" is no mapped object; expected INDEX:SUB:BITS, as A100:01:16", word));
    }
    mapping.push_back(*entry);
  }
  return mapping;
}

std::string described(const ModuleProject& project, std::uint32_t entry) {
  const std::string name = project.tool().object_name(entry);
  return fmt::format("{}:{} {}", canopen::object_text(entry >> 16, entry >> 8 & 0xFF), entry & 0xFF,
                     name.empty() ? "?" : name);
}

constexpr std::string_view master_window = "master";

/// The negotiation of the window "NMT master / slave".
std::string negotiation_of(const ModuleProject& project) {
  const bool takes_part = project.value(master_window, "Flying master") != 0;
  return project.negotiation() + (takes_part ? "" : "; it takes no part (Flying master is not selected)");
}

Json row_json(const ModuleProject& project, const Window& window, std::uint32_t key, const Row& row) {
  Json json;
  json["window"] = window.word;
  if (!window.key.empty()) json["number"] = key;
  if (!window.name_field.empty()) json["name"] = row.name;
  for (std::size_t i = 0; i < window.fields.size(); ++i)
    json["fields"][std::string(window.fields[i].name)] = row.values[i];
  for (const std::uint32_t entry : row.mapping) json["objects"].push_back(described(project, entry));
  if (window.word == master_window) {
    json["words"] = negotiation_of(project);
    json["warning"] = project.overlapping_slots();
  }
  return json;
}

void print_row(const ModuleProject& project, const Window& window, std::uint32_t key, const Row& row) {
  if (window.key.empty()) {
    print_line("{} ({})", window.title, window.word);
  } else {
    print_line("{} {} ({}/{})", window.key, key, window.word, key);
  }
  if (!window.name_field.empty()) print_line("  {:<38} {}", window.name_field, row.name);
  for (std::size_t i = 0; i < window.fields.size(); ++i) {
    const module_settings::Field& field = window.fields[i];
    print_line("  {:<38} {}{}{}", field.name, module_settings::shown_value(field, row.values[i]),
               field.unit.empty() ? "" : " ", field.unit);
  }
  for (const std::uint32_t entry : row.mapping)
    print_line("  {:<38} {}", "mapped object", described(project, entry));
  if (window.word != master_window) return;
  print_line("  {}", negotiation_of(project));
  if (const std::string wrong = project.overlapping_slots(); !wrong.empty()) print_line("  {}", wrong);
}

}  // namespace

int new_project(const ConfigureArguments& arguments) {
  const module::ConfigurationTool* const tool =
      module_settings::find_tool(plant::configuration_tools(), arguments.model);
  if (std::filesystem::exists(arguments.file)) {
    return configure_failed(configure_code::usage, fmt::format("{}: is there already", arguments.file));
  }
  ModuleProject project(*tool);
  if (arguments.module_number >= 0) {
    const bool has_number = tool->request_method == module::RequestMethod::words;
    const auto set = project.set(*project.window("basic"), 0, has_number ? "Module number" : "Module address",
                                 std::to_string(arguments.module_number * (has_number ? 1 : 0x10)));
    if (!set) return configure_failed(configure_code::usage, set.error());
  }
  if (const std::string wrong = save_project(arguments.file, project); !wrong.empty()) {
    return configure_failed(configure_code::failed, wrong);
  }
  module_settings::remember_project(arguments.file);
  return configure_code::done;
}

int show_project(const ConfigureArguments& arguments) {
  const auto project = read_project(arguments);
  if (!project) return configure_failed(configure_code::usage, project.error());
  module_settings::remember_project(arguments.file);
  for (const Window& window : project->tool().windows) {
    if (!arguments.window.empty() && arguments.window != window.word) continue;
    for (const auto& [key, row] : project->rows(window)) {
      if (arguments.json) {
        print_json(row_json(*project, window, key, row));
      } else {
        print_row(*project, window, key, row);
      }
    }
  }
  return configure_code::done;
}

int set_in_project(const ConfigureArguments& arguments) {
  const std::string title = fmt::format("set {}{}{}", arguments.window, arguments.settings.empty() ? "" : " ",
                                        fmt::join(arguments.settings, ", "));
  return change_project(arguments.file, title, [&](ModuleProject& project) -> std::string {
    const auto place = place_of(project, arguments.window);
    if (!place) return place.error();
    if (!place->window->key.empty() && !project.rows(*place->window).contains(place->key)) {
      if (const auto added = project.add(*place->window, place->key); !added) return added.error();
    }
    for (const std::string& setting : arguments.settings) {
      const std::size_t equals = setting.find('=');
      if (equals == std::string::npos) return fmt::format("\"{}\": expected FIELD=VALUE", setting);
      const std::string field = setting.substr(0, equals), value = setting.substr(equals + 1);
      std::expected<void, std::string> set;
      if (field == "map") {
        auto mapping = parse_mapping(value);
        if (!mapping) return mapping.error();
        set = project.set_mapping(*place->window, place->key, std::move(*mapping));
      } else {
        set = project.set(*place->window, place->key, field, value);
      }
      if (!set) return set.error();
    }
    return {};
  });
}

int delete_from_project(const ConfigureArguments& arguments) {
  return change_project(
      arguments.file, "delete " + arguments.window, [&](ModuleProject& project) -> std::string {
        const auto place = place_of(project, arguments.window);
        if (!place) return place.error();
        if (place->window->key.empty())
          return fmt::format("{} is not a row; `defaults` restores its values", arguments.window);
        return project.remove(*place->window, place->key) ? std::string()
                                                          : fmt::format("{} is not there", arguments.window);
      });
}

int restore_in_project(const ConfigureArguments& arguments) {
  return change_project(arguments.file, "defaults of " + arguments.window,
                        [&](ModuleProject& project) -> std::string {
                          const Window* const window = project.window(arguments.window);
                          if (window == nullptr) return fmt::format("\"{}\" is no window", arguments.window);
                          project.restore_defaults(*window);
                          return {};
                        });
}

int check_project(const ConfigureArguments& arguments) {
  const auto project = read_project(arguments);
  if (!project) return configure_failed(configure_code::usage, project.error());
  unsigned errors = 0, warnings = 0;
  for (const module_settings::ProjectFinding& finding : project->check()) {
    ++(finding.is_error ? errors : warnings);
    if (arguments.json) {
      print_json(Json{{"severity", finding.is_error ? "error" : "warning"}, {"message", finding.text}});
      continue;
    }
    print_line("{}: {}: {}", arguments.file, finding.is_error ? "error" : "warning", finding.text);
  }
  if (project->value(master_window, "Flying master") != 0) {
    const std::string text = fmt::format("{}: {}", master_window, project->negotiation());
    if (arguments.json) {
      print_json(Json{{"severity", "note"}, {"message", text}});
    } else {
      print_line("{}: note: {}", arguments.file, text);
    }
  }
  if (!arguments.json)
    print_line("{}: {}, {}", arguments.file, ascii::counted(errors, "error"),
               ascii::counted(warnings, "warning"));
  return errors == 0 ? configure_code::done : configure_code::different;
}

int export_project(const ConfigureArguments& arguments) {
  const auto project = read_project(arguments);
  if (!project) return configure_failed(configure_code::usage, project.error());
  if (!arguments.other_file.ends_with(".xml")) {
    return configure_failed(configure_code::usage,
                            fmt::format("{}: the backup file's extension is .xml", arguments.other_file));
  }
  const std::string wrong = save_project(arguments.other_file, *project);
  return wrong.empty() ? configure_code::done : configure_failed(configure_code::failed, wrong);
}

int import_project(const ConfigureArguments& arguments) {
  const auto backup = load_project(arguments.other_file);
  if (!backup) return configure_failed(configure_code::usage, backup.error());
  std::string wrong;
  if (std::error_code error; std::filesystem::exists(arguments.file, error)) {
    auto file = ChangingProject::open(arguments.file);
    if (!file) return configure_failed(configure_code::usage, file.error());
    wrong = file->save(*backup, "import " + arguments.other_file);
  } else {
    wrong = save_project(arguments.file, *backup);
  }
  return wrong.empty() ? configure_code::done : configure_failed(configure_code::failed, wrong);
}

int undo_in_project(const ConfigureArguments& arguments) {
  auto file = ChangingProject::open(arguments.file);
  if (!file) return configure_failed(configure_code::usage, file.error());
  const auto title = file->undo();
  if (!title) return configure_failed(configure_code::usage, title.error());
  if (!*title) {
    return configure_failed(configure_code::usage,
                            fmt::format("{}: there is nothing to take back", arguments.file));
  }
  if (arguments.json) {
    print_json(Json{{"event", "undone"}, {"title", **title}});
  } else {
    print_line("taken back: {}", **title);
  }
  return configure_code::done;
}

int list_recent_projects() {
  for (const std::string& path : module_settings::recent_projects()) print_line("{}", path);
  return configure_code::done;
}

}  // namespace canopus::cli
