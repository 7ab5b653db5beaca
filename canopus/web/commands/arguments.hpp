#pragma once
// What the page may have done, and the command line of `canopus` that does it. The page names none of its files and no bus but
// those that the run has.

#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/text/json.hpp"
#include "canopus/web/access/user.hpp"
#include "canopus/web/commands/command_table.hpp"
#include "canopus/web/commands/settings.hpp"

namespace canopus::web {

/// A bus that the page's commands are for.
struct WebBus {
  std::string name{};
  std::string project{};                    ///< folder or nodelist.cpj; empty: it has none
  unsigned network = 1;                     ///< of the list, from 1
  std::string address{};                    ///< for --bus; empty: commands cannot join it
  std::uint32_t bit_rate = 0;               ///< bit/s
  bool is_live = false;                     ///< it has real devices: commands that write want to be armed
  std::vector<std::string> device_files{};  ///< folders and files that devices are looked for in
};

struct WebCommandLine {
  std::string title{};  ///< "project set"
  std::string bus{};    ///< that it is for; empty: for module settings
  WebRole role = WebRole::look;
  bool joins_bus = false;
  bool writes_to_bus = false;
  WebCommand::OnBus on_bus{};
  /// Of the page's command those that are one text, by name.
  std::map<std::string, std::string, std::less<>> fields{};
  std::vector<std::string> arguments{};  ///< behind `canopus`
  std::optional<std::string>
      file_text{};          ///< goes into a file of its own, whose name takes the place of `{file}`
  std::string file_name{};  ///< that it has on the page, or of the one that is made
  bool makes_file = false;  ///< the command writes `{file}`, whose text is the answer

  /// The text of a field; empty: it is not there.
  [[nodiscard]] std::string field(std::string_view name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? std::string() : found->second;
  }
};

/// A command as the page sends it: {"command": "project set", "bus": "line1", "node": "5", "items": ["1017=500"]}. The error is a
/// sentence.
[[nodiscard]] std::expected<WebCommandLine, std::string> web_command_line(const text::Json& wish,
                                                                          const WebBus& bus);

/// Likewise {"command": "configure set", "settings": "module.xml", "window": "tpdo/5", "items": ["Event timer=100"]}.
[[nodiscard]] std::expected<WebCommandLine, std::string> web_command_line(const text::Json& wish,
                                                                          const WebSettings& settings);
/// A command of the second kind.
[[nodiscard]] bool is_web_settings_command(std::string_view name);

/// The name of a command or a field as a client sent it, in quotes and not too long for a sentence.
[[nodiscard]] std::string quoted_name(std::string_view name);

/// As a person would type it.
[[nodiscard]] std::string shown_command(const std::vector<std::string>& arguments);

}  // namespace canopus::web
