#include "canopus/cli/web/web_arguments.hpp"

#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "canopus/text/printable.hpp"

namespace canopus::cli {
namespace {

using Json = nlohmann::json;
using serve::WebRole;

/// A field of a command and what becomes of it.
struct Field {
  enum class Kind : std::uint8_t {
    option,  ///< --name=TEXT
    flag,    ///< --name
    word,    ///< behind the options
    words,   ///< likewise, each of a list
    file,    ///< a device file that comes along: {"name": ..., "text": ...}
  };
  std::string_view name;
  Kind kind = Kind::option;
  bool required = false;
  std::string_view option{};  ///< where it is not called as the field
};

struct Command {
  std::string_view title;  ///< also the words of the command line
  WebRole role = WebRole::look;
  bool has_project = true;
  bool joins_bus = false;
  bool writes_to_bus = false;
  bool takes_device_files = false;
  bool makes_file = false;
  std::array<Field, 8> fields{};
};

using enum Field::Kind;

constexpr std::array commands{
    Command{.title = "project show", .fields = {{{"node", word}, {"all", flag}}}},
    Command{.title = "project check", .fields = {}},
    Command{.title = "project pdo list", .fields = {{{"node", word}, {"all", flag}}}},
    Command{.title = "project report", .makes_file = true, .fields = {}},
    Command{.title = "project add",
            .role = WebRole::configure,
            .fields = {{{"file", file, true},
                        {"node_id", option, false, "node-id"},
                        {"name"},
                        {"bit_rate", option, false, "bit-rate"}}}},
    Command{.title = "project remove", .role = WebRole::configure, .fields = {{{"node", word, true}}}},
    Command{.title = "project set",
            .role = WebRole::configure,
            .fields = {{{"node", word},
                        {"items", words},
                        {"name"},
                        {"node_id", option, false, "node-id"},
                        {"reference"},
                        {"present", flag},
                        {"absent", flag},
                        {"bit_rate", option, false, "bit-rate"}}}},
    Command{.title = "project unset",
            .role = WebRole::configure,
            .fields = {{{"node", word, true}, {"items", words, true}}}},
    Command{.title = "project note",
            .role = WebRole::configure,
            .fields = {{{"node", word, true}, {"text", word, true}}}},
    Command{.title = "project undo", .role = WebRole::configure, .fields = {}},
    Command{.title = "project pdo map",
            .role = WebRole::configure,
            .fields = {{{"node", word, true},
                        {"pdo", word, true},
                        {"items", words},
                        {"can_id", option, false, "can-id"},
                        {"type"},
                        {"inhibit"},
                        {"event"},
                        {"dry_run", flag, false, "dry-run"}}}},
    Command{.title = "project pdo off",
            .role = WebRole::configure,
            .fields = {{{"node", word, true}, {"pdo", word, true}, {"dry_run", flag, false, "dry-run"}}}},
    Command{.title = "project pdo link",
            .role = WebRole::configure,
            .fields = {{{"from", word, true}, {"to", word, true}, {"dry_run", flag, false, "dry-run"}}}},
    Command{
        .title = "project diff", .role = WebRole::operate, .joins_bus = true, .fields = {{{"node", word}}}},
    Command{.title = "project write",
            .role = WebRole::configure,
            .joins_bus = true,
            .writes_to_bus = true,
            .fields = {{{"node", word}, {"yes", flag}, {"save", flag}}}},
    Command{
        .title = "project read", .role = WebRole::configure, .joins_bus = true, .fields = {{{"node", word}}}},
    Command{.title = "project accept",
            .role = WebRole::configure,
            .joins_bus = true,
            .fields = {{{"node", word, true}, {"yes", flag}}}},
    Command{.title = "project adopt",
            .role = WebRole::configure,
            .joins_bus = true,
            .takes_device_files = true,
            .fields = {{{"nodes"}, {"bit_rate", option, false, "bit-rate"}}}},
    Command{.title = "scan",
            .role = WebRole::operate,
            .has_project = false,
            .joins_bus = true,
            .fields = {{{"nodes"}}}},
    Command{.title = "nmt start",
            .role = WebRole::operate,
            .has_project = false,
            .joins_bus = true,
            .writes_to_bus = true,
            .fields = {{{"node", word, true}}}},
    Command{.title = "nmt stop",
            .role = WebRole::operate,
            .has_project = false,
            .joins_bus = true,
            .writes_to_bus = true,
            .fields = {{{"node", word, true}}}},
    Command{.title = "nmt preop",
            .role = WebRole::operate,
            .has_project = false,
            .joins_bus = true,
            .writes_to_bus = true,
            .fields = {{{"node", word, true}}}},
    Command{.title = "nmt reset",
            .role = WebRole::operate,
            .has_project = false,
            .joins_bus = true,
            .writes_to_bus = true,
            .fields = {{{"node", word, true}}}},
    Command{.title = "nmt reset-comm",
            .role = WebRole::operate,
            .has_project = false,
            .joins_bus = true,
            .writes_to_bus = true,
            .fields = {{{"node", word, true}}}},
    Command{.title = "sdo read",
            .role = WebRole::operate,
            .has_project = false,
            .joins_bus = true,
            .fields = {{{"node", word, true}, {"object", word, true}, {"type"}}}},
    Command{.title = "sdo write",
            .role = WebRole::configure,
            .has_project = false,
            .joins_bus = true,
            .writes_to_bus = true,
            .fields = {{{"node", word, true}, {"object", word, true}, {"value", word, true}, {"type"}}}},
};

constexpr std::size_t longest_text = 1000;
constexpr std::size_t most_texts = 512;

std::span<const Field> fields_of(const Command& command) {
  const auto end = std::ranges::find_if(command.fields, [](const Field& one) { return one.name.empty(); });
  return {command.fields.begin(), end};
}

/// Nothing that could not be an argument of a process.
bool is_argument(const Json& value) {
  if (!value.is_string()) return false;
  const auto& said = value.get_ref<const std::string&>();
  return said.size() <= longest_text && !said.contains('\0');
}

std::string known_commands() {
  std::string names;
  for (const Command& one : commands) names += fmt::format("{}{}", names.empty() ? "" : ", ", one.title);
  return names;
}

/// What a field adds to a command line. The error says what was expected.
std::expected<void, std::string> add_field(const Field& field, const Json& value, WebCommandLine& line,
                                           std::vector<std::string>& behind) {
  const std::string_view name = field.option.empty() ? field.name : field.option;
  const auto expected = [&](std::string_view what) {
    return std::unexpected(fmt::format("{}: \"{}\" is to be {}", line.title, field.name, what));
  };
  switch (field.kind) {
    case option:
      if (!is_argument(value)) return expected("a text of up to 1000 characters");
      line.arguments.push_back(fmt::format("--{}={}", name, value.get<std::string>()));
      return {};
    case flag:
      if (!value.is_boolean()) return expected("true or false");
      if (value.get<bool>()) line.arguments.push_back(fmt::format("--{}", name));
      return {};
    case word:
      if (!is_argument(value)) return expected("a text of up to 1000 characters");
      behind.push_back(value.get<std::string>());
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

}  // namespace

std::expected<WebCommandLine, std::string> web_command_line(const Json& wish, const WebBus& bus) {
  const auto name = wish.find("command");
  if (name == wish.end() || !name->is_string()) return std::unexpected("expected \"command\"");
  const auto* const command =
      std::ranges::find(commands, std::string_view(name->get_ref<const std::string&>()), &Command::title);
  if (command == commands.end()) {
    return std::unexpected(fmt::format("unknown command \"{}\"; expected one of {}",
                                       text::printable(name->get<std::string>()), known_commands()));
  }
  WebCommandLine line{.title = std::string(command->title),
                      .role = command->role,
                      .joins_bus = command->joins_bus,
                      .writes_to_bus = command->writes_to_bus,
                      .makes_file = command->makes_file};
  if (command->has_project && bus.project.empty()) {
    return std::unexpected(fmt::format("{}: the bus {} has no project", command->title, bus.name));
  }
  if (command->joins_bus && bus.address.empty()) {
    return std::unexpected(fmt::format("{}: commands cannot join the bus {}", command->title, bus.name));
  }
  for (std::size_t begin = 0; begin < line.title.size();) {
    const std::size_t end = std::min(line.title.find(' ', begin), line.title.size());
    line.arguments.push_back(line.title.substr(begin, end - begin));
    begin = end + 1;
  }
  line.arguments.emplace_back("--json");
  if (command->has_project && bus.network != 1)
    line.arguments.push_back(fmt::format("--network={}", bus.network));
  if (command->joins_bus) line.arguments.push_back("--bus=" + bus.address);
  if (command->takes_device_files) {
    if (bus.device_files.empty()) {
      return std::unexpected(fmt::format("{}: there are no device files; --eds names them", command->title));
    }
    for (const std::string& one : bus.device_files) line.arguments.push_back("--eds=" + one);
  }
  std::vector<std::string> behind;
  if (command->has_project) behind.push_back(bus.project);
  if (command->makes_file) behind.emplace_back("{file}");
  const auto fields = fields_of(*command);
  for (const Field& field : fields) {
    const auto value = wish.find(field.name);
    if (value == wish.end()) {
      if (!field.required) continue;
      return std::unexpected(fmt::format("{}: expected \"{}\"", command->title, field.name));
    }
    if (const auto added = add_field(field, *value, line, behind); !added)
      return std::unexpected(added.error());
  }
  for (const auto& [key, value] : wish.items()) {
    const bool is_known = key == "command" || key == "bus" ||
                          std::ranges::any_of(fields, [&](const Field& one) { return one.name == key; });
    if (!is_known)
      return std::unexpected(fmt::format("{}: unknown \"{}\"", command->title, text::printable(key)));
  }
  line.arguments.emplace_back("--");
  line.arguments.insert(line.arguments.end(), behind.begin(), behind.end());
  // Without the page's answer nothing would be written, and that is what its answer says.
  if (line.writes_to_bus && line.title == "project write" && !wish.value("yes", false))
    line.writes_to_bus = false;
  return line;
}

std::string shown_command(const std::vector<std::string>& arguments) {
  std::string line = "canopus";
  for (const std::string& one : arguments) {
    const bool is_plain = !one.empty() && std::ranges::all_of(one, [](char c) {
      return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
             std::string_view("-_=./:,+@%").contains(c);
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

}  // namespace canopus::cli
