#pragma once
// Literals of durations, dates and times of day [IEC 61131-3 6.3.3], without their prefix.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace canopus::program {

/// "1h2m3.5s", "-500ms", "1_000us" in ns: units d h m s ms us ns, falling, a fraction in the last one alone.
[[nodiscard]] std::optional<std::int64_t> parse_duration(std::string_view text);
/// "1990-06-12" in ns since 1970-01-01.
[[nodiscard]] std::optional<std::int64_t> parse_date(std::string_view text);
/// "12:30:15.5" in ns since midnight.
[[nodiscard]] std::optional<std::int64_t> parse_time_of_day(std::string_view text);
/// "1990-06-12-12:30:15.5" in ns since 1970-01-01.
[[nodiscard]] std::optional<std::int64_t> parse_date_and_time(std::string_view text);

/// "1d2h3m4s5ms", "0s".
[[nodiscard]] std::string duration_text(std::int64_t ns);
[[nodiscard]] std::string date_text(std::int64_t ns);
[[nodiscard]] std::string time_of_day_text(std::int64_t ns);

}  // namespace canopus::program
