#pragma once
// Sources of node and object names for the analyser: a plant file, a network file, a project, device files.

#include <optional>
#include <string>
#include <vector>

#include "canopus/cli/bus/node_names.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/trace/decode/names.hpp"

namespace canopus::cli {

class Command;

struct NamesOptions {
  NodeNamesOptions of{};
  std::vector<std::string> device_files{};  ///< "3=encoder.eds"
};

/// --plant, --network, --project and --eds.
void add_names_options(Command& command, NamesOptions& options);

/// The files that the options name, for commands that write a file.
[[nodiscard]] std::vector<std::string> files_of(const NamesOptions& options);

/// Reads the files. Nothing after their mistakes were printed on `err`.
[[nodiscard]] std::optional<trace::Names> load_names(const NamesOptions& options, Output& err);

}  // namespace canopus::cli
