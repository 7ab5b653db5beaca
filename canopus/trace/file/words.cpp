#include "canopus/trace/file/words.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::trace {

std::string_view Words::next() noexcept {
  word_ = std::min(line_.find_first_not_of(separators_, at_), line_.size());
  at_ = std::min(line_.find_first_of(separators_, word_), line_.size());
  return line_.substr(word_, at_ - word_);
}

std::string_view Words::rest() const noexcept {
  return line_.substr(std::min(line_.find_first_not_of(separators_, at_), line_.size()));
}

std::optional<can::Duration> parse_time(std::string_view word, std::int64_t unit) noexcept {
  const bool negative = word.starts_with('-');
  if (negative || word.starts_with('+')) word.remove_prefix(1);
  std::int64_t digits = 0;  // as one number
  int exponent = 0;         // of ten, that it is multiplied with
  constexpr std::int64_t most_digits = std::numeric_limits<std::int64_t>::max() / 10 - 1;
  bool any = false;
  bool behind_point = false;
  while (!word.empty() && (ascii::is_digit(word.front()) || (word.front() == '.' && !behind_point))) {
    const char c = word.front();
    word.remove_prefix(1);
    if (c == '.') {
      behind_point = true;
      continue;
    }
    any = true;
    if (digits <= most_digits) {
      digits = digits * 10 + (c - '0');
      if (behind_point) --exponent;
    } else if (!behind_point) {
      return std::nullopt;
    }
  }
  if (!any) return std::nullopt;
  if (word.starts_with('e') || word.starts_with('E')) {
    word.remove_prefix(word.size() > 1 && word[1] == '+' ? 2 : 1);
    const auto power = ascii::parse_number<int>(word);
    if (!power || *power < -1000 || *power > 1000) return std::nullopt;
    word = {};
    exponent += *power;
  }
  if (!word.empty()) return std::nullopt;
  for (; unit >= 10; unit /= 10) ++exponent;
  for (; exponent > 0 && digits != 0; --exponent) {
    if (digits > std::numeric_limits<std::int64_t>::max() / 10) return std::nullopt;
    digits *= 10;
  }
  for (; exponent < -1 && digits != 0; ++exponent) digits /= 10;
  if (exponent == -1) digits = (digits + 5) / 10;
  return can::Duration(negative ? -digits : digits);
}

std::optional<can::Duration> parse_clock(std::string_view word) noexcept {
  const std::size_t first = word.find(':');
  const std::size_t second = first == std::string_view::npos ? first : word.find(':', first + 1);
  if (second == std::string_view::npos) return std::nullopt;
  const auto hours = ascii::parse_number<std::uint16_t>(word.substr(0, first));
  const auto minutes = ascii::parse_number<std::uint8_t>(word.substr(first + 1, second - first - 1));
  const auto seconds = parse_time(word.substr(second + 1), nanoseconds_per_second);
  constexpr can::Duration minute = std::chrono::minutes(1);
  if (!hours || !minutes || *minutes > 59 || !seconds || *seconds < can::Duration{} || *seconds >= minute)
    return std::nullopt;
  return std::chrono::hours(*hours) + std::chrono::minutes(*minutes) + *seconds;
}

std::string shown(std::string_view word) {
  if (word.empty()) return "the end of the line";
  constexpr std::size_t most = 24;
  std::string text = "'";
  for (const char c : word.substr(0, most)) text += c >= ' ' && c < 0x7F ? c : '?';
  return text + (word.size() > most ? "...'" : "'");
}

std::optional<can::Time> utc_time(int year, unsigned month, unsigned day, can::Duration of_day) noexcept {
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                         std::chrono::day(day)};
  if (!date.ok() || year < 1970 || year > 2261) return std::nullopt;
  return can::Time(std::chrono::sys_days(date).time_since_epoch() + of_day);
}

std::string name_of_numbered_channel(std::uint32_t number) {
  return number == 0 ? "0" : "can" + std::to_string(number - 1);
}

}  // namespace canopus::trace
