#pragma once
// The commands of the page as tables: what each is called, who may have it done, what it takes.

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string_view>

#include "canopus/web/access/user.hpp"

namespace canopus::web {

/// A field of a command and what becomes of it. It stands here and is not read from the program's options: what a client may send
/// must not change with the command line. web_command_table_test compares the two.
struct WebCommandField {
  enum class Kind : std::uint8_t {
    option,  ///< --bit-rate=TEXT of "bit_rate"
    flag,    ///< --dry-run of "dry_run"
    word,    ///< behind the options
    words,   ///< likewise, each of a list
    file,    ///< a device file that comes along: {"name": ..., "text": ...}
  };
  std::string_view name;
  Kind kind = Kind::option;
  bool required = false;
};

struct WebCommand {
  /// How a command line names the module project.
  enum class Settings : std::uint8_t {
    none,
    file,    ///< behind the options
    option,  ///< --project=FILE
    model,   ///< --module=MODEL
  };
  /// What is done within the process, with the texts of the fields, where its bus is simulated. The command line does the same.
  struct OnBus {
    enum class Kind : std::uint8_t { none, sdo_read, sdo_write, nmt } kind = Kind::none;
    std::string_view service{};  ///< of NMT, as `canopus nmt` calls it
    bool waits = false;          ///< until the node shows its state
    std::chrono::milliseconds time_out{500};
  };
  std::string_view title;
  std::string_view words{};  ///< of the command line; empty: those of the title
  WebRole role = WebRole::look;
  bool has_project = true;
  Settings settings = Settings::none;
  bool joins_bus = false;        ///< or asks the PLC of a module
  bool writes_to_bus = false;    ///< to its devices, or to the module
  bool writes_with_yes = false;  ///< and without "yes" it prints what it would write
  bool takes_device_files = false;
  bool has_json = true;
  OnBus on_bus{};
  std::string_view makes_file{};  ///< the command writes a file of this name; empty: none
  std::array<WebCommandField, 8> fields{};
};

/// Those of a bus and its project.
[[nodiscard]] std::span<const WebCommand> web_bus_commands() noexcept;
/// Those of a module project (`canopus configure`).
[[nodiscard]] std::span<const WebCommand> web_settings_commands() noexcept;

}  // namespace canopus::web
