#pragma once
// Letters, blanks and words of ASCII text, whatever the locale. Bytes beyond 7FH are no letters, digits or blanks.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::ascii {

constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) noexcept { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
/// A blank or a tabulator: what is between the words of a line.
constexpr bool is_blank(char c) noexcept { return c == ' ' || c == '\t'; }

constexpr char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
constexpr char upper(char c) noexcept { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
[[nodiscard]] inline std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = lower(c);
  return result;
}
[[nodiscard]] inline std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = upper(c);
  return result;
}

[[nodiscard]] constexpr bool equal_ignoring_case(std::string_view a, std::string_view b) noexcept {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) { return lower(x) == lower(y); });
}
/// True when `part` stands somewhere in `text`; an empty one does.
[[nodiscard]] constexpr bool contains_ignoring_case(std::string_view text, std::string_view part) noexcept {
  return part.empty() || std::search(text.begin(), text.end(), part.begin(), part.end(),
                                     [](char x, char y) { return lower(x) == lower(y); }) != text.end();
}

/// Without blanks at both ends. `is_between`: which characters are blanks, for formats that have more of them.
template <typename IsBetween>
[[nodiscard]] constexpr std::string_view trim(std::string_view text, IsBetween is_between) noexcept {
  while (!text.empty() && is_between(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_between(text.back())) text.remove_suffix(1);
  return text;
}
[[nodiscard]] constexpr std::string_view trim(std::string_view text) noexcept { return trim(text, is_blank); }

/// Takes the first word off `text`, with the blanks before it; empty when there is none.
template <typename IsBetween>
[[nodiscard]] constexpr std::string_view next_word(std::string_view& text, IsBetween is_between) noexcept {
  std::size_t begin = 0;
  while (begin < text.size() && is_between(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !is_between(text[end])) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}
[[nodiscard]] constexpr std::string_view next_word(std::string_view& text) noexcept {
  return next_word(text, is_blank);
}

/// All words of a line.
[[nodiscard]] inline std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> found;
  for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) found.push_back(word);
  return found;
}

}  // namespace canopus::ascii
