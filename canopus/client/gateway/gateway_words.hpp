#pragma once
// The words of one line of a gateway's client.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "canopus/client/gateway/gateway_value.hpp"

namespace canopus::client {

/// The rest of a line, word by word, and what stood in front of its command.
struct GatewayWords {
  std::string_view rest;
  std::vector<std::uint64_t> numbers{};  ///< in front: node, or network and node
  std::uint8_t node = 0;

  std::string_view take() { return take_gateway_word(rest); }
  /// None: the next word is no number, or not in these bounds.
  std::optional<std::uint64_t> number(std::uint64_t least, std::uint64_t most) {
    const auto value = gateway_number(take());
    return value && *value >= least && *value <= most ? value : std::nullopt;
  }
  [[nodiscard]] bool over() const {
    std::string_view copy = rest;
    return take_gateway_word(copy).empty();
  }
};

}  // namespace canopus::client
