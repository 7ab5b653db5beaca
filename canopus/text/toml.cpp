#include "canopus/text/toml.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::text {
namespace {

/// Counts nesting levels in one pass. It agrees with the parser up to the first mistake of a text; its count
/// behind that does not matter, because the parser stops there.
class LevelCount {
 public:
  LevelCount(std::string_view text, std::size_t most) : text_(text), most_(most) {}

  /// The place where the text is nested deeper than allowed.
  std::optional<Place> too_deep() {
    while (position_ < text_.size()) {
      step();
      if (level_ > most_) return place();
    }
    return std::nullopt;
  }

 private:
  void step() {
    const char c = text_[position_];
    const bool begins_statement = is_new_statement_;
    if (c != ' ' && c != '\t' && c != '\r' && c != '\n') is_new_statement_ = false;
    switch (c) {
      case '\n': end_line(); break;
      case '#': position_ = std::min(text_.find('\n', position_), text_.size()); return;
      case '"':
      case '\'': skip_string(c); return;
      case '.': level_ += is_key_ ? 1 : 0; break;
      case '=': is_key_ = false; break;
      case ',': next_element(); break;
      case '[': begins_statement || is_header_ ? head() : open(c); break;
      case '{': open(c); break;
      case ']':
      case '}': close(); break;
      default: break;
    }
    ++position_;
  }

  /// [a.b] has two levels, [[a.b]] three, and so has each key below.
  void head() {
    if (!is_header_) level_ = 0;
    is_header_ = true;
    ++level_;
  }
  void end_line() {
    if (!open_.empty()) return;
    if (is_header_) header_ = level_;
    is_header_ = false;
    is_new_statement_ = is_key_ = true;
    level_ = header_;
  }
  void open(char bracket) {
    open_.push_back({level_, bracket == '{'});
    ++level_;
    is_key_ = bracket == '{';
  }
  void close() {
    if (open_.empty()) return;
    level_ = open_.back().level;
    open_.pop_back();
    is_key_ = false;
  }
  void next_element() {
    if (open_.empty()) return;
    level_ = open_.back().level + 1;
    is_key_ = open_.back().is_table;
  }

  void skip_string(char quote) {
    const bool is_long = text_.substr(position_).starts_with(std::string(3, quote));
    position_ += is_long ? 3 : 1;
    while (position_ < text_.size()) {
      const char c = text_[position_];
      if (c == '\n' && !is_long) return;
      if (c == '\\' && quote == '"') {
        position_ += 2;
        continue;
      }
      if (c == quote && (!is_long || text_.substr(position_).starts_with(std::string(3, quote)))) break;
      ++position_;
    }
    position_ += is_long ? 3 : 1;
    // Up to two quotes before the three that end a long string belong to it.
    for (int i = 0; i < 2 && is_long && position_ < text_.size() && text_[position_] == quote; ++i)
      ++position_;
  }

  [[nodiscard]] Place place() const {
    const std::string_view before = text_.substr(0, std::min(position_ - 1, text_.size()));
    const std::size_t line_start = before.rfind('\n') + 1;  // 0: in the first line
    return {static_cast<std::uint32_t>(1 + std::ranges::count(before, '\n')),
            static_cast<std::uint32_t>(before.size() - line_start + 1)};
  }

