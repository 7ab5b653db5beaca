#include "canopus/trace/file/candump_log.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <utility>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {
namespace {

constexpr std::uint32_t error_frame_flag = 0x2000'0000;  // CAN_ERR_FLAG of linux/can.h
constexpr char time_expected[] = "'(' and a time in seconds";

using ascii::hex_value;
using ascii::is_blank;
using ascii::is_digit;
using ascii::is_letter;
using ascii::write_hex;

/// `number` in decimal with at least `width` digits.
char* put_decimal(char* out, std::uint64_t number, int width) noexcept {
  char digits[20];
  const auto end = std::to_chars(digits, digits + sizeof digits, number).ptr;
  for (auto missing = width - (end - digits); missing > 0; --missing) *out++ = '0';
  return std::copy(digits, end, out);
}

/// One pass over a line. Every read either succeeds or says what was expected at the place where it stands.
class Line {
 public:
  Line(std::string_view text, std::size_t number) : text_(text), number_(number) {}

  std::expected<CandumpEntry, CandumpError> read() {
    CandumpEntry entry;
    skip_blanks();
    const std::size_t start = at_;
    const bool timed = !is_letter(peek());
    if ((timed && !read_time(entry.time)) || !read_channel(entry.channel, timed))
      return std::unexpected(error_);
    read_direction(entry);
    const auto word_end = std::ranges::find_if(text_.substr(at_), is_blank);
    const bool log_form = std::ranges::find(text_.begin() + position(), word_end, '#') != word_end;
    if (!timed && (log_form || !read_screen_frame(entry)) && !is_screen_form_) {
      (void)fail_at(start, time_expected);
      return std::unexpected(error_);
    }
    if (timed && !(log_form ? read_log_frame(entry) : read_screen_frame(entry)))
      return std::unexpected(error_);
    if (error_.left_out || error_.column != 0) return std::unexpected(error_);
    entry.log_form = log_form;
    return entry;
  }

 private:
  [[nodiscard]] std::string_view::difference_type position() const {
    return static_cast<std::string_view::difference_type>(at_);
  }
  [[nodiscard]] char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }
  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  void skip_blanks() {
    while (!at_end() && is_blank(peek())) ++at_;
  }
  bool skip(char c) {
    if (at_end() || peek() != c) return false;
    ++at_;
    return true;
  }
  bool fail(std::string expected) { return fail_at(at_, std::move(expected)); }
  bool fail_at(std::size_t at, std::string expected);

  bool read_time(can::Time& time);
  bool read_date(can::Time& time);
  bool read_number(std::size_t digits, unsigned low, unsigned high, unsigned& number);
  bool read_fraction(std::int64_t& nanoseconds);
  bool read_channel(std::string& channel, bool behind_time);
  void read_direction(CandumpEntry& entry);
  bool read_identifier(CandumpEntry& entry);
  bool read_byte(std::uint8_t& byte);
  bool read_log_frame(CandumpEntry& entry);
  bool read_log_remote(can::Frame& frame);
  bool read_log_data(can::Frame& frame);
  bool read_screen_frame(CandumpEntry& entry);
  bool read_screen_length(can::Frame& frame);
  bool read_screen_data(can::Frame& frame);
  bool read_screen_byte(std::uint8_t& byte);
  bool leave_out(LeftOutKind kind, std::string expected) {
    error_.left_out = kind;
    return fail(std::move(expected));
  }

  std::string_view text_;
  std::size_t number_;
  std::size_t at_ = 0;
  CandumpError error_{};
  bool is_screen_form_ = false;  // there is a length in brackets
};

bool Line::fail_at(std::size_t at, std::string expected) {
  std::string found = "the end of the line";
  if (at < text_.size()) {
    const auto byte = static_cast<unsigned char>(text_[at]);
    if (byte >= 0x20 && byte < 0x7F) {
      found = {'\'', text_[at], '\''};
    } else {
      found = "byte " + ascii::hex(byte, 2) + 'H';
    }
  }
  error_ = {.line = number_,
            .column = at + 1,
            .expected = std::move(expected),
            .found = std::move(found),
            .left_out = error_.left_out};
  return false;
}

