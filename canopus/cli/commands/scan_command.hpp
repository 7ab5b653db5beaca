#pragma once
// `canopus scan`: which nodes are on a bus, what they are and in which NMT state.

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "canopus/cli/terminal/print.hpp"
#include "canopus/client/bus_scan.hpp"

namespace CLI {
class App;
}

namespace canopus::cli {

/// The table, a header line and a line per node. `colour`: states in colour.
[[nodiscard]] std::vector<Line> scan_table(const std::vector<client::FoundNode>& nodes, bool colour);
/// One JSON object for a node; what is not known is left out.
[[nodiscard]] nlohmann::ordered_json scan_json(const client::FoundNode& node);
/// "[######----]  64 of 127 nodes asked, 3 found"
[[nodiscard]] std::string scan_progress(unsigned asked, unsigned of, std::size_t found);

/// Adds the subcommand `scan` to the program. When the user asks for it, parsing runs it and puts the exit
/// code into `exit_code`.
void add_scan_command(CLI::App& app, int& exit_code);

}  // namespace canopus::cli
