#pragma once
// Common to the commands that join a bus (sdo, nmt, scan, lss, master): their options, exit codes and error
// messages.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "canopus/cli/output/print.hpp"
#include "canopus/client/node_id.hpp"
#include "canopus/link/bus_loop.hpp"

namespace canopus::cli {

class Command;

using link::BusLoop;

/// Exit codes of these commands.
namespace exit_code {
inline constexpr int done = 0;
inline constexpr int failed = 1;  ///< the bus or a node refused, or does not answer
inline constexpr int usage = 2;   ///< wrong command line or file
}  // namespace exit_code

struct BusOptions {
  std::string bus = "socketcand:127.0.0.1:29536";
  std::string time_out = "500ms";
  bool json = false;
};

/// --bus
void add_bus_option(Command& command, std::string& bus);
/// --bus and --timeout (`time_out` is its help text), and --json where `with_json`.
void add_bus_options(Command& command, BusOptions& options, const char* time_out, bool with_json = true);

/// "canopus: ..." on stderr; returns `code`.
int complain(int code, std::string_view message);

enum class BusTime : std::uint8_t {
  of_this_process,  ///< while it is suspended no time passes: no answer is late (BusLoop::extend_timeouts)
  real,             ///< for commands that send by the clock
};

/// Joins the bus, calls the action with it and the time-out; its result is the exit code. Prints an error
/// itself about what is wrong with the options or the bus.
int with_bus(const BusOptions& options, const std::function<int(BusLoop&, can::Duration)>& action,
             BusTime time = BusTime::of_this_process);

/// Prints an error for an end of BusLoop::run() other than done; `time_over` is the text for a timeout.
int complain_of(BusLoop::End end, const BusLoop& bus, std::string_view time_over);

using client::parse_node;

}  // namespace canopus::cli
