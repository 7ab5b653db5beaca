// The reader of Vector's ASC logs. What is no frame of classical CAN is left out: CAN FD, J1939TP, statistics, status,
// comments, environment variables.

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
    if (first.starts_with("//")) return Found::left_out;
    return mistake(words.column(), "expected a time in seconds, found " + shown(first));
  }

  Found read_event(Words& words, TraceRecord& record) {
    const auto channel = parse_number<std::uint32_t>(words.next());
    if (!channel || *channel > 255) return Found::left_out;  // CANFD, CAN 1 Status, Start of measurement ...
    std::string_view word = words.next();
    if (equal_ignoring_case(word.substr(0, 10), "ErrorFrame")) {
      record.frame.dlc = 8;
      set_error_frame(record, unspecified_error);
      return set_channel(name_of_numbered_channel(*channel), record) ? Found::record : Found::mistake;
    }
    const std::size_t identifier_column = words.column();
    const std::string_view direction = words.next();
    if (!equal_ignoring_case(direction, "Rx") && !equal_ignoring_case(direction, "Tx"))
      return Found::left_out;
    record.transmitted = equal_ignoring_case(direction, "Tx");
    can::Frame& frame = record.frame;
    frame.extended = word.ends_with('x') || word.ends_with('X');
    if (frame.extended) word.remove_suffix(1);
    const auto identifier = parse_number<std::uint32_t>(word, base_);
    if (!identifier ||
        *identifier > (frame.extended ? can::max_extended_identifier : can::max_base_identifier)) {
      return mistake(identifier_column, std::string("expected an identifier, ") +
                                            (base_ == 16 ? "hexadecimal" : "decimal") +
                                            ", with x if extended, found " + shown(word));
    }
    frame.identifier = *identifier;
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
      (void)words.next();
      return mistake(words.column(), "expected a DLC of 0 to 15");
    }
    for (std::size_t i = 0; i < frame.length(); ++i) {
      word = words.next();
      const auto byte = parse_number<std::uint32_t>(word, base_);
      if (!byte || *byte > 255)
        return mistake(words.column(), "expected a byte of data, found " + shown(word));
      frame.data[i] = static_cast<std::uint8_t>(*byte);
    }
    return set_channel(name_of_numbered_channel(*channel), record) ? Found::record : Found::mistake;
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
