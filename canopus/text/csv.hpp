#pragma once
// Files of an engineering tool: their encoding, and the rows of a CSV.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::text {

/// UTF-16 with a byte order mark, UTF-8, or CP932 become UTF-8. The error names what was expected.
[[nodiscard]] std::expected<std::string, std::string> utf8_of(std::string_view bytes);

/// Rows of fields, with or without quotes; "" in quotes is one. The separator is the first of tabulator, comma and semicolon that stands
/// outside of quotes in the first ten lines.
class CsvReader {
 public:
  /// `text` must outlive it.
  explicit CsvReader(std::string_view text);

  [[nodiscard]] bool is_at_end() const noexcept { return at_ >= text_.size(); }
  /// The line of what comes next, from 1: a field in quotes may have several.
  [[nodiscard]] std::uint32_t line() const noexcept { return line_; }
  /// The next row. What is wrong with it is written to `error`.
  [[nodiscard]] std::vector<std::string> row(std::string& error);

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 1;
  char separator_ = ',';
};

}  // namespace canopus::text
