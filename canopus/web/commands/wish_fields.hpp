#pragma once
// Fields of a command as the page sends it, an object of JSON.

#include <cstdint>
#include <optional>

#include "canopus/text/json.hpp"

namespace canopus::web {

/// A whole number from `least` to `most`; nothing: the field is missing, or something else.
[[nodiscard]] inline std::optional<std::uint64_t> number_field(const text::Json& wish, const char* key,
                                                               std::uint64_t least, std::uint64_t most) {
  const auto value = wish.find(key);
  if (value == wish.end() || !value->is_number_unsigned()) return std::nullopt;
  const auto number = value->get<std::uint64_t>();
  return number >= least && number <= most ? std::optional(number) : std::nullopt;
}

}  // namespace canopus::web