bool Line::read_time(can::Time& time) {
  if (!skip('(')) return fail(time_expected);
  if (text_.substr(at_).find_first_of("-.)") == 4 && peek(4) == '-') return read_date(time);
  const std::size_t start = at_;
  std::int64_t whole = 0;
  for (; is_digit(peek()); ++at_) {
    whole = whole * 10 + (peek() - '0');
    if (whole >= can::never.time_since_epoch().count() / nanoseconds_per_second) {
      return fail_at(start, "a time below 9223372036 seconds");
    }
  }
  if (at_ == start) return fail("a time in seconds");
  std::int64_t fraction = 0;
  if (!read_fraction(fraction)) return false;
  time = can::Time(can::Duration(whole * nanoseconds_per_second + fraction));
  return true;
}

bool Line::read_fraction(std::int64_t& nanoseconds) {
  if (!skip('.')) return fail("'.' and a fraction of a second");
  int digits = 0;
  for (; is_digit(peek()); ++at_, ++digits) {
    if (digits == 9) return fail("')' after at most 9 decimals");
    nanoseconds = nanoseconds * 10 + (peek() - '0');
  }
  if (digits == 0) return fail("a decimal digit");
  for (; digits < 9; ++digits) nanoseconds *= 10;
  return skip(')') || fail("')'");
}

bool Line::read_number(std::size_t digits, unsigned low, unsigned high, unsigned& number) {
  const std::size_t start = at_;
  number = 0;
  for (std::size_t digit = 0; digit < digits; ++digit, ++at_) {
    if (!is_digit(peek())) return fail("a decimal digit of a date and time");
    number = number * 10 + static_cast<unsigned>(peek() - '0');
  }
  return (number >= low && number <= high) ||
         fail_at(start, "a number of " + std::to_string(low) + " to " + std::to_string(high));
}

/// `2024-02-29 12:00:00.000345)`
bool Line::read_date(can::Time& time) {
  unsigned year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
  std::int64_t fraction = 0;
  const std::size_t start = at_;
  if (!read_number(4, 1970, 2200, year) || !(skip('-') || fail("'-'")) || !read_number(2, 1, 12, month) ||
      !(skip('-') || fail("'-'")) || !read_number(2, 1, 31, day) || !(skip(' ') || fail("a blank")) ||
      !read_number(2, 0, 23, hour) || !(skip(':') || fail("':'")) || !read_number(2, 0, 59, minute) ||
      !(skip(':') || fail("':'")) || !read_number(2, 0, 60, second) || !read_fraction(fraction)) {
    return false;
  }
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(year)), std::chrono::month(month),
                                         std::chrono::day(day)};
  if (!date.ok()) return fail_at(start, "a date that exists");
  const auto days = std::chrono::sys_days(date).time_since_epoch();
  time = can::Time(days + std::chrono::hours(hour) + std::chrono::minutes(minute) +
                   std::chrono::seconds(second) + can::Duration(fraction));
  return true;
}

bool Line::read_channel(std::string& channel, bool behind_time) {
  if (behind_time && !is_blank(peek())) return fail("a blank");
  skip_blanks();
  const std::size_t start = at_;
  while (!at_end() && !is_blank(peek())) ++at_;
  if (at_ == start) return fail("the name of a channel");
  channel = text_.substr(start, at_ - start);
  skip_blanks();
  return true;
}

/// `TX - -` of candump -x on the screen; no identifier begins so.
void Line::read_direction(CandumpEntry& entry) {
  if ((peek() != 'T' && peek() != 'R') || peek(1) != 'X' || !is_blank(peek(2))) return;
  entry.transmitted = peek() == 'T';
  at_ += 2;
  skip_blanks();
  for (int flag = 0; flag < 2 && !at_end() && is_blank(peek(1)); ++flag) {
    ++at_;
    skip_blanks();
  }
}

