#include "canopus/cli/plc/transfer_setups.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "canopus/store/files.hpp"
#include "canopus/store/folder_lock.hpp"
#include "canopus/store/user_state.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;
using SetupJson = text::Json;

constexpr std::size_t longest_setup_file = 1'000'000;
constexpr std::size_t longest_setup_text = 255;
constexpr std::array known_cpu_types = std::to_array<std::string_view>(
    {"R00", "R01",   "R02",  "R04",  "R04EN",  "R08",   "R08EN",     "R08P",  "R16",   "R16EN", "R16P",
     "R32", "R32EN", "R32P", "R120", "R120EN", "R120P", "R12CCPU-V", "R08SF", "R16SF", "R32SF", "R120SF"});

/// Nothing that a terminal or a command line takes for something else.
bool is_plain_text(std::string_view text) {
  return text.size() <= longest_setup_text && !text.starts_with('-') && !text.starts_with(' ') &&
         !text.ends_with(' ') && text == text::printable(text);
}

/// The texts of a setup by their names in the file.
struct SetupText {
  const char* key;
  std::string TransferSetup::*value;
};
constexpr std::array setup_texts{
    SetupText{"host", &TransferSetup::host}, SetupText{"frame", &TransferSetup::frame},
    SetupText{"timeout", &TransferSetup::timeout}, SetupText{"cpu_type", &TransferSetup::cpu_type},
    SetupText{"model", &TransferSetup::model}};
struct SetupFlag {
  const char* key;
  bool TransferSetup::*value;
};
constexpr std::array setup_flags{SetupFlag{"ascii", &TransferSetup::ascii},
                                 SetupFlag{"udp", &TransferSetup::udp}};

std::string line_of(const std::string& name, const TransferSetup& setup) {
  SetupJson line{{"name", name}};
  for (const auto& [key, value] : setup_texts) line[key] = setup.*value;
  for (const auto& [key, value] : setup_flags) line[key] = setup.*value;
  line["port"] = setup.port;
  line["cpu"] = setup.cpu;
  return line.dump() + "\n";
}

/// A value of a line. Empty: taken.
std::string read_value(const std::string& key, const SetupJson& value, TransferSetup& setup) {
  constexpr std::uint64_t highest_port = 65535;
  constexpr std::uint64_t highest_cpu = 4;
  if (const auto* const text = std::ranges::find(setup_texts, key, &SetupText::key);
      text != setup_texts.end()) {
    if (!value.is_string()) return fmt::format("{}: expected a text", key);
    setup.*(text->value) = value.get<std::string>();
    return {};
  }
  if (const auto* const flag = std::ranges::find(setup_flags, key, &SetupFlag::key);
      flag != setup_flags.end()) {
    if (!value.is_boolean()) return fmt::format("{}: expected true or false", key);
    setup.*(flag->value) = value.get<bool>();
    return {};
  }
  const bool is_port = key == "port";
  if (!is_port && key != "cpu") return fmt::format("{}: unknown", text::printable(key));
  const std::uint64_t highest = is_port ? highest_port : highest_cpu;
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > highest)
    return fmt::format("{}: expected a number from 0 to {}", key, highest);
  if (is_port)
    setup.port = value.get<std::uint16_t>();
  else
    setup.cpu = value.get<unsigned>();
  return {};
}

/// One line of the file. Empty: taken.
std::string read_line(std::string_view text, TransferSetups& setups) {
  const auto line = text::parse_json(text).value_or(SetupJson());
  if (!line.is_object()) return "expected a JSON object";
  TransferSetup setup;
  const auto name = line.find("name");
  if (name == line.end() || !name->is_string()) return "expected \"name\", a text";
  const auto& called = name->string();
  if (std::string why = why_no_setup_name(called); !why.empty()) return why;
  for (const auto& [key, value] : line.items()) {
    if (key == "name") continue;
    if (std::string why = read_value(key, value, setup); !why.empty()) return why;
  }
  if (std::string why = why_no_setup(setup); !why.empty()) return why;
  if (setups.size() >= most_transfer_setups) return fmt::format("more than {} setups", most_transfer_setups);
  const bool is_new = setups.emplace(called, setup).second;
  return is_new ? std::string() : fmt::format("a second setup \"{}\"", called);
}

fs::path setups_file() {
  const fs::path folder = store::user_state_folder();
  return folder.empty() ? folder : folder / "transfer-setups";
}

constexpr const char* nowhere = "neither HOME nor XDG_STATE_HOME says where transfer setups are kept";

}  // namespace

std::span<const std::string_view> cpu_types() noexcept { return known_cpu_types; }

std::string_view cpu_series(std::string_view cpu_type) noexcept {
  return cpu_type.ends_with("SF") ? "R Safety" : "R";
}

