// The reader of PEAK's TRC files, versions 1.0 to 2.1 [PEAK CAN TRC File Format]. Status, warnings, error counters,
// events and CAN FD are left out.

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
  };

  Found read_line(std::string_view line, TraceRecord& record) override {
    Words words(line);
    if (words.peek().empty()) return Found::nothing;
    if (words.peek().front() == ';') return read_head(words.rest());
    if (columns_.empty()) return mistake("expected ;$COLUMNS before the first record of this version");
    Row row{.data = words};
    for (const char column : columns_) {
      if (column == 'D') break;
      const std::string_view word = words.next();
      if (word.empty()) return mistake("expected the columns " + columns_ + ", found the end of the line");
      switch (column) {
        case 'N': row.number = word; break;
        case 'O': row.offset = word; break;
        case 'T': row.type = word; break;
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

  Found read_head(std::string_view line) {
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

  Found read_row(Row& row, TraceRecord& record) {
    const auto offset = parse_time(row.offset, millisecond);
    if (!offset) return mistake("expected a time in ms, found " + shown(row.offset));
    record.time = can::later(start_, *offset);
    const std::string_view type = row.type;
    // 1.x name the direction as type; 1.0 has neither, and marks errors by an identifier that no frame has
    const bool in_type = equal_ignoring_case(type, "Rx") || equal_ignoring_case(type, "Tx");
    const bool error = type == "ER" || equal_ignoring_case(type, "Error");
    const bool is_frame =
        in_type || type == "DT" || type == "RR" || (type.empty() && row.identifier != "FFFFFFFF");
    if (!is_frame && !error) return Found::left_out;
    record.transmitted = equal_ignoring_case(in_type ? type : row.direction, "Tx");
    can::Frame& frame = record.frame;
    const auto identifier = parse_number<std::uint32_t>(row.identifier, 16);
    frame.extended = row.identifier.size() > 4;
    if (!identifier ||
        *identifier > (frame.extended ? can::max_extended_identifier : can::max_base_identifier)) {
      return mistake("expected an identifier of 4 or 8 hexadecimal digits, found " + shown(row.identifier));
    }
    frame.identifier = *identifier;
    if (error) {
      // 1 bit, 2 form, 4 stuff error, as in data[2] of a SocketCAN error frame
      constexpr std::uint32_t protocol_error = 0x08;
      frame = {.dlc = 8};
      set_error_frame(record, unspecified_error | (*identifier <= 8 ? protocol_error : 0));
      frame.data[2] = static_cast<std::uint8_t>(*identifier <= 8 ? *identifier & 7U : 0U);
    } else if (const Found found = read_data(row, frame); found != Found::record) {
      return found;
    }
    const auto bus = row.bus.empty() ? 1 : parse_number<std::uint32_t>(row.bus);
    if (!bus || *bus > 255) return mistake("expected the number of a bus, found " + shown(row.bus));
    return set_channel(name_of_numbered_channel(*bus), record) ? Found::record : Found::mistake;
  }

  Found read_data(Row& row, can::Frame& frame) {
    const auto length = parse_number<std::uint32_t>(row.length);
    if (!length || *length > 15) return mistake("expected a DLC of 0 to 15, found " + shown(row.length));
    frame.dlc = static_cast<std::uint8_t>(*length);
    frame.remote = row.type == "RR" || equal_ignoring_case(row.data.peek(), "RTR");
    for (std::size_t i = 0; i < frame.length(); ++i) {
      const std::string_view word = row.data.next();
      const auto byte = parse_number<std::uint32_t>(word, 16);
      if (!byte || *byte > 255)
        return mistake(row.data.column(), "expected a byte of data, found " + shown(word));
      frame.data[i] = static_cast<std::uint8_t>(*byte);
    }
    return Found::record;
  }

  std::string columns_{columns_of("1.0")};
  can::Time start_{};
};

}  // namespace

OpenedReader open_trc(TraceInput input) { return std::make_unique<TrcReader>(std::move(input)); }

}  // namespace canopus::trace
