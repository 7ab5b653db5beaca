#pragma once
// What the values of options are checked for while the command line is read, for CLI::Option::check().

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {

/// Empty when the value is good, else what is wrong with it.
using OptionCheck = std::function<std::string(const std::string&)>;

/// One of these words. The validator's name is the list of them, for words_of().
[[nodiscard]] inline CLI::Validator one_of_words(std::vector<std::string_view> known) {
  std::string name = fmt::format("{}", fmt::join(known, "|"));
  auto check = [known = std::move(known)](const std::string& word) {
    for (const std::string_view candidate : known) {
      if (word == candidate) return std::string();
    }
    return fmt::format("\"{}\" is unknown{}", word, text::suggestion(word, known));
  };
  return {std::move(check), "", std::move(name)};
}

/// The words of one_of_words() from its validator's name; of another validator's name none.
[[nodiscard]] inline std::vector<std::string> words_of(std::string_view validator_name) {
  std::vector<std::string> words;
  while (!validator_name.empty()) {
    const std::size_t end = std::min(validator_name.find('|'), validator_name.size());
    words.emplace_back(validator_name.substr(0, end));
    validator_name.remove_prefix(std::min(end + 1, validator_name.size()));
  }
  return words;
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
