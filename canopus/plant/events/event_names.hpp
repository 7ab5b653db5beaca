#pragma once
// Kinds of events by their names in docs/events.md.

#include <array>
#include <string_view>
#include <variant>

#include "canopus/plant/event.hpp"

namespace canopus::plant {

/// In the order of the alternatives of Event::what.
inline constexpr std::array<std::string_view, std::variant_size_v<decltype(Event::what)>> event_names{
    "boot",       "nmt",        "lss",     "emcy",         "unacknowledged", "bus error",
    "controller", "boot slave", "signal",  "buffer",       "forced",         "released",
    "lift",       "load",       "warning", "module event", "module error",   "error"};
static_assert(!event_names.back().empty());

/// "error", "lift".
[[nodiscard]] inline std::string_view name_of(const Event& event) noexcept {
  return event_names[event.what.index()];
}

}  // namespace canopus::plant