bool is_of_cpu_type(std::string_view name, std::string_view cpu_type) noexcept {
  if (!name.starts_with(cpu_type)) return false;
  const std::string_view rest = name.substr(cpu_type.size());
  return rest.empty() || rest == "CPU";
}

std::string multiple_cpu(unsigned cpu) { return cpu == 0 ? "None" : fmt::format("No.{}", cpu); }

std::string why_no_setup_name(std::string_view name) {
  constexpr std::size_t longest = 64;
  if (!name.empty() && name.size() <= longest && is_plain_text(name) &&
      name.find_first_of("/\\<>") == std::string_view::npos)
    return {};
  return fmt::format(
      "\"{}\" is no name of a transfer setup; expected 1 to {} printable characters, none of / \\ < >, "
      "and no - or space in front",
      text::printable(name.substr(0, longest)), longest);
}

std::string why_no_setup(const TransferSetup& setup) {
  const auto refuse = [](std::string_view what, std::string_view value, std::string_view expected) {
    return fmt::format("{} = \"{}\": expected {}", what, text::printable(value), expected);
  };
  if (setup.host.empty() || !is_plain_text(setup.host) || setup.host.find(' ') != std::string::npos)
    return refuse("host", setup.host, "a name or an address");
  if (setup.frame != "3E" && setup.frame != "4E" && setup.frame != "1E")
    return refuse("frame", setup.frame, "3E, 4E or 1E");
  const auto timeout = text::parse_duration(setup.timeout);
  if (!timeout) return "timeout: " + timeout.error();
  if (*timeout < std::chrono::milliseconds(1)) return refuse("timeout", setup.timeout, "at least 1ms");
  if (setup.cpu > 4) return refuse("cpu", std::to_string(setup.cpu), "none or 1 to 4");
  if (setup.cpu != 0 && setup.frame == "1E")
    return "cpu: a 1E frame names no CPU of a multiple CPU system; 3E and 4E do";
  if (!setup.cpu_type.empty() && std::ranges::find(known_cpu_types, setup.cpu_type) == known_cpu_types.end())
    return refuse("cpu_type", setup.cpu_type, text::one_of(known_cpu_types));
  if (!is_plain_text(setup.model)) return refuse("model", setup.model, "a module");
  return {};
}

std::expected<TransferSetups, std::string> read_transfer_setups() {
  const fs::path path = setups_file();
  TransferSetups setups;
  if (path.empty()) return setups;
  const auto bytes = store::real_files().read(path, longest_setup_file);
  if (!bytes && bytes.error() == ENOENT) return setups;
  if (!bytes)
    return std::unexpected(fmt::format("{}: {}", path.string(), store::describe_error(bytes.error())));
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  unsigned line = 1;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (const std::string why = read_line(text.substr(at, end - at), setups); !why.empty())
      return std::unexpected(fmt::format("{}:{}: {}", path.string(), line, why));
    at = end + 1;
  }
  return setups;
}

std::string no_such_setup(std::string_view name, const TransferSetups& setups) {
  std::vector<std::string_view> names;
  for (const auto& [known, setup] : setups) names.push_back(known);
  return fmt::format(
      "there is no transfer setup \"{}\"{}", text::printable(name),
      names.empty() ? "; `canopus configure setup set` makes one" : text::suggestion(name, names));
}

std::expected<TransferSetup, std::string> find_transfer_setup(std::string_view name) {
  const auto setups = read_transfer_setups();
  if (!setups) return std::unexpected(setups.error());
  const auto found = setups->find(name);
  if (found == setups->end()) return std::unexpected(no_such_setup(name, *setups));
  return found->second;
}

std::expected<void, SetupTrouble> change_transfer_setups(
    const std::function<std::string(TransferSetups&)>& change) {
  const auto cannot = [](std::string message) {
    return std::unexpected(SetupTrouble{.message = std::move(message)});
  };
  const fs::path path = setups_file();
  if (path.empty()) return cannot(nowhere);
  const auto lock = store::FolderLock::acquire(path.parent_path());
  if (!lock) return cannot(fmt::format("{}: {}", path.parent_path().string(), lock.error()));
  auto setups = read_transfer_setups();
  if (!setups) return std::unexpected(SetupTrouble{.is_refused = true, .message = setups.error()});
  if (std::string why = change(*setups); !why.empty())
    return std::unexpected(SetupTrouble{.is_refused = true, .message = std::move(why)});
  if (setups->size() > most_transfer_setups) {
    return std::unexpected(
        SetupTrouble{.is_refused = true,
                     .message = fmt::format("{} transfer setups are kept at most", most_transfer_setups)});
  }
  std::string text;
  for (const auto& [name, setup] : *setups) text += line_of(name, setup);
  if (std::string why = store::write_whole(path, text, store::FileReaders::owner); !why.empty())
    return cannot(std::move(why));
  return {};
}

}  // namespace canopus::cli
