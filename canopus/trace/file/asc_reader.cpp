// The reader of Vector's ASC logs. Lines CANFD and CANXL are what a channel writes that can do more than classical CAN:
// they hold classical frames, too. What is no classical frame is left out.

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/text_reader.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {
namespace {

using ascii::equal_ignoring_case;
using ascii::parse_number;

/// English and German, as Vector's programs write them.
std::optional<unsigned> month_of(std::string_view word) {
  struct Month {
    std::string_view name;
    unsigned number;
  };
  constexpr std::array months{Month{"jan", 1},        Month{"feb", 2},    Month{"mar", 3},  Month{"mrz", 3},
                              Month{"m\xC3\xA4r", 3}, Month{"m\xE4r", 3}, Month{"apr", 4},  Month{"may", 5},
                              Month{"mai", 5},        Month{"jun", 6},    Month{"jul", 7},  Month{"aug", 8},
                              Month{"sep", 9},        Month{"oct", 10},   Month{"okt", 10}, Month{"nov", 11},
                              Month{"dec", 12},       Month{"dez", 12}};
  const auto* found =
      std::ranges::find_if(months, [&](const Month& m) { return equal_ignoring_case(m.name, word); });
  if (found == months.end()) return std::nullopt;
  return found->number;
}

/// `Sam Sep 30 15:06:13.191 2017` or `Thu Jan 01 03:06:13.191 pm 1970`
std::optional<can::Time> parse_date(std::string_view text) {
  Words words(text);
  (void)words.next();  // the day of the week
  const auto month = month_of(words.next());
  const auto day = parse_number<std::uint32_t>(words.next());
  const std::string_view clock = words.next();
  std::string_view last = words.next();
  const bool am = equal_ignoring_case(last, "am");
  const bool pm = equal_ignoring_case(last, "pm");
  if (am || pm) last = words.next();
  const auto year = parse_number<std::uint32_t>(last);
  const std::size_t colon = clock.find(':');
  if (!month || !day || !year || *year > 2261 || clock.size() < colon + 4 || clock[colon + 3] != ':') {
    return std::nullopt;
  }
  const auto hour = parse_number<std::uint32_t>(clock.substr(0, colon));
  const auto minute = parse_number<std::uint32_t>(clock.substr(colon + 1, 2));
  const auto seconds = parse_time(clock.substr(colon + 4), nanoseconds_per_second);
  if (!hour || !minute || !seconds || *hour > 23 || *minute > 59) return std::nullopt;
  const unsigned of_day = am || pm ? *hour % 12 + (pm ? 12U : 0U) : *hour;
  return utc_time(static_cast<int>(*year), *month, *day,
                  std::chrono::hours(of_day) + std::chrono::minutes(*minute) + *seconds);
}

class AscReader final : public TextReader {
 public:
  explicit AscReader(TraceInput input) : TextReader(std::move(input), FileFormat::asc) {}

 private:
  Found read_line(std::string_view line, TraceRecord& record) override {
    Words words(line);
    const std::string_view first = words.next();
    if (first.empty()) return Found::nothing;
    if (first.front() < '0' || first.front() > '9') {
      if (first.front() != '-') return read_head(first, words);
    }
    const auto since = parse_time(first, nanoseconds_per_second);
    if (!since) return mistake(words.column(), "expected a time in seconds, found " + shown(first));
    // what is no frame moves a relative time, too
    last_ = relative_ ? can::later(last_, *since) : can::later(start_, *since);
    if (relative_ && *since < can::Duration{}) return mistake(words.column(), "expected no negative time");
    record.time = last_;
    return read_event(words, record);
  }

  Found read_head(std::string_view first, Words& words) {
    if (equal_ignoring_case(first, "date")) {
      if (const auto date = parse_date(words.rest())) last_ = start_ = *date;
      return Found::nothing;
    }
    if (equal_ignoring_case(first, "base")) {
      const std::string_view base = words.next();
      if (!equal_ignoring_case(base, "hex") && !equal_ignoring_case(base, "dec")) {
        return mistake(words.column(), "expected hex or dec, found " + shown(base));
      }
      base_ = equal_ignoring_case(base, "hex") ? 16 : 10;
      (void)words.next();
      relative_ = equal_ignoring_case(words.next(), "relative");
      return Found::nothing;
    }
    if (equal_ignoring_case(first, "begin")) {
      (void)words.next();
      // the times of further blocks count from the same start
      const auto date = parse_date(words.rest());
      if (date && !block_) last_ = start_ = *date;
      block_ = true;
      return Found::nothing;
    }
    if (equal_ignoring_case(first, "end") || equal_ignoring_case(first, "internal") ||
        equal_ignoring_case(first, "no"))
      return Found::nothing;
    if (first.starts_with("//")) return leave_out(LeftOutKind::comment);
    return mistake(words.column(), "expected a time in seconds, found " + shown(first));
  }

  Found read_event(Words& words, TraceRecord& record) {
    const std::string_view first = words.next();
    const auto channel = parse_number<std::uint32_t>(first);
    if (!channel || *channel > 255) return read_named_event(first, words, record);
    const std::string_view word = words.next();
    if (is_error_frame(word)) return read_error_frame(*channel, record);
    const std::size_t identifier_column = words.column();
    const std::string_view direction = words.next();
    if (!set_direction(direction, record)) {
      return leave_out(equal_ignoring_case(direction, "TxRq") ? LeftOutKind::send_request
                       : word == "Statistic:"                 ? LeftOutKind::statistics
                                                              : LeftOutKind::other);
    }
    can::Frame& frame = record.frame;
    if (!set_identifier(word, base_, frame)) {
      return mistake(identifier_column, std::string("expected an identifier, ") +
                                            (base_ == 16 ? "hexadecimal" : "decimal") +
                                            ", with x if extended, found " + shown(word));
    }
    const std::string_view kind = words.next();
    frame.remote = equal_ignoring_case(kind, "r");
    if (!frame.remote && !equal_ignoring_case(kind, "d")) {
      return mistake(words.column(), "expected d or r, found " + shown(kind));
    }
    const auto dlc = parse_number<std::uint32_t>(words.peek(), base_);
    if (dlc && *dlc <= 15) {
      (void)words.next();
      frame.dlc = static_cast<std::uint8_t>(*dlc);
    } else if (!frame.remote) {
      const std::string_view found = words.next();
      return mistake(words.column(), "expected a DLC of 0 to 15, found " + shown(found));
    }
    if (const Found found = read_data(words, frame, base_); found != Found::record) return found;
    return on_channel(name_of_numbered_channel(*channel), record);
  }

  /// What has the name of its kind in place of a channel.
  Found read_named_event(std::string_view name, Words& words, TraceRecord& record) {
    constexpr std::array other_buses{"LIN", "Lin", "Fr", "ETH", "MOST", "J1708", "AFDX", "A429"};
    if (name == "CANFD") return read_fd_channel(words, record);
    if (name == "CANXL") return read_xl_channel(words, record);
    if (name == "CAN") return leave_out(LeftOutKind::status);  // CAN 1 Status:chip status error active
    const bool is_other = std::ranges::find(other_buses, name) != other_buses.end();
    return leave_out(is_other ? LeftOutKind::other_bus : LeftOutKind::other);
  }

  /// `1 Rx 601 [name] 0 0 8 8 40 00 ... 130000 130 220000`: BRS, ESI, DLC and length of the data, the data, duration
  /// and length of the message, flags.
  Found read_fd_channel(Words& words, TraceRecord& record) {
    constexpr std::uint32_t is_fd_frame = 0x1000;
    std::uint32_t channel = 0;
    if (const auto found = read_channel(words, record, channel)) return *found;
    std::string_view word = words.next();
    if (is_error_frame(word)) return read_error_frame(channel, record);
    if (!set_identifier(word, 16, record.frame)) return mistake_of_identifier(words, word);
    word = words.next();
    if (word != "0" && word != "1") (void)words.next();  // after the name of the message
    (void)words.next();
    const auto [length, found] = read_long_frame(words, record);
    if (found != Found::record) return found;
    if (length > 8) return leave_out(LeftOutKind::can_fd);
    (void)words.next();
    (void)words.next();
    auto flags = parse_number<std::uint32_t>(words.next(), 16);
    // only a remote frame has a DLC and no data; some writers put a 0 in place of its data
    if (length == 0 && record.frame.dlc != 0 && flags && (*flags & remote_frame_flag) == 0)
      flags = parse_number<std::uint32_t>(words.next(), 16);
    if (!flags) return mistake(words.column(), "expected the flags of the frame, hexadecimal");
    if ((*flags & is_fd_frame) != 0) return leave_out(LeftOutKind::can_fd);
    return finish_long_frame(length, *flags, channel, record);
  }

  /// `2 Rx CBFF 243215 176 432 [name] f 8 e1 ... 174 00000000`: kind of frame, duration, number of bits, identifier, DLC
  /// and length of the data, the data, checksum, flags.
  Found read_xl_channel(Words& words, TraceRecord& record) {
    std::uint32_t channel = 0;
    if (const auto found = read_channel(words, record, channel)) return *found;
    const std::string_view kind = words.next();
    if (is_error_frame(kind)) return read_error_frame(channel, record);
    if (kind.starts_with('X')) return leave_out(LeftOutKind::can_xl);
    if (kind.starts_with('F')) return leave_out(LeftOutKind::can_fd);
    if (kind != "CBFF" && kind != "CEFF")
      return mistake(words.column(), "expected a kind of frame such as CBFF, found " + shown(kind));
    (void)words.next();
    (void)words.next();
    const std::string_view identifier = words.next();
    if (!set_identifier(identifier, 16, record.frame)) return mistake_of_identifier(words, identifier);
    if (!parse_number<std::uint32_t>(words.peek(), 16)) (void)words.next();  // the name of the message
    const auto [length, found] = read_long_frame(words, record);
    if (found != Found::record) return found;
    if (length > 8) return mistake("expected at most 8 bytes, found " + std::to_string(length));
    (void)words.next();
    const auto flags = parse_number<std::uint32_t>(words.next(), 16);
    if (!flags) return mistake(words.column(), "expected the flags of the frame, hexadecimal");
    return finish_long_frame(length, *flags, channel, record);
  }

  /// Channel and direction; what is to be returned when there is no frame.
  std::optional<Found> read_channel(Words& words, TraceRecord& record, std::uint32_t& channel) {
    const std::string_view number = words.next();
    const auto parsed = parse_number<std::uint32_t>(number);
    if (!parsed || *parsed > 255)
      return mistake(words.column(), "expected the number of a channel, found " + shown(number));
    channel = *parsed;
    const std::string_view direction = words.next();
    if (set_direction(direction, record)) return std::nullopt;
    if (equal_ignoring_case(direction, "TxRq")) return leave_out(LeftOutKind::send_request);
    return mistake(words.column(), "expected Rx or Tx, found " + shown(direction));
  }

  /// DLC, length of the data, and the data unless it is longer than that of a classical frame.
  std::pair<std::uint32_t, Found> read_long_frame(Words& words, TraceRecord& record) {
    const std::string_view digits = words.next();
    const auto dlc = parse_number<std::uint32_t>(digits, 16);
    if (!dlc || *dlc > 15)
      return {0, mistake(words.column(), "expected a DLC of 0 to F, found " + shown(digits))};
    const std::string_view count = words.next();
    const auto length = parse_number<std::uint32_t>(count);
    if (!length || *length > 2048)
      return {0, mistake(words.column(), "expected a number of bytes, found " + shown(count))};
    if (*length > 8) return {*length, Found::record};
    record.frame.dlc = static_cast<std::uint8_t>(*length);
    const Found found = read_data(words, record.frame, 16);
    record.frame.dlc = static_cast<std::uint8_t>(*dlc);  // of a remote frame, and the raw one beyond 8
    return {*length, found};
  }

  static constexpr std::uint32_t remote_frame_flag = 0x10;

  Found finish_long_frame(std::uint32_t length, std::uint32_t flags, std::uint32_t channel,
                          TraceRecord& record) {
    can::Frame& frame = record.frame;
    frame.remote = (flags & remote_frame_flag) != 0;
    if (frame.remote) frame.data = {};
    if (!frame.remote && frame.length() != length) {
      return mistake("expected " + std::to_string(frame.length()) + " bytes of data, found " +
                     std::to_string(length));
    }
    return on_channel(name_of_numbered_channel(channel), record);
  }
  static bool is_error_frame(std::string_view word) {
    return equal_ignoring_case(word.substr(0, 10), "ErrorFrame");
  }
  Found read_error_frame(std::uint32_t channel, TraceRecord& record) {
    record.frame.dlc = 8;
    set_error_frame(record, unspecified_error);
    return on_channel(name_of_numbered_channel(channel), record);
  }
  static bool set_direction(std::string_view word, TraceRecord& record) {
    record.transmitted = equal_ignoring_case(word, "Tx");
    return record.transmitted || equal_ignoring_case(word, "Rx");
  }
  static bool set_identifier(std::string_view word, int base, can::Frame& frame) {
    frame.extended = word.ends_with('x') || word.ends_with('X');
    if (frame.extended) word.remove_suffix(1);
    const auto identifier = parse_number<std::uint32_t>(word, base);
    frame.identifier = identifier.value_or(0);
    return identifier &&
           *identifier <= (frame.extended ? can::max_extended_identifier : can::max_base_identifier);
  }
  Found mistake_of_identifier(const Words& words, std::string_view word) {
    return mistake(words.column(),
                   "expected an identifier, hexadecimal, with x if extended, found " + shown(word));
  }

  int base_ = 16;
  bool relative_ = false;
  bool block_ = false;  // a trigger block has begun
  can::Time start_{};
  can::Time last_{};
};

}  // namespace

OpenedReader open_asc(TraceInput input) { return std::make_unique<AscReader>(std::move(input)); }

}  // namespace canopus::trace
