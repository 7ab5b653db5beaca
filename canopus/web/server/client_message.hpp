#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::web {

/// A message of a client that watches: {"messages": true} or {"messages": false}, whether it wants the decoded frames;
/// {"views": [{...}, ...]}, what else it looks at (docs/web.md): up to `most_views` objects, each in place of what it looked at
/// before; {"do": {...}, "id": N}, a command, whose replies have that number.
struct ClientMessage {
  static constexpr std::size_t most_views = 8;
  static constexpr std::size_t longest_view = 1024;  ///< bytes of its JSON
  struct Command {
    std::string text{};  ///< the object, as JSON
    std::uint32_t id = 0;
  };

  std::optional<bool> messages{};
  std::optional<std::vector<std::string>> views{};  ///< each as JSON
  std::optional<Command> command{};
};

/// Nothing for everything else.
[[nodiscard]] std::optional<ClientMessage> parse_client_message(std::string_view text);

}  // namespace canopus::web
