#pragma once
// Text for a table of a given width: made printable, measured as a terminal shows it (wide characters take
// two columns, combining ones none), clipped or broken so that no line wraps.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace canopus::cli {

/// The style of a part of a line on a terminal with colour.
enum class TableStyle : std::uint8_t { plain, bold, faint, good, warning, error };

struct TableSpan {
  std::string text{};
  TableStyle style = TableStyle::plain;
};
/// A line of the table, printable.
using TableLine = std::vector<TableSpan>;

/// The line without its styles.
[[nodiscard]] std::string text_of(const TableLine& line);

/// The text cut to this number of columns, with "…" for the rest.
[[nodiscard]] std::string fitted(std::string_view text, std::size_t columns);
/// The same, padded with blanks to exactly this number of columns.
[[nodiscard]] std::string padded(std::string_view text, std::size_t columns);
/// The line cut to this number of columns.
[[nodiscard]] TableLine fitted(TableLine line, std::size_t columns);
/// The text in lines of at most this number of columns, broken between words where that is possible; the
/// second and further ones begin with `indent` blanks.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, std::size_t columns,
                                               std::size_t indent);

/// A part of a line that may be left out where there is no room. `rank`: the highest ones go first.
struct TableField {
  std::string text{};
  unsigned rank = 0;
  TableStyle style = TableStyle::plain;
};
/// A name, and behind it as many of the fields as fit, in their order. The name takes at most `name_columns`,
/// and is clipped before a field of rank 0 goes.
[[nodiscard]] TableLine line_of_fields(std::string_view name, std::size_t name_columns,
                                       std::vector<TableField> fields, std::size_t columns,
                                       TableStyle name_style = TableStyle::plain);

}  // namespace canopus::cli
