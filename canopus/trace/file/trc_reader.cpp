// The reader of PEAK's TRC files, versions 1.0 to 2.1 [PEAK CAN TRC File Format].

#include <algorithm>
#include <array>
#include <memory>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/text_reader.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {
namespace {

using ascii::equal_ignoring_case;
using ascii::parse_number;

constexpr std::int64_t millisecond = 1'000'000;

/// The columns by the letters of $COLUMNS: N number, O time offset in ms, T type, B bus, I identifier, d direction,
/// R reserved, l length, L DLC, D data.
std::string_view columns_of(std::string_view version) {
  if (version == "1.0") return "NOILD";
  if (version == "1.1") return "NOTILD";
  if (version == "1.2") return "NOBTILD";
  if (version == "1.3") return "NOBTIRLD";
  if (version == "2.0") return "NOTIdlD";
  if (version == "2.1") return "NOTBIdRLD";
  return {};
}

/// Days since 1899-12-30 with decimals, to the microsecond.
std::optional<can::Time> parse_days(std::string_view word) {
  constexpr std::int64_t days_before_1970 = 25569;
  const std::size_t point = std::min(word.find('.'), word.size());
  const auto days = parse_number<std::uint32_t>(word.substr(0, point));
  if (!days || *days < days_before_1970 || *days > 132'000) return std::nullopt;
  __extension__ using Wide = unsigned __int128;
  constexpr std::uint64_t microseconds_per_day = 86'400'000'000U;
  std::uint64_t fraction = 0;
  std::uint64_t scale = 1;
  for (const char c : word.substr(std::min(word.size(), point + 1))) {
    if (c < '0' || c > '9') return std::nullopt;
    if (scale >= 1'000'000'000'000'000'000U) break;
    fraction = fraction * 10 + static_cast<std::uint64_t>(c - '0');
    scale *= 10;
  }
  const auto of_day = static_cast<std::int64_t>((Wide{fraction} * microseconds_per_day + scale / 2) / scale);
  return can::Time(std::chrono::days(std::int64_t{*days} - days_before_1970) +
                   std::chrono::microseconds(of_day));
}

class TrcReader final : public TextReader {
 public:
  explicit TrcReader(TraceInput input) : TextReader(std::move(input), FileFormat::trc) {}

 private:
  /// The fields of one line, by column.
  struct Row {
    std::string_view number{}, offset{}, type{}, bus{}, identifier{}, direction{}, length{};
    Words data{""};

    [[nodiscard]] bool is_error() const {
      // 1.0 has no types: an error has a word before its data
      return type == "ER" || equal_ignoring_case(type, "Error") ||
             (type.empty() && equal_ignoring_case(data.peek(), "ERROR"));
    }
  };

  Found read_line(std::string_view line, TraceRecord& record) override {
    Words words(line);
    if (words.peek().empty()) return Found::nothing;
    if (words.peek().front() == ';') return read_head(words.rest());
    if (columns_.empty()) return mistake("expected ;$COLUMNS before the first record of this version");
    Row row{.data = words};
    for (const char column : columns_) {
      if (column == 'D') break;
      if (row.type == "ER" && is_blank_column(column, words.peek())) continue;
      const std::string_view word = words.next();
      if (word.empty()) return mistake("expected the columns " + columns_ + ", found the end of the line");
      switch (column) {
        case 'N': row.number = word; break;
        case 'O': row.offset = word; break;
        case 'T':
          row.type = word;
          if (is_no_frame(word)) return leave_out(kind_of(word));
          break;
        case 'B': row.bus = word; break;
        case 'I': row.identifier = word; break;
        case 'd': row.direction = word; break;
        case 'l':
        case 'L': row.length = word; break;
        default: break;
      }
    }
    row.data = words;
    return read_row(row, record);
  }

  /// These rows of 2.0 and 2.1 have other columns.
  static bool is_no_frame(std::string_view type) { return type == "ST" || type == "EC" || type == "EV"; }

  /// An error row of 2.0 has blanks for identifier and length; 2.1 has `-` for the identifier.
  static bool is_blank_column(char column, std::string_view next) {
    const bool is_direction = equal_ignoring_case(next, "Rx") || equal_ignoring_case(next, "Tx");
    return (column == 'I' && is_direction) || ((column == 'l' || column == 'L') && next.size() != 1);
  }

  Found read_head(std::string_view line) {
    if (!has_start_) read_start(line);
    const auto value_of = [line](std::string_view key) -> std::string_view {
      if (!line.starts_with(key)) return {};
      std::string_view value = line.substr(key.size());
      while (!value.empty() && ascii::is_blank(value.back())) value.remove_suffix(1);
      return value;
    };
    if (const auto version = value_of(";$FILEVERSION="); !version.empty()) {
      columns_ = columns_of(version);
    } else if (const auto days = value_of(";$STARTTIME="); !days.empty()) {
      const auto start = parse_days(days);
      if (!start) return mistake("expected days since 30.12.1899, found " + shown(days));
      start_ = *start;
      has_start_ = true;
    } else if (const auto columns = value_of(";$COLUMNS="); !columns.empty()) {
      columns_.clear();
      for (const char c : columns.substr(0, 64)) {
        if (c != ',' && c != ' ') columns_ += c;
      }
      for (const char needed : {'O', 'I'}) {
        if (columns_.find(needed) == std::string::npos || columns_.back() != 'D') {
          columns_.clear();
          return mistake("expected columns with O and I and with D at the end, found " + shown(columns));
        }
      }
    }
    return Found::nothing;
  }

  /// `;   Start time: 11.09.2002 16:00:20.682`, where 1.0 has its start; others have it for people.
  void read_start(std::string_view line) {
    constexpr std::string_view key = "Start time: ";
    const std::size_t at = line.find(key);
    if (at == std::string_view::npos) return;
    Words words(line.substr(at + key.size()));
    Words date(words.next(), ".");
    const auto number = [&date] { return parse_number<std::uint16_t>(date.next()).value_or(0); };
    const unsigned day = number();
    const unsigned month = number();
    const unsigned year = number();
    constexpr std::size_t clock = std::string_view("16:00:20.682").size();
    const auto of_day = parse_clock(words.next().substr(0, clock));
    if (!of_day || *of_day >= std::chrono::days(1)) return;
    start_ = utc_time(static_cast<int>(year), month, day, *of_day).value_or(can::Time{});
  }

  Found read_row(Row& row, TraceRecord& record) {
    const auto offset = parse_time(row.offset, millisecond);
    if (!offset) return mistake("expected a time in ms, found " + shown(row.offset));
    record.time = can::later(start_, *offset);
    const std::string_view type = row.type;
    // 1.x name the direction as type; 1.0 has neither, and marks warnings by an identifier that no frame has
    const bool in_type = equal_ignoring_case(type, "Rx") || equal_ignoring_case(type, "Tx");
    record.transmitted = equal_ignoring_case(in_type ? type : row.direction, "Tx");
    if (row.is_error()) return read_error(row, record);
    const bool is_frame =
        in_type || type == "DT" || type == "RR" || (type.empty() && row.identifier != "FFFFFFFF");
    if (!is_frame) return leave_out(kind_of(type));
    can::Frame& frame = record.frame;
    const auto identifier = parse_number<std::uint32_t>(row.identifier, 16);
    frame.extended = row.identifier.size() > 4;
    if (!identifier ||
        *identifier > (frame.extended ? can::max_extended_identifier : can::max_base_identifier)) {
      return mistake("expected an identifier of 4 or 8 hexadecimal digits, found " + shown(row.identifier));
    }
    frame.identifier = *identifier;
    const auto length = parse_number<std::uint32_t>(row.length);
    if (!length || *length > 15) return mistake("expected a DLC of 0 to 15, found " + shown(row.length));
    frame.dlc = static_cast<std::uint8_t>(*length);
    frame.remote = type == "RR" || equal_ignoring_case(row.data.peek(), "RTR");
    if (const Found found = read_data(row.data, frame, 16); found != Found::record) return found;
    return on_bus(row, record);
  }

  static LeftOutKind kind_of(std::string_view type) {
    if (type == "FD" || type == "FB" || type == "FE" || type == "BI") return LeftOutKind::can_fd;
    if (type == "ST" || type == "EC" || type.empty() || equal_ignoring_case(type, "Warng"))
      return LeftOutKind::status;
    return LeftOutKind::other;
  }

  Found on_bus(const Row& row, TraceRecord& record) {
    const auto bus = row.bus.empty() ? 1 : parse_number<std::uint32_t>(row.bus);
    if (!bus || *bus > 255) return mistake("expected the number of a bus, found " + shown(row.bus));
    return on_channel(name_of_numbered_channel(*bus), record);
  }

  /// Kind of the error (in 1.x in place of the identifier), direction, place, REC and TEC, as the SJA1000 names them;
  /// SocketCAN's driver of that controller makes the same of them.
  Found read_error(Row& row, TraceRecord& record) {
    constexpr std::uint32_t protocol_error = 0x08, no_acknowledgement = 0x20, with_counters = 0x200;
    constexpr std::uint32_t other_error = 8;
    constexpr std::uint8_t transmitting = 0x80, acknowledge_slot = 0x19;
    std::uint32_t kind = other_error;
    if (row.type == "ER") {
      if (const auto digits = parse_number<std::uint32_t>(row.data.next(), 16)) kind = *digits;
    } else {
      const auto identifier = parse_number<std::uint32_t>(row.identifier, 16);
      if (!identifier)
        return mistake("expected a kind of error of 4 hexadecimal digits, found " + shown(row.identifier));
      kind = *identifier;
      if (row.type.empty()) (void)row.data.next();  // ERROR
    }
    std::array<std::uint8_t, 4> details{1};  // received, no place, counters of 0
    for (std::uint8_t& detail : details) {
      const std::string_view word = row.data.next();
      if (word.empty()) break;
      const auto byte = parse_number<std::uint32_t>(word, 16);
      if (!byte || *byte > 255)
        return mistake(row.data.column(), "expected a byte of an error, found " + shown(word));
      detail = static_cast<std::uint8_t>(*byte);
    }
    const auto [received, place, rec, tec] = details;
    can::Frame& frame = record.frame;
    frame = {.dlc = 8};
    const bool is_unacknowledged = kind == other_error && received == 0 && place == acknowledge_slot;
    set_error_frame(record, unspecified_error | with_counters | (kind <= other_error ? protocol_error : 0) |
                                (is_unacknowledged ? no_acknowledgement : 0));
    frame.data[2] = static_cast<std::uint8_t>((kind <= other_error ? kind & 7U : 0U) |
                                              (received == 0 ? transmitting : 0U));
    frame.data[3] = place;
    frame.data[6] = tec;
    frame.data[7] = rec;
    return on_bus(row, record);
  }

  std::string columns_{columns_of("1.0")};
  can::Time start_{};
  bool has_start_ = false;  // of ;$STARTTIME
};

}  // namespace

OpenedReader open_trc(TraceInput input) { return std::make_unique<TrcReader>(std::move(input)); }

}  // namespace canopus::trace