bool Line::read_identifier(CandumpEntry& entry) {
  const std::size_t start = at_;
  std::uint32_t identifier = 0;
  while (const auto digit = hex_value(peek())) {
    if (at_ - start == 8) return fail("an identifier of 3 or 8 hexadecimal digits");
    identifier = identifier << 4 | *digit;
    ++at_;
  }
  const std::size_t digits = at_ - start;
  if (digits == 0) return fail("an identifier in hexadecimal digits");
  // 00123#81:00:00000001#1122: virtual CAN network and priority
  if (digits == 5 && peek() == '#')
    return leave_out(LeftOutKind::can_xl, "a classical frame (five digits are of a CAN XL frame)");
  if (digits != 3 && digits != 8) return fail_at(start, "an identifier of 3 or 8 hexadecimal digits");
  if (digits == 3 && identifier > can::max_base_identifier) return fail_at(start, "an identifier up to 7FF");
  if (digits == 8 && identifier > can::max_extended_identifier) {
    entry.error_frame = (identifier & ~can::max_extended_identifier) == error_frame_flag;
    if (!entry.error_frame) return fail_at(start, "an identifier up to 1FFFFFFF");
    identifier &= can::max_extended_identifier;
  }
  entry.frame.identifier = identifier;
  entry.frame.extended = digits == 8;
  return true;
}

bool Line::read_byte(std::uint8_t& byte) {
  unsigned value = 0;
  for (int digit = 0; digit < 2; ++digit, ++at_) {
    const auto next = hex_value(peek());
    if (!next) return fail("two hexadecimal digits for a byte");
    value = value << 4 | *next;
  }
  byte = static_cast<std::uint8_t>(value);
  return true;
}

bool Line::read_log_frame(CandumpEntry& entry) {
  if (!read_identifier(entry)) return false;
  if (!skip('#')) return fail("'#'");
  if (peek() == '#')
    return leave_out(LeftOutKind::can_fd, "the data of a classical frame ('##' begins a CAN FD frame)");
  const bool remote = peek() == 'R' || peek() == 'r';
  if (!(remote ? read_log_remote(entry.frame) : read_log_data(entry.frame))) return false;
  // `candump -l -x` appends the direction
  skip_blanks();
  entry.transmitted = peek() == 'T';
  if (peek() == 'R' || peek() == 'T') ++at_;
  skip_blanks();
  return at_end() || fail("the end of the line");
}

bool Line::read_log_remote(can::Frame& frame) {
  frame.remote = true;
  ++at_;
  if (at_end() || is_blank(peek())) return true;
  const auto dlc = hex_value(peek());
  if (!dlc || *dlc > 8) return fail("a length of 0 to 8");
  frame.dlc = static_cast<std::uint8_t>(*dlc);
  ++at_;
  if (frame.dlc == 8 && skip('_')) {
    const auto raw = hex_value(peek());
    if (!raw || *raw < 9) return fail("a raw DLC of 9 to F");
    frame.dlc = static_cast<std::uint8_t>(*raw);
    ++at_;
  }
  return at_end() || is_blank(peek()) || fail("the end of the frame");
}

bool Line::read_log_data(can::Frame& frame) {
  while (!at_end() && !is_blank(peek()) && peek() != '_') {
    if (frame.dlc == 8) return fail("at most 8 bytes");
    if (!read_byte(frame.data[frame.dlc])) return false;
    ++frame.dlc;
    if (peek() == '.') ++at_;  // cansend's separator, which other tools leave in
  }
  if (!skip('_')) return true;
  const auto raw = hex_value(peek());
  if (frame.dlc != 8 || !raw || *raw < 9) return fail("a raw DLC of 9 to F after 8 bytes");
  frame.dlc = static_cast<std::uint8_t>(*raw);
  ++at_;
  return at_end() || is_blank(peek()) || fail("the end of the frame");
}

bool Line::read_screen_frame(CandumpEntry& entry) {
  if (!read_identifier(entry)) return false;
  skip_blanks();
  if (!read_screen_length(entry.frame)) return false;
  const std::size_t behind_length = at_;
  skip_blanks();
  constexpr std::string_view remote_request = "remote request";
  if (text_.substr(at_).starts_with(remote_request)) {
    entry.frame.remote = true;
    return true;
  }
  if (entry.frame.dlc == 0) at_ = behind_length;
  if (!read_screen_data(entry.frame)) return false;
  // The rest is the ASCII column, and notes behind it.
  return at_end() || is_blank(peek()) || fail("a blank or the end of the line");
}

