#pragma once
// --channel of the commands that read a trace: which channels are wanted, and which of them the trace does not have.

#include <string>
#include <string_view>
#include <vector>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

class ChannelChoice {
 public:
  /// No names: all channels.
  explicit ChannelChoice(std::vector<std::string> names) : names_(std::move(names)) {}

  /// To be asked for every record of the trace, so that report_missing() knows its channels.
  [[nodiscard]] bool wants(std::string_view channel);
  /// Says on `err` which of the names never came, and which channels there were. False: some did not come.
  bool report_missing(Output& err) const;

 private:
  std::vector<std::string> names_;
  std::vector<std::string> seen_;  // at most as many as a trace has
};

}  // namespace canopus::cli
