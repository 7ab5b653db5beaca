#pragma once

#include <optional>
#include <string_view>

namespace canopus::serve {

/// What a watcher of the page may say: {"messages": true} or {"messages": false}, whether it wants the decoded frames. Nothing for
/// everything else.
[[nodiscard]] std::optional<bool> wants_messages(std::string_view text);

}  // namespace canopus::serve
