#pragma once
// `canopus new FOLDER`: a plant file that boots, with its device files, from a module and a few device files, from a bus, or from
// the answers of a user at a terminal.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

class Command;

struct NewPlantOptions {
  std::string folder{};
  std::string module{};                ///< empty: it is asked for at a terminal
  std::vector<std::string> devices{};  ///< "io.eds", or with a node-ID "3=io.eds"
  std::string bit_rate{};              ///< "250k"; empty: one that all device files support
  std::string name{};                  ///< of the plant; empty: the folder's
  bool from_bus = false;               ///< the devices are those that answer on `bus`
  BusOptions bus{};
  std::vector<std::string> eds{};  ///< device files and folders of them, for `from_bus`
  bool test = false;               ///< a test for pytest as well
};

/// Writes the folder, which is new or empty. Returns the exit code: 0 written, 1 no node answers or none has a device file, 2
/// wrong usage or files; then nothing is left in the folder.
int new_plant(const NewPlantOptions& options, Output& out, Output& err);

/// Adds the subcommand `new` to the program.
void add_new_command(Command& app, int& exit_code);

}  // namespace canopus::cli
