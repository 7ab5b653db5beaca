#include "canopus/text/toml.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

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
    return std::unexpected(FileError{place_of(error.source()), std::string(error.description())});
  }
}

}  // namespace canopus::text
