#pragma once
// Bit rates as people write them on a command line and on the page.

#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "canopus/can/controller.hpp"

namespace canopus::text {

/// "500k", "1M", "125 kbit/s", "250000": in bit/s. `known`: no others; 0 is none. The error is "expected 10k, 20k, ... or 1M".
[[nodiscard]] std::expected<std::uint32_t, std::string> parse_bit_rate(
    std::string_view text, std::span<const std::uint32_t> known = can::bit_rates);

}  // namespace canopus::text
