#pragma once
// Sources of node and object names for the analyser: a plant file, a network file, device files.

#include <optional>
#include <string>
#include <vector>

#include "canopus/cli/output/print.hpp"
#include "canopus/trace/decode/names.hpp"

namespace canopus::cli {

class Command;

struct NamesOptions {
  std::string plant{};
  std::string network{};
  std::vector<std::string> nodes{};  ///< "3=encoder.eds"
};

/// --plant, --network and --node.
void add_names_options(Command& command, NamesOptions& options);

/// The files that the options name, for commands that write a file.
[[nodiscard]] std::vector<std::string> files_of(const NamesOptions& options);

/// Reads the files. Nothing after their mistakes were printed on `err`.
[[nodiscard]] std::optional<trace::Names> load_names(const NamesOptions& options, Output& err);

}  // namespace canopus::cli
