#include "canopus/trace/file/csv_head.hpp"

#include <algorithm>
#include <array>

#include "canopus/ascii/words.hpp"

namespace canopus::trace {
namespace {

/// In lower case, without blanks, underscores and hyphens.
struct ColumnName {
  std::string_view name;
  CsvColumn column;
};
constexpr std::array column_names{
    ColumnName{"time", CsvColumn::time},
    ColumnName{"timestamp", CsvColumn::time},
    ColumnName{"abstime", CsvColumn::time},
    ColumnName{"timeoffset", CsvColumn::time},
    ColumnName{"channel", CsvColumn::channel},
    ColumnName{"bus", CsvColumn::channel},
    ColumnName{"network", CsvColumn::channel},
    ColumnName{"interface", CsvColumn::channel},
    ColumnName{"direction", CsvColumn::direction},
    ColumnName{"dir", CsvColumn::direction},
    ColumnName{"rx/tx", CsvColumn::direction},
    ColumnName{"tx/rx", CsvColumn::direction},
    ColumnName{"id", CsvColumn::identifier},
    ColumnName{"arbitrationid", CsvColumn::identifier},
    ColumnName{"arbid", CsvColumn::identifier},
    ColumnName{"canid", CsvColumn::identifier},
    ColumnName{"identifier", CsvColumn::identifier},
    ColumnName{"messageid", CsvColumn::identifier},
    ColumnName{"msgid", CsvColumn::identifier},
    ColumnName{"extended", CsvColumn::extended},
    ColumnName{"isextended", CsvColumn::extended},
    ColumnName{"ext", CsvColumn::extended},
    ColumnName{"xtd", CsvColumn::extended},
    ColumnName{"ide", CsvColumn::extended},
    ColumnName{"remote", CsvColumn::remote},
    ColumnName{"isremote", CsvColumn::remote},
    ColumnName{"rtr", CsvColumn::remote},
    ColumnName{"error", CsvColumn::error},
    ColumnName{"iserror", CsvColumn::error},
    ColumnName{"fd", CsvColumn::fd},
    ColumnName{"isfd", CsvColumn::fd},
    ColumnName{"fdf", CsvColumn::fd},
    ColumnName{"edl", CsvColumn::fd},
    ColumnName{"dlc", CsvColumn::dlc},
    ColumnName{"len", CsvColumn::dlc},
    ColumnName{"length", CsvColumn::dlc},
    ColumnName{"datalength", CsvColumn::dlc},
    ColumnName{"data", CsvColumn::data},
    ColumnName{"databytes", CsvColumn::data},
    ColumnName{"payload", CsvColumn::data},
};

struct TimeUnit {
  std::string_view name;
  std::int64_t nanoseconds;
};
constexpr std::array time_units{
    TimeUnit{"s", 1'000'000'000}, TimeUnit{"sec", 1'000'000'000}, TimeUnit{"seconds", 1'000'000'000},
    TimeUnit{"ms", 1'000'000},    TimeUnit{"msec", 1'000'000},    TimeUnit{"us", 1'000},
    TimeUnit{"\xC2\xB5s", 1'000}, TimeUnit{"\xCE\xBCs", 1'000},   TimeUnit{"ns", 1}};

/// D1, B0, Byte 3, Data[7]: a column for one byte.
bool is_byte_column(std::string_view name) {
  const std::size_t digits = std::min(name.find_first_of("0123456789"), name.size());
  const std::string_view stem = name.substr(0, digits);
  const std::string_view number = name.substr(digits);
  return (stem == "d" || stem == "b" || stem == "byte" || stem == "data" || stem == "data[") &&
         !number.empty() && number.find_first_not_of("0123456789]") == std::string_view::npos;
}

/// A name without what does not matter, and what stands in brackets behind it: "time" and "ms" of "Time (ms)".
struct PlainName {
  std::string name, unit;
};

PlainName plain(std::string_view field) {
  PlainName result;
  std::size_t bracket = field.find_first_of("([");
  if (bracket == 0 || field.substr(0, bracket).ends_with("ata"))
    bracket = field.find('(');  // Data[7] is a name
  for (const char c : field.substr(0, bracket)) {
    if (c != ' ' && c != '_' && c != '-' && c != '\t') result.name += ascii::lower(c);
  }
  if (bracket != std::string_view::npos) {
    const std::string_view rest = field.substr(bracket + 1);
    for (const char c : rest.substr(0, rest.find_first_of(")]"))) result.unit += ascii::lower(c);
  }
  return result;
}

char separator_of(std::string_view line) {
  for (const char separator : {';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ',';
}

}  // namespace

bool CsvHead::has(CsvColumn column) const noexcept {
  return std::ranges::find(columns, column) != columns.end();
}

std::string_view CsvHead::time_unit_name() const noexcept {
  switch (time_unit) {
    case 1: return "ns";
    case 1'000: return "us";
    case 1'000'000: return "ms";
    default: return "seconds";
  }
}

std::string take_csv_field(std::string_view& row, char separator) {
  std::string field;
  if (!row.starts_with('"')) {
    const std::size_t end = std::min(row.find(separator), row.size());
    field = row.substr(0, end);
    row.remove_prefix(end);
  } else {
    row.remove_prefix(1);
    while (!row.empty()) {
      if (row.starts_with("\"\"")) {
        row.remove_prefix(1);
      } else if (row.front() == '"') {
        break;
      }
      field += row.front();
      row.remove_prefix(1);
    }
    if (!row.empty()) row.remove_prefix(1);
  }
  return field;
}

std::optional<CsvHead> parse_csv_head(std::string_view line) {
  constexpr std::size_t most_columns = 96;  // 64 bytes, and what stands before them
  if (line.ends_with('\r')) line.remove_suffix(1);
  CsvHead head{.separator = separator_of(line)};
  bool has_stamp = false;
  while (!line.empty()) {
    if (head.columns.size() == most_columns) return std::nullopt;
    const std::string field = take_csv_field(line, head.separator);
    if (!line.empty()) line.remove_prefix(1);
    const PlainName name = plain(field);
    const auto* const found = std::ranges::find(column_names, name.name, &ColumnName::name);
    CsvColumn column = found == column_names.end() ? CsvColumn::other : found->column;
    if (is_byte_column(name.name)) {
      column = CsvColumn::data;
      head.has_byte_columns = true;
    } else if (column != CsvColumn::other && head.has(column)) {
      column = CsvColumn::other;  // the first of several is the one
    }
    if (column == CsvColumn::time) {
      has_stamp = field == "Time Stamp";
      const auto* const unit = std::ranges::find(time_units, name.unit, &TimeUnit::name);
      if (unit != time_units.end()) head.time_unit = unit->nanoseconds;
    }
    if (column == CsvColumn::identifier) {
      head.is_base64 = field == "arbitration_id";
      if (name.unit == "dec") head.identifier_base = 10;
    }
    head.columns.push_back(column);
  }
  if (!head.has(CsvColumn::identifier) || !head.has(CsvColumn::data)) return std::nullopt;
  head.is_gvret = has_stamp && head.has_byte_columns;
  if (head.is_gvret) head.time_unit = 1'000;
  return head;
}

}  // namespace canopus::trace
