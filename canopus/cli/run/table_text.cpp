#include "canopus/cli/run/table_text.hpp"

#include <algorithm>

#include "canopus/text/printable.hpp"

namespace canopus::cli {
namespace {

constexpr std::string_view ellipsis = "…";

std::string blanks(std::size_t count) { return std::string(count, ' '); }

}  // namespace

std::string text_of(const TableLine& line) {
  std::string text;
  for (const TableSpan& span : line) text += span.text;
  return text;
}

std::string fitted(std::string_view text, std::size_t columns) {
  std::string safe = text::printable(text);
  if (text::columns_of(safe) <= columns) return safe;
  if (columns == 0) return {};
  return std::string(text::clipped(safe, columns - 1)) += ellipsis;
}

std::string padded(std::string_view text, std::size_t columns) {
  std::string exact = fitted(text, columns);
  return exact += blanks(columns - std::min(columns, text::columns_of(exact)));
}

TableLine fitted(TableLine line, std::size_t columns) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    const std::size_t wanted = text::columns_of(line[i].text);
    if (wanted <= columns) {
      columns -= wanted;
      continue;
    }
    line[i].text = fitted(line[i].text, columns);
    line.resize(i + 1);
  }
  return line;
}

std::vector<std::string> wrapped(std::string_view text, std::size_t columns, std::size_t indent) {
  columns = std::max<std::size_t>(columns, 1);
  if (2 * indent >= columns) indent = 0;
  const std::string safe = text::printable(text);
  std::string_view rest = safe;
  std::vector<std::string> lines;
  while (!rest.empty()) {
    std::string line = blanks(lines.empty() ? 0 : indent);
    std::string_view piece = text::clipped(rest, columns - line.size());
    if (piece.empty()) {  // a wide character, and one column
      lines.push_back(line += ellipsis);
      break;
    }
    if (piece.size() < rest.size() && rest[piece.size()] != ' ') {
      const std::size_t blank = piece.rfind(' ');
      if (blank != std::string_view::npos && blank != 0) piece = piece.substr(0, blank);
    }
    lines.push_back(line += piece);
    rest.remove_prefix(piece.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  }
  return lines;
}

TableLine line_of_fields(std::string_view name, std::size_t name_columns, std::vector<TableField> fields,
                         std::size_t columns, TableStyle name_style) {
  const std::string_view gap = columns < 60 ? "  " : "   ";
  const std::size_t least_name =
      std::min<std::size_t>({text::columns_of(text::printable(name)), name_columns, 8});
  const auto width = [&] {
    std::size_t all = 0;
    for (const TableField& field : fields) all += gap.size() + text::columns_of(field.text);
    return all;
  };
  while (!fields.empty() && least_name + width() > columns) {
    const auto least = std::ranges::max_element(fields, {}, &TableField::rank);
    if (least->rank == 0) break;
    fields.erase(least);
  }
  const std::size_t taken = width();
  const std::size_t room = columns - std::min(columns, taken);
  TableLine line{
      {padded(name, std::min(name_columns, std::max(room, std::min(columns, least_name)))), name_style}};
  for (TableField& field : fields) {
    line.push_back({std::string(gap)});
    line.push_back({std::move(field.text), field.style});
  }
  return fitted(std::move(line), columns);
}

}  // namespace canopus::cli
