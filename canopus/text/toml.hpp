#pragma once
// The only way from a TOML text to its values. toml++ recurses for each level of nesting, dotted keys too,
// when it builds, changes and deletes a table: so the depth and size of untrusted text are checked before.

#include <expected>
#include <string_view>

#include <toml++/toml.h>

#include "canopus/text/file_error.hpp"

namespace canopus::text {

struct TomlLimits {
  std::size_t depth = 64;  ///< tables and arrays within each other; [a.b] and a.b.c = 1 have two
  std::size_t bytes = std::size_t{4} << 20;
};

/// The place where a node of the file begins.
[[nodiscard]] inline Place place_of(const toml::source_region& region) {
  return {static_cast<std::uint32_t>(region.begin.line), static_cast<std::uint32_t>(region.begin.column)};
}

/// The first mistake in a text, with its place; of one that is beyond the limits, what is allowed.
[[nodiscard]] std::expected<toml::table, FileError> parse_toml(std::string_view text, TomlLimits limits = {});

}  // namespace canopus::text
