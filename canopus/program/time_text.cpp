#include "canopus/program/time_text.hpp"

#include <array>
#include <chrono>
#include <limits>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::program {

namespace {

constexpr std::int64_t ns_per_second = 1'000'000'000;
constexpr std::int64_t ns_per_day = 86'400 * ns_per_second;

struct Unit {
  std::string_view name;
  std::int64_t ns;
};
constexpr std::array<Unit, 7> units = {{{"d", ns_per_day},
                                        {"h", 3600 * ns_per_second},
                                        {"m", 60 * ns_per_second},
                                        {"s", ns_per_second},
                                        {"ms", 1'000'000},
                                        {"us", 1000},
                                        {"ns", 1}}};

std::string without_underscores(std::string_view text) {
  std::string digits;
  for (const char c : text)
    if (c != '_') digits += c;
  return digits;
}

std::optional<std::int64_t> sum(std::int64_t a, std::int64_t b) {
  std::int64_t result = 0;
  return __builtin_add_overflow(a, b, &result) ? std::nullopt : std::optional(result);
}

/// "12.5" units of `ns`.
std::optional<std::int64_t> scaled(std::string_view text, std::int64_t ns) {
  const std::size_t point = text.find('.');
  const auto whole = ascii::parse_number<std::uint64_t>(text.substr(0, point));
  if (!whole || *whole > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max() / ns))
    return std::nullopt;
  std::int64_t value = static_cast<std::int64_t>(*whole) * ns;
  if (point == std::string_view::npos) return value;
  const std::string_view fraction = text.substr(point + 1);
  if (fraction.empty()) return std::nullopt;
  std::int64_t step = ns;
  std::int64_t remainder = 0;
  for (const char c : fraction) {
    if (!ascii::is_digit(c)) return std::nullopt;
    // A unit is no power of ten: an hour's third digit is 3.6 s.
    const std::int64_t exact = step + remainder;
    step = exact / 10;
    remainder = 0;
    value += (c - '0') * step;
  }
  return value;
}

void append(std::string& text, std::int64_t& rest, std::int64_t ns, std::string_view name) {
  if (rest < ns) return;
  text += std::to_string(rest / ns);
  text += name;
  rest %= ns;
}

std::string two_digits(std::int64_t value) {
  return {static_cast<char>('0' + value / 10), static_cast<char>('0' + value % 10)};
}

}  // namespace

std::optional<std::int64_t> parse_duration(std::string_view text) {
  const bool is_negative = text.starts_with('-');
  if (is_negative || text.starts_with('+')) text.remove_prefix(1);
  const std::string plain = ascii::lower(without_underscores(text));
  std::string_view rest = plain;
  std::int64_t value = 0;
  std::size_t next_unit = 0;
  bool is_last = false;
  if (rest.empty()) return std::nullopt;
  while (!rest.empty()) {
    std::size_t digits = 0;
    while (digits < rest.size() && (ascii::is_digit(rest[digits]) || rest[digits] == '.')) ++digits;
    std::size_t end = digits;
    while (end < rest.size() && ascii::is_letter(rest[end])) ++end;
    const std::string_view name = rest.substr(digits, end - digits);
    std::size_t unit = next_unit;
    while (unit < units.size() && units[unit].name != name) ++unit;
    if (unit == units.size() || is_last) return std::nullopt;
    is_last = rest.substr(0, digits).contains('.');
    const auto amount = scaled(rest.substr(0, digits), units[unit].ns);
    if (!amount) return std::nullopt;
    const auto total = sum(value, *amount);
    if (!total) return std::nullopt;
    value = *total;
    next_unit = unit + 1;
    rest.remove_prefix(end);
  }
  return is_negative ? -value : value;
}

std::optional<std::int64_t> parse_date(std::string_view text) {
  const std::string plain = without_underscores(text);
  const std::size_t first = plain.find('-');
  const std::size_t second_dash = first == std::string::npos ? first : plain.find('-', first + 1);
  if (second_dash == std::string::npos) return std::nullopt;
  const std::string_view view = plain;
  const auto year = ascii::parse_number<unsigned>(view.substr(0, first));
  const auto month = ascii::parse_number<unsigned>(view.substr(first + 1, second_dash - first - 1));
  const auto day_of_month = ascii::parse_number<unsigned>(view.substr(second_dash + 1));
  if (!year || !month || !day_of_month || *year < 1700 || *year > 2261) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(*year)),
                                         std::chrono::month(*month), std::chrono::day(*day_of_month)};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days{date}.time_since_epoch().count() * ns_per_day;
}

std::optional<std::int64_t> parse_time_of_day(std::string_view text) {
  const std::string plain = without_underscores(text);
  const std::string_view view = plain;
  const std::size_t first = view.find(':');
  const std::size_t next = first == std::string_view::npos ? first : view.find(':', first + 1);
  if (first == std::string_view::npos) return std::nullopt;
  const auto hour = ascii::parse_number<unsigned>(view.substr(0, first));
  const bool has_seconds = next != std::string_view::npos;
  const auto minute =
      ascii::parse_number<unsigned>(view.substr(first + 1, has_seconds ? next - first - 1 : next));
  const auto seconds =
      has_seconds ? scaled(view.substr(next + 1), ns_per_second) : std::optional<std::int64_t>(0);
  if (!hour || !minute || !seconds || *hour > 23 || *minute > 59 || *seconds >= 60 * ns_per_second)
    return std::nullopt;
  return (*hour * 3600LL + *minute * 60LL) * ns_per_second + *seconds;
}

std::optional<std::int64_t> parse_date_and_time(std::string_view text) {
  std::size_t dash = text.find('-');
  for (int i = 0; i < 2 && dash != std::string_view::npos; ++i) dash = text.find('-', dash + 1);
  if (dash == std::string_view::npos) return std::nullopt;
  const auto date = parse_date(text.substr(0, dash));
  const auto time = parse_time_of_day(text.substr(dash + 1));
  if (!date || !time) return std::nullopt;
  return sum(*date, *time);
}

std::string duration_text(std::int64_t ns) {
  if (ns == std::numeric_limits<std::int64_t>::min()) return "-106751d23h47m16s854ms775us808ns";
  std::string text = ns < 0 ? "-" : "";
  std::int64_t rest = ns < 0 ? -ns : ns;
  if (rest == 0) return "0s";
  for (const Unit& unit : units) append(text, rest, unit.ns, unit.name);
  return text;
}

std::string date_text(std::int64_t ns) {
  const auto days = std::chrono::floor<std::chrono::days>(std::chrono::nanoseconds(ns));
  const std::chrono::year_month_day date{std::chrono::sys_days{days}};
  return std::to_string(static_cast<int>(date.year())) + '-' +
         two_digits(static_cast<unsigned>(date.month())) + '-' +
         two_digits(static_cast<unsigned>(date.day()));
}

std::string time_of_day_text(std::int64_t ns) {
  const std::int64_t seconds = ns / ns_per_second;
  std::string text =
      two_digits(seconds / 3600 % 100) + ':' + two_digits(seconds / 60 % 60) + ':' + two_digits(seconds % 60);
  std::int64_t rest = ns % ns_per_second;
  if (rest == 0) return text;
  text += '.';
  for (std::int64_t digit = ns_per_second / 10; rest > 0; digit /= 10) {
    text += static_cast<char>('0' + rest / digit);
    rest %= digit;
  }
  return text;
}

}  // namespace canopus::program
