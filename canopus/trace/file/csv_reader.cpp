// The reader of traces as tables: python-can's (`arbitration_id`, data in base64), SavvyCAN's (GVRET: `Time Stamp`, a
// column for each byte), our own (`id`, data in hexadecimal), and others whose head line names an identifier and data.
// Columns may be in any order, with commas, semicolons or tabulators between them.

#include <algorithm>
#include <array>
#include <memory>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/text/base64.hpp"
#include "canopus/trace/file/csv_head.hpp"
#include "canopus/trace/file/text_reader.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {
namespace {

using ascii::equal_ignoring_case;

/// The bytes in hexadecimal, blanks between them or not, each perhaps with `0x`.
std::optional<std::string> from_hex(std::string_view text) {
  std::string bytes, single;
  for (Words words(text); !words.peek().empty();) {
    std::string_view word = words.next();
    if (ascii::has_hex_prefix(word)) word.remove_prefix(2);
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
  explicit CsvReader(TraceInput input) : TextReader(std::move(input), FileFormat::csv) {
    if (input_.buffered().empty()) (void)input_.peek_more();
    // what stands before the head is for people
    std::string_view begin = input_.buffered();
    for (std::size_t line = 0; !begin.empty(); ++line) {
      const std::size_t end = std::min(begin.find('\n'), begin.size() - 1);
      if (parse_csv_head(begin.substr(0, end))) {
        lines_before_head_ = line;
        break;
      }
      begin.remove_prefix(end + 1);
    }
  }

 private:
  using Row = std::array<std::string, csv_columns>;

  Found read_line(std::string_view line, TraceRecord& record) override {
    if (line.find_first_not_of(" \t") == std::string_view::npos) return Found::nothing;
    if (!head_) return read_head(line);
    Row row;
    for (const CsvColumn column : head_->columns) {
      std::string field = take_csv_field(line, head_->separator);
      std::string& place = row[static_cast<std::size_t>(column)];
      if (column == CsvColumn::data && !place.empty()) place += ' ';  // a column for each byte
      if (column != CsvColumn::other) place += field;
      if (line.empty()) continue;
      if (line.front() != head_->separator) return mistake("expected a separator behind a field");
      line.remove_prefix(1);
    }
    if (line.find_first_not_of(head_->separator) != std::string_view::npos)
      return mistake("expected " + std::to_string(head_->columns.size()) + " fields");
    return read_row(row, record);
  }

  Found read_head(std::string_view line) {
    if (input_.line_number() <= lines_before_head_) return leave_out(LeftOutKind::comment);
    head_ = parse_csv_head(line);
    if (!head_) return mistake("expected a head line with id and data, found " + shown(line));
    return Found::nothing;
  }

  Found read_row(const Row& row, TraceRecord& record) {
    const auto field = [&](CsvColumn column) -> const std::string& {
      return row[static_cast<std::size_t>(column)];
    };
    const auto flag = [&](CsvColumn column, bool& value) {
      const std::string_view text = ascii::trim(field(column));
      value = text == "1" || equal_ignoring_case(text, "true") || equal_ignoring_case(text, "t");
      return value || text.empty() || text == "0" || equal_ignoring_case(text, "false") ||
             equal_ignoring_case(text, "f");
    };
    if (const Found found = read_time(field(CsvColumn::time), record); found != Found::record) return found;
    can::Frame& frame = record.frame;
    bool error = false, is_fd = false;
    if (!flag(CsvColumn::extended, frame.extended) || !flag(CsvColumn::remote, frame.remote) ||
        !flag(CsvColumn::error, error) || !flag(CsvColumn::fd, is_fd)) {
      return mistake("expected 0 or 1 for extended, remote and error");
    }
    if (is_fd) return leave_out(LeftOutKind::can_fd);
    const auto identifier = parse_digits(ascii::trim(field(CsvColumn::identifier)), head_->identifier_base);
    // a table without that column has an extended identifier where no base one is as large
    if (!head_->has(CsvColumn::extended) && identifier.value_or(0) > can::max_base_identifier)
      frame.extended = true;
    if (!identifier ||
        *identifier > (frame.extended || error ? can::max_extended_identifier : can::max_base_identifier)) {
      return mistake(std::string("expected a ") + (head_->identifier_base == 16 ? "hexadecimal" : "decimal") +
                     " identifier, found " + shown(field(CsvColumn::identifier)));
    }
    frame.identifier = *identifier;
    const std::string_view direction = ascii::trim(field(CsvColumn::direction));
    record.transmitted = equal_ignoring_case(direction, "Tx") || equal_ignoring_case(direction, "T");
    if (const Found found = read_bytes(row, frame); found != Found::record) return found;
    if (error) set_error_frame(record, frame.identifier);
    const std::string& channel = field(CsvColumn::channel);
    if (channel.empty()) return on_channel("can0", record);
    return on_channel(head_->is_gvret ? "can" + channel : channel, record);
  }

  Found read_time(std::string text, TraceRecord& record) {
    if (!head_->has(CsvColumn::time)) return Found::record;
    if (head_->separator == ';') std::ranges::replace(text, ',', '.');  // a spreadsheet's decimal comma
    const std::string_view word = ascii::trim(text);
    const auto time =
        word.find(':') != std::string_view::npos ? parse_clock(word) : parse_time(word, head_->time_unit);
    if (!time)
      return mistake("expected a time in " + std::string(head_->time_unit_name()) + ", found " + shown(word));
    record.time = can::Time(*time);
    return Found::record;
  }

  Found read_bytes(const Row& row, can::Frame& frame) {
    const std::string& text = row[static_cast<std::size_t>(CsvColumn::data)];
    auto bytes = head_->is_base64 ? text::from_base64(text) : from_hex(text);
    if (!bytes)
      return mistake("expected data in " + std::string(head_->is_base64 ? "base64" : "hexadecimal bytes"));
    const std::string& length = row[static_cast<std::size_t>(CsvColumn::dlc)];
    const auto dlc = length.empty() ? static_cast<std::uint32_t>(bytes->size())
                                    : ascii::parse_number<std::uint32_t>(ascii::trim(length));
    // Columns for bytes that a shorter frame has not are empty or 0.
    if (head_->has_byte_columns && dlc && *dlc < bytes->size()) bytes->resize(*dlc);
    // python-can gives a CAN FD frame up to 64 bytes, and has no DLC beyond 8 of a classical one
    if (bytes->size() > 8 || ((head_->is_base64 || head_->has_byte_columns) && dlc && *dlc > 8))
      return leave_out(LeftOutKind::too_long);
    if (!dlc || *dlc > 15) return mistake("expected a DLC of 0 to 15, found " + shown(length));
    frame.dlc = static_cast<std::uint8_t>(*dlc);
    if (bytes->size() != frame.length() && !frame.remote) {
      return mistake("expected " + std::to_string(frame.length()) + " bytes of data, found " +
                     std::to_string(bytes->size()));
    }
    for (std::size_t i = 0; i < frame.data.size() && i < frame.length(); ++i) {
      frame.data[i] = static_cast<std::uint8_t>((*bytes)[i]);
    }
    return Found::record;
  }

  std::optional<CsvHead> head_{};
  std::size_t lines_before_head_ = 0;
};

}  // namespace

OpenedReader open_csv(TraceInput input) { return std::make_unique<CsvReader>(std::move(input)); }

}  // namespace canopus::trace
