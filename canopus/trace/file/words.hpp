#pragma once
// A line of a text format as words, and words as numbers.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/can/time.hpp"

namespace canopus::trace {

/// The words of a line, separated by blanks and tabulators or other characters, any number of them.
class Words {
 public:
  explicit Words(std::string_view line, std::string_view separators = " \t")
      : line_(line), separators_(separators) {}
  /// The next word; empty at the end of the line.
  std::string_view next() noexcept;
  /// The next word, which stays the next one.
  [[nodiscard]] std::string_view peek() const noexcept { return Words(*this).next(); }
  /// The rest of the line behind the words read so far, without the blanks before it.
  [[nodiscard]] std::string_view rest() const noexcept;
  /// The column of the last word of next(), from 1.
  [[nodiscard]] std::size_t column() const noexcept { return word_ + 1; }

 private:
  std::string_view line_;
  std::string_view separators_;
  std::size_t at_ = 0;
  std::size_t word_ = 0;
};

/// The escape character with which a colour begins.
inline constexpr char escape = 27;

inline constexpr std::int64_t nanoseconds_per_second = 1'000'000'000;

/// A decimal number with or without sign, point and exponent (`12.000345`, `1e-05`), in units of `unit` ns which is
/// a power of ten; rounded to the nanosecond. Nothing if it is none or no can::Duration.
[[nodiscard]] std::optional<can::Duration> parse_time(std::string_view word, std::int64_t unit) noexcept;
/// A time of day, or a time since the begin: `15:06:13.191`, in hours, minutes, seconds; nothing if it is none.
[[nodiscard]] std::optional<can::Duration> parse_clock(std::string_view word) noexcept;
/// How an error shows a word: in quotation marks, cut, without control characters; or "the end of the line".
[[nodiscard]] std::string shown(std::string_view word);
/// A date and a time of day as UTC; nothing if there is no such moment. `day` counts from 1, years 1970 to 2261.
[[nodiscard]] std::optional<can::Time> utc_time(int year, unsigned month, unsigned day,
                                                can::Duration of_day) noexcept;
/// The name that channel number 1, 2 ... of a format without names gets: can0, can1 ...
[[nodiscard]] std::string name_of_numbered_channel(std::uint32_t number);

}  // namespace canopus::trace
