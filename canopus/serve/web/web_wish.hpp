#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::serve {

/// What a watcher of the page says: {"messages": true} or {"messages": false}, whether it wants the decoded frames;
/// {"views": [{...}, ...]}, what else it looks at (docs/web.md): up to `most_views` objects, each in place of what it looked at
/// before.
struct WebWish {
  static constexpr std::size_t most_views = 4;

  std::optional<bool> messages{};
  std::optional<std::vector<std::string>> views{};  ///< each as JSON
};

/// Nothing for everything else.
[[nodiscard]] std::optional<WebWish> read_wish(std::string_view text);

}  // namespace canopus::serve
