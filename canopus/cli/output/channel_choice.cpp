#include "canopus/cli/output/channel_choice.hpp"

#include <algorithm>

namespace canopus::cli {

bool ChannelChoice::wants(std::string_view channel) {
  if (names_.empty()) return true;
  // most frames are of the channel of the frame before
  if (seen_.empty() || seen_.back() != channel) {
    const auto found = std::ranges::find(seen_, channel);
    if (found == seen_.end()) {
      seen_.emplace_back(channel);
    } else {
      std::swap(*found, seen_.back());
    }
  }
  return std::ranges::find(names_, channel) != names_.end();
}

bool ChannelChoice::report_missing(Output& err) const {
  constexpr std::size_t most_shown = 8;
  bool all_came = true;
  for (const std::string& name : names_) {
    if (std::ranges::find(seen_, name) != seen_.end()) continue;
    all_came = false;
    std::vector<std::string> known = seen_;
    std::ranges::sort(known);
    std::string list;
    for (std::size_t i = 0; i < std::min(known.size(), most_shown); ++i) {
      list += (i == 0 ? "" : ", ") + (known[i].empty() ? std::string("one without a name") : known[i]);
    }
    if (known.size() > most_shown) list += ", ...";
    err.line("canopus: --channel {}: no frame that was read is of this channel; there are: {}", name,
             list.empty() ? "none" : list);
  }
  return all_came;
}

}  // namespace canopus::cli
