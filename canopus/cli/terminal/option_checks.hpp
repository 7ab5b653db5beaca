#pragma once
// What the values of options are checked for while the command line is read, for CLI::Option::check().

#include <charconv>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {

/// Empty when the value is good, else what is wrong with it.
using OptionCheck = std::function<std::string(const std::string&)>;

/// One of these words.
[[nodiscard]] inline OptionCheck one_of_words(std::vector<std::string_view> known) {
  return [known = std::move(known)](const std::string& word) {
    for (const std::string_view candidate : known) {
      if (word == candidate) return std::string();
    }
    return fmt::format("\"{}\" is unknown{}", word, text::suggestion(word, known));
  };
}

/// A decimal number, `least` to `most`.
[[nodiscard]] inline OptionCheck number_from(std::uint64_t least, std::uint64_t most) {
  return [least, most](const std::string& text) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data(), end, value);
    const bool good = failure == std::errc{} && stop == end && value >= least && value <= most;
    return good ? std::string() : fmt::format("\"{}\" is not a number from {} to {}", text, least, most);
  };
}

}  // namespace canopus::cli
