#pragma once
// The command `canopus configure`: the functions of the vendor's configuration tool for a module, on the
// command line.

#include <cstdint>
#include <string>
#include <vector>

#include "canopus/cli/plc/plc_access.hpp"
#include "canopus/module_settings/module_transfer.hpp"

namespace canopus::cli {

class Command;

/// Adds the command and those in it.
void add_configure_command(Command& app, int& exit_code);

struct ConfigureArguments {
  PlcArguments plc;
  std::string file;
  std::string other_file;
  std::string model{};  ///< empty: the project's, or the one that goes with the PLC
  std::string window;
  std::vector<std::string> settings;
  std::string part = "all";
  std::string pdos = "all";
  std::string nodes = "all";
  std::string node_text{};  ///< number or name; empty: none was named
  unsigned node = 0;        ///< its node-ID; 0: the module itself, or none was named
  int module_number = -1;   ///< -1: the project's
  std::string object;
  std::string length = "BYTE_LENGTH_2";
  std::string data;
  bool yes = false;
  bool stop = false;
  bool clear = false;
  bool save = false;
  bool restore = false;
  std::string from = "slave";
  std::vector<std::string> device_files;  ///< of the nodes: files, and folders with them
  bool json = false;
  bool progress = false;
};

namespace configure_code {
inline constexpr int done = 0;
inline constexpr int failed = 1;     ///< the module or the PLC refused, or cannot be reached
inline constexpr int usage = 2;      ///< command line, project or file
inline constexpr int in_run = 3;     ///< the CPU module is in RUN
inline constexpr int different = 4;  ///< `diff` found differences, or a check found errors
}  // namespace configure_code

// The commands, by the file they are in: configure_edit.cpp, configure_show.cpp, configure_online.cpp, configure_nodes.cpp.
int new_project(const ConfigureArguments& arguments);
int show_project(const ConfigureArguments& arguments);
int set_in_project(const ConfigureArguments& arguments);
int delete_from_project(const ConfigureArguments& arguments);
int restore_in_project(const ConfigureArguments& arguments);
int check_project(const ConfigureArguments& arguments);
int export_project(const ConfigureArguments& arguments);
int import_project(const ConfigureArguments& arguments);
int undo_in_project(const ConfigureArguments& arguments);
int list_recent_projects();
int describe_windows(const ConfigureArguments& arguments);
int list_mappable_objects(const ConfigureArguments& arguments);
int read_from_module(const ConfigureArguments& arguments);
int compare_with_module(const ConfigureArguments& arguments);
int write_to_module(const ConfigureArguments& arguments);
int scan_through_module(const ConfigureArguments& arguments);
int read_object(const ConfigureArguments& arguments);
int write_object(const ConfigureArguments& arguments);
int show_module_status(const ConfigureArguments& arguments);
int reset_module(const ConfigureArguments& arguments);
int list_nodes(const ConfigureArguments& arguments);
int identify_slave(const ConfigureArguments& arguments);

/// `configure setup ...`: transfer setups (configure_setups.cpp).
void add_setup_commands(Command& configure, int& exit_code);

/// Sets `node` by `node_text`: a number, or a name of the project's node list, else of plant.toml or nodelist.cpj of the working
/// folder. Empty, or a sentence with similar names.
[[nodiscard]] std::string resolve_node(ConfigureArguments& arguments);

/// "canopus configure: ..." on stderr; returns `code`.
int configure_failed(int code, const std::string& message);

/// "all", "5-" (starting from) or "3-8", from 1 to `most`; else what was expected.
[[nodiscard]] std::expected<module_settings::PdoRange, std::string> parse_area(const std::string& text,
                                                                               unsigned most);

}  // namespace canopus::cli
