#pragma once
// Names and types for `canopus sdo`: of nodes and objects, out of a plant, a network file, a project or a device file.

#include <expected>
#include <string>

#include "canopus/cli/bus/node_names.hpp"
#include "canopus/client/sdo_request.hpp"

namespace canopus::cli {

class Command;

struct SdoNamesOptions {
  NodeNamesOptions nodes{};
  std::string eds{};
};

/// --plant, --network, --project and --eds.
void add_sdo_names_options(Command& command, SdoNamesOptions& options);

/// A node and an object as a person writes them: by number or by name, the node also as BUS:NODE. Names without an option are
/// looked up in plant.toml or nodelist.cpj of the working folder. `type` counts before that of a file. The error is a sentence that
/// names the nearest candidates; it is empty if the mistakes of a file were printed already.
[[nodiscard]] std::expected<client::SdoTarget, std::string> find_sdo_target(const SdoNamesOptions& options,
                                                                            const std::string& node,
                                                                            const std::string& object,
                                                                            const std::string& type);

}  // namespace canopus::cli
