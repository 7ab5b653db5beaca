#pragma once
// An HTML page in one file, without scripts and without anything from elsewhere. Every text is escaped.

#include <string>
#include <string_view>
#include <vector>

namespace canopus::cli {

class ReportPage {
 public:
  explicit ReportPage(std::string_view title);

  void heading(std::string_view text);
  void paragraph(std::string_view text);
  void begin_table(const std::vector<std::string>& columns);
  /// `mark`: "", "good", "bad" or "note": the style of the row.
  void row(const std::vector<std::string>& cells, std::string_view mark = "");
  void end_table();
  /// The whole page.
  [[nodiscard]] std::string text() const;

 private:
  void add(std::string_view tag, std::string_view text);
  std::string body_;
  std::string title_;
};

}  // namespace canopus::cli
