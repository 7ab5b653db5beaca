#include "canopus/cli/options/option_checks.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {

Choices one_of_words(const std::vector<std::string_view>& known) {
  return {.words = {known.begin(), known.end()}};
}

OptionCheck check_of(Choices choices) {
  return [words = std::move(choices.words)](const std::string& word) {
    if (std::ranges::find(words, word) != words.end()) return std::string();
    const std::vector<std::string_view> known(words.begin(), words.end());
    return fmt::format("\"{}\" is unknown{}", word, text::suggestion(word, known));
  };
}

OptionCheck number_from(std::uint64_t least, std::uint64_t most) {
  return [least, most](const std::string& text) {
    const auto value = ascii::parse_number<std::uint64_t>(text);
    const bool good = value && *value >= least && *value <= most;
    return good ? std::string() : fmt::format("\"{}\" is not a number from {} to {}", text, least, most);
  };
}

}  // namespace canopus::cli
