// The reader of BUSMASTER's logs: `11:49:12:9420 Rx 1 0x601 s 8 40 00 10 00 00 00 00 00`.

#include <memory>

#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/text_reader.hpp"

namespace canopus::trace {
namespace {

using ascii::equal_ignoring_case;
using ascii::parse_number;

/// `11:49:12:9420`: hours, minutes, seconds, and 0.1 ms in four digits, or ms in fewer.
std::optional<can::Duration> parse_busmaster_time(std::string_view word) {
  const std::size_t colon = word.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const auto seconds = parse_clock(word.substr(0, colon));
  const std::string_view digits = word.substr(colon + 1);
  const auto fraction = parse_number<std::uint32_t>(digits);
  if (!seconds || !fraction || *fraction > (digits.size() < 4 ? 999U : 9999U)) return std::nullopt;
  return *seconds + std::chrono::microseconds(std::int64_t{*fraction} * (digits.size() < 4 ? 1000 : 100));
}

/// `8:8:2014 11:49:7:965`
std::optional<can::Time> parse_start(std::string_view text) {
  Words words(text, " :");
  const auto number = [&words] { return parse_number<std::uint16_t>(words.next()).value_or(0xFFFF); };
  const unsigned day = number();
  const unsigned month = number();
  const unsigned year = number();
  const unsigned hour = number();
  const unsigned minute = number();
  const unsigned second = number();
  const unsigned millisecond = number();
  if (hour > 23 || minute > 59 || second > 59 || millisecond > 999) return std::nullopt;
  return utc_time(static_cast<int>(year), month, day,
                  std::chrono::hours(hour) + std::chrono::minutes(minute) + std::chrono::seconds(second) +
                      std::chrono::milliseconds(millisecond));
}

class BusmasterReader final : public TextReader {
 public:
  explicit BusmasterReader(TraceInput input) : TextReader(std::move(input), FileFormat::busmaster) {}

 private:
  enum class TimeMode : std::uint8_t {
    system,    ///< time of day
    absolute,  ///< since the start of the log
    relative,  ///< since the frame before
  };

  Found read_line(std::string_view line, TraceRecord& record) override {
    const std::size_t stars = line.find("***");
    if (stars != std::string_view::npos) return read_head(line.substr(stars + 3));
    Words words(line);
    const std::string_view clock = words.next();
    if (clock.empty()) return Found::nothing;
    const auto time = parse_busmaster_time(clock);
    if (!time) return mistake(words.column(), "expected a time such as 11:49:12:9420, found " + shown(clock));
    record.time = time_of(*time);
    if (is_other_protocol_) return leave_out(LeftOutKind::other_bus);
    const std::string_view direction = words.next();
    record.transmitted = equal_ignoring_case(direction, "Tx");
    if (!record.transmitted && !equal_ignoring_case(direction, "Rx"))
      return mistake(words.column(), "expected Rx or Tx, found " + shown(direction));
    const std::string_view channel = words.next();
    const auto number = parse_number<std::uint32_t>(channel);
    if (!number || *number > 255)
      return mistake(words.column(), "expected the number of a channel, found " + shown(channel));
    if (const Found found = read_frame(words, record.frame); found != Found::record) return found;
    return on_channel(name_of_numbered_channel(*number), record);
  }

  Found read_frame(Words& words, can::Frame& frame) {
    const std::string_view identifier = words.next();
    const std::size_t identifier_column = words.column();
    const std::string_view type = words.next();
    frame.extended = type.starts_with('x');
    frame.remote = type == "sr" || type == "xr";
    if (type.find("fd") != std::string_view::npos) return leave_out(LeftOutKind::can_fd);
    if (!frame.remote && type != "s" && type != "x")
      return mistake(words.column(), "expected the type s, x, sr or xr, found " + shown(type));
    const auto value = parse_digits(identifier, base_);
    if (!value || *value > (frame.extended ? can::max_extended_identifier : can::max_base_identifier)) {
      return mistake(identifier_column, std::string("expected an identifier, ") +
                                            (base_ == 16 ? "hexadecimal" : "decimal") + ", found " +
                                            shown(identifier));
    }
    frame.identifier = *value;
    const std::string_view digits = words.next();
    const auto dlc = parse_number<std::uint32_t>(digits);
    if (!dlc || *dlc > 64) return mistake(words.column(), "expected a DLC of 0 to 8, found " + shown(digits));
    if (*dlc > 8) return leave_out(LeftOutKind::too_long);
    frame.dlc = static_cast<std::uint8_t>(*dlc);
    return read_data(words, frame, base_);
  }

  Found read_head(std::string_view line) {
    line = line.substr(0, line.find("***"));
    constexpr std::string_view start = "START DATE AND TIME ";
    constexpr std::string_view protocol = "PROTOCOL ";
    if (line.starts_with(start)) {
      if (const auto date = parse_start(line.substr(start.size()))) start_ = last_ = *date;
    } else if (line.starts_with(protocol)) {
      is_other_protocol_ = line.substr(protocol.size()) != "CAN";
    } else if (line == "HEX" || line == "DEC") {
      base_ = line == "HEX" ? 16 : 10;
    } else if (line == "SYSTEM MODE") {
      mode_ = TimeMode::system;
    } else if (line == "ABSOLUTE MODE") {
      mode_ = TimeMode::absolute;
    } else if (line == "RELATIVE MODE") {
      mode_ = TimeMode::relative;
    }
    return Found::nothing;
  }

  can::Time time_of(can::Duration time) {
    switch (mode_) {
      case TimeMode::relative: return last_ = can::later(last_, time);
      case TimeMode::absolute: return last_ = can::later(start_, time);
      case TimeMode::system: break;
    }
    // no date stands in a line: what is half a day before the line before it is of the next day
    constexpr can::Duration half_a_day = std::chrono::hours(12);
    can::Time midnight{std::chrono::floor<std::chrono::days>(last_.time_since_epoch())};
    if (last_ - midnight - time > half_a_day) midnight = can::later(midnight, std::chrono::days(1));
    return last_ = can::later(midnight, time);
  }

  int base_ = 16;
  TimeMode mode_ = TimeMode::system;
  bool is_other_protocol_ = false;
  can::Time start_{};
  can::Time last_{};
};

}  // namespace

OpenedReader open_busmaster(TraceInput input) { return std::make_unique<BusmasterReader>(std::move(input)); }

}  // namespace canopus::trace
