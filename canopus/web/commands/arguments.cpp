#include "canopus/web/commands/arguments.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/text/shortened.hpp"
#include "canopus/web/commands/command_table.hpp"

namespace canopus::web {
namespace {

using Json = text::Json;
using Settings = WebCommand::Settings;
using enum WebCommandField::Kind;

constexpr std::size_t longest_text = 1000;
constexpr std::size_t most_texts = 512;

std::span<const WebCommandField> fields_of(const WebCommand& command) {
  const auto end =
      std::ranges::find_if(command.fields, [](const WebCommandField& one) { return one.name.empty(); });
  return {command.fields.begin(), end};
}

/// Nothing that could not be an argument of a process.
bool is_argument(const Json& value) {
  if (!value.is_string()) return false;
  const auto& given = value.string();
  return given.size() <= longest_text && !given.contains('\0');
}

std::string names_of(std::span<const WebCommand> commands) {
  std::string names;
  for (const WebCommand& one : commands) names += fmt::format("{}{}", names.empty() ? "" : ", ", one.title);
  return names;
}

/// What a field adds to a command line. The error names what was expected.
std::expected<void, std::string> add_field(const WebCommandField& field, const Json& value,
                                           WebCommandLine& line, std::vector<std::string>& behind) {
  std::string name(field.name);
  std::ranges::replace(name, '_', '-');
  const auto expected = [&](std::string_view what) {
    return std::unexpected(fmt::format("{}: \"{}\" is to be {}", line.title, field.name, what));
  };
  switch (field.kind) {
    case option:
      if (!is_argument(value)) return expected("a text of up to 1000 characters");
      line.arguments.push_back(fmt::format("--{}={}", name, value.get<std::string>()));
      line.fields[std::string(field.name)] = value.get<std::string>();
      return {};
    case flag:
      if (!value.is_boolean()) return expected("true or false");
      if (value.get<bool>()) line.arguments.push_back(fmt::format("--{}", name));
      return {};
    case word:
      if (!is_argument(value)) return expected("a text of up to 1000 characters");
      behind.push_back(value.get<std::string>());
      line.fields[std::string(field.name)] = value.get<std::string>();
      return {};
    case words:
      if (!value.is_array() || value.size() > most_texts || !std::ranges::all_of(value, is_argument)) {
        return expected("a list of up to 512 texts");
      }
      for (const Json& one : value) behind.push_back(one.get<std::string>());
      return {};
    case file:
      if (!value.is_object() || !value.contains("name") || !value.contains("text") ||
          !is_argument(value["name"]) || !value["text"].is_string()) {
        return expected("a file with its name and its text");
      }
      line.file_name = value["name"].get<std::string>();
      line.file_text = value["text"].get<std::string>();
      behind.emplace_back("{file}");
      return {};
  }
  return {};
}

/// The command that a wish names; else a sentence.
std::expected<const WebCommand*, std::string> command_of(const Json& wish,
                                                         std::span<const WebCommand> commands) {
  const auto name = wish.find("command");
  if (name == wish.end() || !name->is_string()) return std::unexpected("expected \"command\"");
  const auto command = std::ranges::find(commands, std::string_view(name->string()), &WebCommand::title);
  if (command != commands.end()) return &*command;
  return std::unexpected(
      fmt::format("unknown command {}; expected one of {}", quoted_name(name->string()), names_of(commands)));
}

/// Its own words alone.
WebCommandLine begin_line(const WebCommand& command) {
  WebCommandLine line{.title = std::string(command.title),
                      .role = command.role,
                      .joins_bus = command.joins_bus,
                      .writes_to_bus = command.writes_to_bus,
                      .on_bus = command.on_bus,
                      .file_name = std::string(command.makes_file),
                      .makes_file = !command.makes_file.empty()};
  const std::string words(command.words.empty() ? command.title : command.words);
  for (std::size_t begin = 0; begin < words.size();) {
    const std::size_t end = std::min(words.find(' ', begin), words.size());
    line.arguments.push_back(words.substr(begin, end - begin));
    begin = end + 1;
  }
  if (command.has_json) line.arguments.emplace_back("--json");
  return line;
}

/// The fields of the wish, behind what is in `behind` already. `place`: the key that names what the command is for.
std::expected<void, std::string> end_line(const WebCommand& command, const Json& wish, std::string_view place,
                                          std::vector<std::string> behind, WebCommandLine& line) {
  const auto fields = fields_of(command);
  for (const WebCommandField& field : fields) {
    const auto value = wish.find(field.name);
    if (value == wish.end()) {
      if (!field.required) continue;
      return std::unexpected(fmt::format("{}: expected \"{}\"", command.title, field.name));
    }
    if (auto added = add_field(field, *value, line, behind); !added) return added;
  }
  if (line.makes_file) behind.emplace_back("{file}");
  for (const auto& [key, value] : wish.items()) {
    const bool is_known =
        key == "command" || key == place ||
        std::ranges::any_of(fields, [&](const WebCommandField& one) { return one.name == key; });
    if (!is_known) return std::unexpected(fmt::format("{}: unknown {}", command.title, quoted_name(key)));
  }
  line.arguments.emplace_back("--");
  line.arguments.insert(line.arguments.end(), behind.begin(), behind.end());
  // Without the page's "yes" nothing is written: it answers what would be.
  if (command.writes_with_yes && !wish.value("yes", false)) line.writes_to_bus = false;
  return {};
}

}  // namespace

bool is_web_settings_command(std::string_view name) {
  return std::ranges::find(web_settings_commands(), name, &WebCommand::title) !=
         web_settings_commands().end();
}

std::expected<WebCommandLine, std::string> web_command_line(const Json& wish, const WebBus& bus) {
  const auto named = command_of(wish, web_bus_commands());
  if (!named) return std::unexpected(named.error());
  const WebCommand& command = **named;
  if (command.has_project && bus.project.empty()) {
    return std::unexpected(fmt::format("{}: the bus {} has no project", command.title, bus.name));
  }
  if (command.joins_bus && bus.address.empty()) {
    return std::unexpected(fmt::format("{}: commands cannot join the bus {}", command.title, bus.name));
  }
  WebCommandLine line = begin_line(command);
  line.bus = bus.name;
  if (command.has_project && bus.network != 1)
    line.arguments.push_back(fmt::format("--network={}", bus.network));
  if (command.joins_bus) line.arguments.push_back("--bus=" + bus.address);
  if (command.takes_device_files) {
    if (bus.device_files.empty()) {
      return std::unexpected(fmt::format("{}: there are no device files; --eds names them", command.title));
    }
    for (const std::string& one : bus.device_files) line.arguments.push_back("--eds=" + one);
  }
  std::vector<std::string> behind;
  if (command.has_project) behind.push_back(bus.project);
  if (auto ended = end_line(command, wish, "bus", std::move(behind), line); !ended)
    return std::unexpected(ended.error());
  return line;
}

std::expected<WebCommandLine, std::string> web_command_line(const Json& wish, const WebSettings& settings) {
  const auto named = command_of(wish, web_settings_commands());
  if (!named) return std::unexpected(named.error());
  const WebCommand& command = **named;
  if (command.joins_bus && settings.plc.empty()) {
    return std::unexpected(
        fmt::format("{}: there is no PLC with the module of {}", command.title, settings.file));
  }
  WebCommandLine line = begin_line(command);
  if (command.joins_bus)
    line.arguments.insert(line.arguments.end(), settings.plc.begin(), settings.plc.end());
  if (command.takes_device_files)
    for (const std::string& one : settings.device_files) line.arguments.push_back("--eds=" + one);
  if (command.settings == Settings::option) line.arguments.push_back("--project=" + settings.file);
  if (command.settings == Settings::model) line.arguments.push_back("--module=" + settings.model);
  std::vector<std::string> behind;
  if (command.settings == Settings::file) behind.push_back(settings.file);
  if (auto ended = end_line(command, wish, "settings", std::move(behind), line); !ended)
    return std::unexpected(ended.error());
  return line;
}

std::string quoted_name(std::string_view name) {
  constexpr std::size_t longest = 100;
  return fmt::format("\"{}\"", text::printable(text::shortened(name, longest)));
}

std::string shown_command(const std::vector<std::string>& arguments) {
  std::string line = "canopus";
  for (const std::string& one : arguments) {
    const bool is_plain = !one.empty() && std::ranges::all_of(one, [](char c) {
      return ascii::is_digit(c) || ascii::is_letter(c) || std::string_view("-_=./:,+@%").contains(c);
    });
    if (is_plain) {
      line += ' ' + one;
      continue;
    }
    line += " '";
    for (const char c : one) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

}  // namespace canopus::web
