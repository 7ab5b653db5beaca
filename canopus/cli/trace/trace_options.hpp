#pragma once
// Options that the commands on traces have in common: where the names of nodes and objects come from (a plant file, a network file, a
// project, device files), which messages are wanted, which channels.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/cli/bus/node_names.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/trace/decode/names.hpp"
#include "canopus/trace/filter/message_filter.hpp"

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

/// --filter, --node, --service, --object, --can-id; --channel, --from and --to where `of_file`.
void add_filter_options(Command& command, trace::FilterOptions& options, bool of_file);

/// --channel of the commands that read a trace: the selected channels, and those of them that the trace does
/// not have.
class ChannelChoice {
 public:
  /// No names: all channels.
  explicit ChannelChoice(std::vector<std::string> names) : names_(std::move(names)) {}

  /// Call it for every record of the trace, so that report_missing() has all channels.
  [[nodiscard]] bool wants(std::string_view channel);
  /// Prints on `err` the names that never came, and the channels of the trace. False: some did not come.
  bool report_missing(Output& err) const;

 private:
  std::vector<std::string> names_;
  std::vector<std::string> seen_;  // at most as many as a trace has
};

}  // namespace canopus::cli
