#pragma once

#include <string_view>

namespace canopus::client {

/// A node-ID, 1..127, decimal or 0x..; 0 when it is none.
[[nodiscard]] unsigned parse_node(std::string_view text) noexcept;

}  // namespace canopus::client
