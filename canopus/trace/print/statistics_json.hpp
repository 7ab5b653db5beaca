#pragma once
// Figures of a trace as JSON, as `canopus trace stats --json` prints them (docs/analyser.md).

#include <cstdint>
#include <string>

#include "canopus/text/json.hpp"
#include "canopus/trace/report/statistics.hpp"

namespace canopus::trace {

/// "183", "0A000123": of a key of ChannelFigures::identifiers.
[[nodiscard]] std::string identifier_of_key(std::uint32_t key);
/// `bit_rate`: of all channels, for their load; 0: not known.
[[nodiscard]] text::Json to_json(const Statistics& statistics, std::uint32_t bit_rate);

}  // namespace canopus::trace