  struct Open {
    std::size_t level;  // outside
    bool is_table;
  };
  std::string_view text_;
  std::size_t most_;
  std::size_t position_ = 0;
  std::size_t level_ = 0;
  std::size_t header_ = 0;  // levels of the table that the lines belong to
  std::vector<Open> open_;
  bool is_header_ = false;
  bool is_new_statement_ = true;
  bool is_key_ = true;
};

/// Words that people write for true and false.
bool is_truth(std::string_view word) {
  const std::string small = ascii::lower(word);
  return small == "true" || small == "false" || small == "yes" || small == "no" || small == "on" ||
         small == "off";
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// What is wrong with `key = value`, if it is one of the usual mistakes: the mistake is in `value`, which has no
/// quotes or only one.
std::optional<std::string> explain_value(std::string_view key, std::string_view value) {
  if (value.empty()) return fmt::format("{} has no value", key);
  if (value.front() == '"' || value.front() == '\'') {
    if (value.find(value.front(), 1) == std::string_view::npos) {
      return fmt::format("the closing quote is missing: {} = \"{}\"", key, trimmed(value.substr(1)));
    }
    return std::nullopt;
  }
  if (value.front() == '[' || value.front() == '{') return std::nullopt;
  const std::string_view word = trimmed(value.substr(0, value.find_first_of(",]}#")));
  if (is_truth(word)) return fmt::format("{} = {}: expected true or false", key, word);
  if (parse_duration(word)) return fmt::format("a time must be in quotes: {} = \"{}\"", key, word);
  if (word.contains(':') && parse_object(word)) {
    return fmt::format("an object must be in quotes: {} = \"{}\"", key, word);
  }
  const bool is_number = word.find_first_not_of("0123456789abcdefABCDEFxX_.+-") == std::string_view::npos;
  if (is_number || word.empty()) return std::nullopt;
  const bool begins_as_number = word.front() >= '0' && word.front() <= '9';
  return begins_as_number
             ? fmt::format("{} = {}: expected a number without a unit, or text in quotes", key, word)
             : fmt::format("text must be in quotes: {} = \"{}\"", key, word);
}

/// The usual mistakes of people who write their first file, in the line where the parser stopped.
std::optional<std::string> explain_line(std::string_view line) {
  const std::size_t equals = line.find('=');
  const std::string_view key = trimmed(line.substr(0, equals));
  if (key.starts_with('[') || key.starts_with('#')) return std::nullopt;
  if (const std::size_t colon = key.find(':');
      colon != std::string_view::npos && !key.substr(0, colon).contains('"')) {
    if (equals == std::string_view::npos) {
      return fmt::format("expected \"=\" after a key: {} = {}", trimmed(key.substr(0, colon)),
                         trimmed(key.substr(colon + 1)));
    }
    return fmt::format("a key with \":\" must be in quotes: \"{}\"", key);
  }
  if (equals == std::string_view::npos) return std::nullopt;
  const std::string_view value = trimmed(line.substr(equals + 1));
  if (value.starts_with('{')) {  // objects = { 1017:00 = 500 }
    const std::string_view inner = trimmed(value.substr(1));
    const std::string_view inner_key = trimmed(inner.substr(0, inner.find('=')));
    if (inner_key.contains(':') && !inner_key.contains('"')) {
      return fmt::format("a key with \":\" must be in quotes: {} = {{ \"{}\" = ... }}", key, inner_key);
    }
  }
  return explain_value(key, value);
}

/// Line `number` of a text, from 1.
std::string_view line_of(std::string_view text, std::uint32_t number) {
  for (; number > 1; --number) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return text.substr(0, text.find('\n'));
}

FileError explain(std::string_view text, const toml::parse_error& error) {
  const Place place = place_of(error.source());
  if (auto known = explain_line(line_of(text, place.line))) return {place, std::move(*known)};
  std::string_view description = error.description();
  constexpr std::string_view prefix = "Error while parsing ";
  if (description.starts_with(prefix)) description.remove_prefix(prefix.size());
  constexpr std::string_view again = "cannot redefine existing ";
  if (const std::size_t at = description.find(again); at != std::string_view::npos) {
    std::string_view key = description.substr(at + again.size());
    key = key.substr(std::min(key.find('\''), key.size()));
    return {place, fmt::format("{} is in this table already; expected it once", key)};
  }
  return {place, std::string(description)};
}

}  // namespace

std::expected<toml::table, FileError> parse_toml(std::string_view text, TomlLimits limits) {
  if (text.size() > limits.bytes) {
    return std::unexpected(FileError{
        {1, 1}, fmt::format("the text has {} bytes; expected at most {}", text.size(), limits.bytes)});
  }
  if (const auto place = LevelCount(text, limits.depth).too_deep()) {
    return std::unexpected(
        FileError{*place, fmt::format("tables and arrays, or the parts of a key, are nested deeper than {} "
                                      "levels; expected at most {}",
                                      limits.depth, limits.depth)});
  }
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    return std::unexpected(explain(text, error));
  }
}

}  // namespace canopus::text