/// `[8]`, and `{F}` of candump -8.
bool Line::read_screen_length(can::Frame& frame) {
  const bool is_raw = peek() == '{';
  if (!is_raw && peek() != '[') return fail("'#', or '[' and a length");
  is_screen_form_ = true;
  ++at_;
  const std::size_t digits = std::min(text_.find_first_not_of("0123456789", at_), text_.size()) - at_;
  if (!is_raw && digits == 2) {
    return leave_out(LeftOutKind::can_fd,
                     "one digit for the length of a classical frame (two are of a CAN FD frame)");
  }
  if (!is_raw && digits == 4) {
    return leave_out(LeftOutKind::can_xl,
                     "one digit for the length of a classical frame (four are of a CAN XL frame)");
  }
  const auto length = hex_value(peek());
  if (is_raw && !length) return fail("a DLC of 0 to F");
  if (!length || (!is_raw && *length > 8)) return fail("a length of 0 to 8");
  frame.dlc = static_cast<std::uint8_t>(*length);
  ++at_;
  return skip(is_raw ? '}' : ']') || fail(is_raw ? "'}'" : "']'");
}

bool Line::read_screen_data(can::Frame& frame) {
  constexpr char swapped_separator = '`';  // of candump -S
  bool is_swapped = false;
  for (std::size_t byte = 0; byte < frame.length(); ++byte) {
    if (byte > 0 && skip(swapped_separator)) {
      is_swapped = true;
    } else {
      if (byte > 0 && !is_blank(peek())) return fail("a blank and another byte");
      skip_blanks();
    }
    if (!read_screen_byte(frame.data[byte])) return false;
  }
  if (is_swapped)
    std::reverse(frame.data.begin(), frame.data.begin() + static_cast<std::ptrdiff_t>(frame.length()));
  return true;
}

bool Line::read_screen_byte(std::uint8_t& byte) {
  constexpr std::size_t bits = 8;
  const std::string_view digits = text_.substr(at_, bits);
  if (digits.size() < bits || digits.find_first_not_of("01") != std::string_view::npos)
    return read_byte(byte);
  for (const char bit : digits) byte = static_cast<std::uint8_t>(byte << 1 | (bit == '1' ? 1 : 0));
  at_ += bits;
  return true;
}

}  // namespace

std::size_t write_candump_line(std::span<char> out, std::string_view channel, const can::Frame& frame,
                               can::Time time) noexcept {
  return write_candump_line(out, channel, TraceRecord{.time = time, .frame = frame});
}

std::size_t write_candump_line(std::span<char> out, std::string_view channel,
                               const TraceRecord& record) noexcept {
  const can::Frame& frame = record.frame;
  const can::Time time = record.time;
  const auto microseconds = static_cast<std::uint64_t>(std::max<std::int64_t>(
      0, std::chrono::floor<std::chrono::microseconds>(time.time_since_epoch()).count()));
  char* p = out.data();
  *p++ = '(';
  p = put_decimal(p, microseconds / 1'000'000, 10);
  *p++ = '.';
  p = put_decimal(p, microseconds % 1'000'000, 6);
  *p++ = ')';
  *p++ = ' ';
  if (channel.empty()) channel = "_";
  for (const char c : channel.substr(0, candump_max_channel)) *p++ = c > ' ' && c < 0x7F ? c : '_';
  *p++ = ' ';
  p = write_hex(p, frame.identifier | (record.error_frame ? error_frame_flag : 0),
                frame.extended || record.error_frame ? 8 : 3);
  *p++ = '#';
  const unsigned length = std::min<unsigned>(frame.dlc, 8);
  if (frame.remote) {
    *p++ = 'R';
    if (length > 0) p = write_hex(p, length, 1);
  }
  for (const std::uint8_t byte : frame.bytes()) p = write_hex(p, byte, 2);
  if (frame.dlc > 8) {
    *p++ = '_';
    p = write_hex(p, frame.dlc, 1);
  }
  if (record.transmitted) {
    *p++ = ' ';
    *p++ = 'T';
  }
  *p++ = '\n';
  return static_cast<std::size_t>(p - out.data());
}

std::string CandumpError::message() const {
  return std::to_string(line) + ':' + std::to_string(column) + ": expected " + expected + ", found " + found;
}

std::expected<CandumpEntry, CandumpError> read_candump_line(std::string_view line, std::size_t number) {
  while (line.ends_with('\n') || line.ends_with('\r')) line.remove_suffix(1);
  return Line(line, number).read();
}

}  // namespace canopus::trace
