#pragma once
// The command `canopus project`: CiA 306 projects of CANopen networks, from the command line.

#include <functional>
#include <string>
#include <vector>

#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/network_project/project_folder.hpp"

namespace canopus::cli {

class Command;

/// Adds the command and those in it.
void add_project_command(Command& app, int& exit_code);

/// Exit codes of `canopus project`, one for each kind of failure.
namespace project_code {
inline constexpr int done = 0;
inline constexpr int no_answer = 1;  ///< no bus, or a node that does not answer
inline constexpr int usage = 2;      ///< command line
inline constexpr int file = 3;       ///< a file cannot be read or written, or is none of its kind
inline constexpr int different =
    4;  ///< `diff` found differences, `check` errors; `write` would change something
inline constexpr int refused = 5;  ///< the project cannot be as it was asked for
inline constexpr int aborted = 6;  ///< a node refused a value, or has another one after a write
}  // namespace project_code

struct ProjectArguments {
  BusOptions bus;  ///< its `json` is that of all commands
  std::string project;
  unsigned network = 1;  ///< of the list, from 1
  std::string node;
  std::vector<std::string> items;  ///< settings, objects, signals
  std::string file;
  std::vector<std::string> eds;
  std::string name;
  std::string note;
  std::string reference;
  std::string bit_rate;
  std::string pdo;
  std::string cob_id;
  std::string type;
  std::string inhibit;
  std::string event;
  unsigned node_id = 0;
  bool is_named = false;  ///< --name was given
  bool has_reference = false;
  bool present = false;
  bool absent = false;
  bool strict = false;
  bool yes = false;
  bool all_values = false;
  bool save = false;
  bool no_values = false;
  bool dry_run = false;
  bool with_devices = false;
  std::string nodes = "1-127";
  std::string plant;
};

// The commands, by the file they are in: project_show.cpp, project_edit.cpp, project_dcf.cpp, project_pdo.cpp, project_bus.cpp,
// project_adopt.cpp, project_accept.cpp, project_report.cpp.
int show_network(const ProjectArguments& arguments);
int check_network(const ProjectArguments& arguments);
int new_network(const ProjectArguments& arguments);
int add_network_node(const ProjectArguments& arguments);
int remove_network_node(const ProjectArguments& arguments);
int note_in_network(const ProjectArguments& arguments);
int set_in_network(const ProjectArguments& arguments);
int unset_in_network(const ProjectArguments& arguments);
int undo_in_network(const ProjectArguments& arguments);
int write_concise_dcf(const ProjectArguments& arguments);
int save_dcf(const ProjectArguments& arguments);
int compare_dcf(const ProjectArguments& arguments);
int load_dcf(const ProjectArguments& arguments);
int list_network_pdos(const ProjectArguments& arguments);
int map_network_pdo(const ProjectArguments& arguments);
int switch_network_pdo_off(const ProjectArguments& arguments);
int link_network_signals(const ProjectArguments& arguments);
int compare_network(const ProjectArguments& arguments);
int write_network(const ProjectArguments& arguments);
int read_network(const ProjectArguments& arguments);
int adopt_network(const ProjectArguments& arguments);
int accept_device(const ProjectArguments& arguments);
int report_network(const ProjectArguments& arguments);

/// "canopus project: ..." on stderr; returns `code`.
int project_failed(int code, const std::string& message);

/// The value of --bit-rate in bit/s; nothing written: 0. The error names the option.
[[nodiscard]] std::expected<std::uint32_t, std::string> bit_rate_of(const std::string& text);

/// Opens the project read-only, and prints its errors.
int with_network(
    const ProjectArguments& arguments,
    const std::function<int(const ProjectFolder&, const network_project::NetworkProject&)>& action);
/// Opens the project, runs the action on it, and saves it if that returns done, or no_answer or different:
/// the results for the other nodes are kept. `title` is for undo.
int change_network(const ProjectArguments& arguments, const std::string& title,
                   const std::function<int(ProjectFolder&, network_project::NetworkProject&)>& action);

}  // namespace canopus::cli
