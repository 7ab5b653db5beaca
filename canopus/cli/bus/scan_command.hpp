#pragma once
// `canopus scan`: which nodes are on a bus, what they are and in which NMT state.

#include <cstdint>
#include <expected>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/bus/node_names.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/client/bus_scan.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {

class Command;

/// Node-IDs, both included.
struct NodeRange {
  std::uint8_t first = 1;
  std::uint8_t last = 127;
};
/// "1-32", "5"; the error names --nodes and what was expected.
[[nodiscard]] std::expected<NodeRange, std::string> parse_node_range(std::string_view text);
/// Scans a bus, with a progress bar on a terminal. Returns an exit code, and prints its reason.
[[nodiscard]] int scan_bus(BusLoop& bus, NodeRange range, can::Duration time_out,
                           std::vector<client::FoundNode>& found);

/// Names that a plant, network file or project has, by node-ID.
using NamesOfNodes = std::map<std::uint8_t, std::string>;
/// Those of a bus; with an empty name of the node-IDs that are on one bus alone.
[[nodiscard]] NamesOfNodes names_on_channel(const trace::Names& names, std::string_view bus);

/// The table, a header line and a line per node. `colour`: states in colour. With names the device's own name (1008H) is a
/// further column.
[[nodiscard]] std::vector<Line> scan_table(const std::vector<client::FoundNode>& nodes, bool colour,
                                           const NamesOfNodes& names = {});
/// One JSON object for a node; unknown values are left out.
[[nodiscard]] text::Json scan_json(const client::FoundNode& node, const NamesOfNodes& names = {});
/// "[######----]  64 of 127 nodes asked, 3 found"
[[nodiscard]] std::string scan_progress(unsigned asked, unsigned of, std::size_t found);

/// Adds the subcommand `scan` to the program. When the user asks for it, parsing runs it and puts the exit
/// code into `exit_code`.
void add_scan_command(Command& app, int& exit_code);

}  // namespace canopus::cli
