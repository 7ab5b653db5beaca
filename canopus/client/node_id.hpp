#pragma once

#include <string_view>

#include "canopus/ascii/number.hpp"

namespace canopus::client {

/// A node-ID, 1..127, decimal or 0x..; 0 when it is none.
[[nodiscard]] inline unsigned parse_node(std::string_view text) noexcept {
  const unsigned node = ascii::parse_number_with_prefix<unsigned>(text).value_or(0);
  return node <= 127 ? node : 0;
}

}  // namespace canopus::client
