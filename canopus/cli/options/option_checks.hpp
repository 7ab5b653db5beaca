#pragma once
// Checks of option values during parsing, for Option::check().

#include <cstdint>
#include <string_view>
#include <vector>

#include "canopus/cli/options/command.hpp"

namespace canopus::cli {

/// One of these words.
[[nodiscard]] Choices one_of_words(const std::vector<std::string_view>& known);

/// The check of one_of_words().
[[nodiscard]] OptionCheck check_of(Choices choices);

/// A decimal number, `least` to `most`.
[[nodiscard]] OptionCheck number_from(std::uint64_t least, std::uint64_t most);

}  // namespace canopus::cli
