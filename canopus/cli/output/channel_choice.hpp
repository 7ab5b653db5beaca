#pragma once
// --channel of the commands that read a trace: the selected channels, and those of them that the trace does
// not have.

#include <string>
#include <string_view>
#include <vector>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

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
