#pragma once
// The known word that a mistyped one probably means.

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::text {

/// The word of `known` nearest to `word`, or nothing when none is near: a letter more, less or other, two
/// neighbours exchanged (one such mistake in a word of up to four letters, else two), or the beginning of
/// exactly one of them. Small and capital letters are the same.
[[nodiscard]] std::string_view nearest(std::string_view word, std::span<const std::string_view> known);

/// "read", "read or write", "read, write or type".
[[nodiscard]] std::string one_of(std::span<const std::string_view> known);

/// `; did you mean "read"?` when one is near, else `; expected read, write or type`.
[[nodiscard]] std::string suggestion(std::string_view word, std::span<const std::string_view> known);

}  // namespace canopus::text
