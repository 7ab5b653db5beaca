// The reader of traces as tables: python-can's (`arbitration_id`, data in base64) and our own (`id`, data in
// hexadecimal). The head line names the columns; a spreadsheet may have put them in another order, and
// semicolons between them.

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/text_reader.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {
namespace {

using ascii::equal_ignoring_case;

enum class Column : std::uint8_t {
  time,
  channel,
  direction,
  identifier,
  extended,
  remote,
  error,
  dlc,
  data,
  other
};
constexpr std::size_t column_kinds = static_cast<std::size_t>(Column::other);

Column column_of(std::string_view name) {
  struct Name {
    std::string_view name;
    Column column;
  };
  constexpr std::array names{Name{"time", Column::time},         Name{"timestamp", Column::time},
                             Name{"channel", Column::channel},   Name{"direction", Column::direction},
                             Name{"id", Column::identifier},     Name{"arbitration_id", Column::identifier},
                             Name{"extended", Column::extended}, Name{"remote", Column::remote},
                             Name{"error", Column::error},       Name{"dlc", Column::dlc},
                             Name{"data", Column::data}};
  const auto* found =
      std::ranges::find_if(names, [&](const Name& n) { return equal_ignoring_case(n.name, name); });
  return found == names.end() ? Column::other : found->column;
}

/// Takes the first field off the row; quotation marks around it are gone, doubled ones inside single.
std::string take_field(std::string_view& row, char separator) {
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

/// The bytes, or nothing if the text is no base64.
std::optional<std::string> from_base64(std::string_view text) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t value = digits.find(c);
    if (value == std::string_view::npos) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xFFU);
  }
  return bytes;
}

/// The bytes in hexadecimal, blanks between them or not.
std::optional<std::string> from_hex(std::string_view text) {
  std::string bytes, single;
  for (Words words(text); !words.peek().empty();) {
    std::string_view word = words.next();
    if (word.size() == 1) {  // a spreadsheet drops the zero before it
      single = '0' + std::string(word);
      word = single;
    }
    for (; !word.empty(); word.remove_prefix(2)) {
      const auto byte = ascii::byte_of_hex(word.substr(0, 2));
      if (!byte) return std::nullopt;
      bytes += static_cast<char>(*byte);
    }
  }
  return bytes;
}

class CsvReader final : public TextReader {
 public:
  explicit CsvReader(TraceInput input) : TextReader(std::move(input), FileFormat::csv) {}

 private:
  Found read_line(std::string_view line, TraceRecord& record) override {
    if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    if (line.find_first_not_of(" \t") == std::string_view::npos) return Found::nothing;
    if (columns_.empty()) return read_head(line);
    std::array<std::string, column_kinds> row;
    for (const Column column : columns_) {
      std::string field = take_field(line, separator_);
      if (column != Column::other) row[static_cast<std::size_t>(column)] = std::move(field);
      if (line.empty()) continue;
      if (line.front() != separator_) return mistake("expected a separator behind a field");
      line.remove_prefix(1);
    }
    if (!line.empty()) return mistake("expected " + std::to_string(columns_.size()) + " fields");
    return read_row(row, record);
  }

  Found read_head(std::string_view line) {
    separator_ = line.find(';') != std::string_view::npos ? ';' : ',';
    std::array<bool, column_kinds> there{};
    for (std::string_view rest = line; !rest.empty() && columns_.size() < 64;) {
      const std::string name = take_field(rest, separator_);
      base64_ = base64_ || name == "arbitration_id";
      columns_.push_back(column_of(name));
      if (columns_.back() != Column::other) there[static_cast<std::size_t>(columns_.back())] = true;
      if (!rest.empty()) rest.remove_prefix(1);
    }
    for (const Column needed : {Column::time, Column::identifier, Column::data}) {
      if (there[static_cast<std::size_t>(needed)]) continue;
      columns_.clear();
      return mistake("expected a head line with time, id and data, found " + shown(line));
    }
    return Found::nothing;
  }

  Found read_row(const std::array<std::string, column_kinds>& row, TraceRecord& record) {
    const auto field = [&](Column column) -> const std::string& {
      return row[static_cast<std::size_t>(column)];
    };
    const auto flag = [&](Column column, bool& value) {
      const std::string& text = field(column);
      value = text == "1" || equal_ignoring_case(text, "true");
      return value || text.empty() || text == "0" || equal_ignoring_case(text, "false");
    };
    const auto time = parse_time(field(Column::time), nanoseconds_per_second);
    if (!time) return mistake("expected a time in seconds, found " + shown(field(Column::time)));
    record.time = can::Time(*time);
    can::Frame& frame = record.frame;
    bool error = false;
    if (!flag(Column::extended, frame.extended) || !flag(Column::remote, frame.remote) ||
        !flag(Column::error, error)) {
      return mistake("expected 0 or 1 for extended, remote and error");
    }
    std::string_view digits = field(Column::identifier);
    if (digits.starts_with("0x") || digits.starts_with("0X")) digits.remove_prefix(2);
    const auto identifier = ascii::parse_number<std::uint32_t>(digits, 16);
    if (!identifier ||
        *identifier > (frame.extended || error ? can::max_extended_identifier : can::max_base_identifier)) {
      return mistake("expected a hexadecimal identifier, found " + shown(field(Column::identifier)));
    }
    frame.identifier = *identifier;
    record.transmitted = equal_ignoring_case(field(Column::direction), "Tx");
    const auto bytes = base64_ ? from_base64(field(Column::data)) : from_hex(field(Column::data));
    if (!bytes) return mistake("expected data in " + std::string(base64_ ? "base64" : "hexadecimal bytes"));
    const std::string& length = field(Column::dlc);
    const auto dlc = length.empty() ? static_cast<std::uint32_t>(bytes->size())
                                    : ascii::parse_number<std::uint32_t>(length);
    // python-can gives a CAN FD frame up to 64 bytes, and has no DLC beyond 8 of a classical one
    if (bytes->size() > 8 || (base64_ && dlc && *dlc > 8)) return Found::left_out;
    if (!dlc || *dlc > 15) return mistake("expected a DLC of 0 to 15, found " + shown(length));
    frame.dlc = static_cast<std::uint8_t>(*dlc);
    if (bytes->size() != frame.length() && !frame.remote) {
      return mistake("expected " + std::to_string(frame.length()) + " bytes of data, found " +
                     std::to_string(bytes->size()));
    }
    for (std::size_t i = 0; i < frame.data.size() && i < frame.length(); ++i) {
      frame.data[i] = static_cast<std::uint8_t>((*bytes)[i]);
    }
    if (error) set_error_frame(record, frame.identifier);
    const std::string& channel = field(Column::channel);
    return set_channel(channel.empty() ? "can0" : channel, record) ? Found::record : Found::mistake;
  }

  std::vector<Column> columns_{};
  char separator_ = ',';
  bool base64_ = false;
};

}  // namespace

OpenedReader open_csv(TraceInput input) { return std::make_unique<CsvReader>(std::move(input)); }

}  // namespace canopus::trace
