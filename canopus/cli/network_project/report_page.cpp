#include "canopus/cli/network_project/report_page.hpp"

#include <fmt/format.h>

#include "canopus/text/printable.hpp"

namespace canopus::cli {
namespace {

constexpr std::string_view style =
    "body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:75rem;padding:0 "
    "1rem;color-scheme:light dark}"
    "h1{font-size:1.6rem}h2{font-size:1.15rem;margin-top:2rem}"
    "table{border-collapse:collapse;width:100%;font-size:.9rem}"
    "th,td{text-align:left;vertical-align:top;padding:.25rem .6rem;border-bottom:1px solid #8885}"
    "th{font-weight:600}tr.bad td{background:#f003}tr.note td{opacity:.75}tr.good td{background:#0a03}"
    "@media print{body{margin:0;max-width:none}}";

/// Names come from strangers' files.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text::printable(text)) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  }
  return result;
}

}  // namespace

ReportPage::ReportPage(std::string_view title) : title_(escaped(title)) { add("h1", title); }

void ReportPage::add(std::string_view tag, std::string_view text) {
  body_ += fmt::format("<{}>{}</{}>\n", tag, escaped(text), tag);
}

void ReportPage::heading(std::string_view text) { add("h2", text); }

void ReportPage::paragraph(std::string_view text) { add("p", text); }

void ReportPage::begin_table(const std::vector<std::string>& columns) {
  body_ += "<table>\n<thead><tr>";
  for (const std::string& column : columns)
    body_ += fmt::format("<th scope=\"col\">{}</th>", escaped(column));
  body_ += "</tr></thead>\n<tbody>\n";
}

void ReportPage::row(const std::vector<std::string>& cells, std::string_view mark) {
  body_ += mark.empty() ? std::string("<tr>") : fmt::format("<tr class=\"{}\">", mark);
  for (const std::string& cell : cells) body_ += fmt::format("<td>{}</td>", escaped(cell));
  body_ += "</tr>\n";
}

void ReportPage::end_table() { body_ += "</tbody>\n</table>\n"; }

std::string ReportPage::text() const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n"
      "{}</body>\n</html>\n",
      title_, style, body_);
}

}  // namespace canopus::cli
