#include "canopus/plc/rack/special_devices.hpp"

#include <algorithm>

#include "canopus/plc/cpu/device_points.hpp"

namespace canopus::plc {

namespace {

using module::CpuState;
using std::chrono::milliseconds;

std::uint16_t with_bit(std::uint16_t word, unsigned bit, bool on) {
  const auto mask = static_cast<std::uint16_t>(1U << bit);
  return static_cast<std::uint16_t>(on ? word | mask : word & ~mask);
}

std::uint16_t bcd(unsigned two_digits) {
  return static_cast<std::uint16_t>((two_digits / 10 % 10) << 4U | two_digits % 10);
}

std::uint16_t bcd_pair(unsigned high, unsigned low) {
  return static_cast<std::uint16_t>(bcd(high) << 8U | bcd(low));
}

/// SD203: in STOP and PAUSE with its cause.
std::uint16_t cpu_state(const CpuCondition& condition) {
  constexpr unsigned in_stop = 2;
  constexpr unsigned in_pause = 3;
  if (condition.is_paused) {
    return static_cast<std::uint16_t>(in_pause | static_cast<unsigned>(StopCause::remote) << 4U);
  }
  if (condition.state == CpuState::run) return 0;
  return static_cast<std::uint16_t>(in_stop | static_cast<unsigned>(condition.stop_cause) << 4U);
}

/// SD420 and the scan times: current, initial, smallest and largest, in milliseconds, and the microseconds
/// besides them. They are 0 until the first scan has ended, and stay in STOP.
std::optional<std::uint16_t> scan_register(const CpuModel& model, const Scan& scan, std::uint32_t number,
                                           can::Time now) {
  if (number == 420) return static_cast<std::uint16_t>(scan.count(now));
  const std::uint32_t first = model.iqr ? 518 : 520;
  if (number < first || number >= first + 8) return std::nullopt;
  if (scan.count(now) == 0) return std::uint16_t{0};
  const auto whole = scan.period() / milliseconds(1);
  const auto rest = scan.period() % milliseconds(1) / std::chrono::microseconds(1);
  return static_cast<std::uint16_t>(number % 2 == 0 ? whole : rest);
}

std::optional<std::uint16_t> clock_register(const CpuModel& model, const CpuCondition& condition,
                                            std::uint32_t number, can::Time now) {
  if (number < 210 || number > 216) return std::nullopt;
  const auto at = condition.clock + std::chrono::floor<std::chrono::seconds>(now - condition.clock_set);
  const auto midnight = std::chrono::floor<std::chrono::days>(at);
  const std::chrono::year_month_day date{midnight};
  const std::chrono::hh_mm_ss time{at - midnight};
  const auto year = static_cast<unsigned>(static_cast<int>(date.year()));
  const auto month = static_cast<unsigned>(date.month());
  const auto day = static_cast<unsigned>(date.day());
  const auto hour = static_cast<unsigned>(time.hours().count());
  const auto minute = static_cast<unsigned>(time.minutes().count());
  const auto second = static_cast<unsigned>(time.seconds().count());
  const unsigned weekday = std::chrono::weekday{midnight}.c_encoding();  // 0 is Sunday, as the CPU counts
  if (model.bcd_clock) {
    switch (number) {
      case 210: return bcd_pair(year % 100, month);
      case 211: return bcd_pair(day, hour);
      case 212: return bcd_pair(minute, second);
      case 213: return bcd_pair(year / 100, weekday);
      default: return std::nullopt;
    }
  }
  switch (number) {
    case 210: return static_cast<std::uint16_t>(year);
    case 211: return static_cast<std::uint16_t>(month);
    case 212: return static_cast<std::uint16_t>(day);
    case 213: return static_cast<std::uint16_t>(hour);
    case 214: return static_cast<std::uint16_t>(minute);
    case 215: return static_cast<std::uint16_t>(second);
    default: return static_cast<std::uint16_t>(weekday);
  }
}

}  // namespace

std::uint16_t special_relays(const CpuCondition& condition, std::uint32_t block, std::uint16_t memory,
                             can::Time now) noexcept {
  std::uint16_t word = memory;
  const bool run = condition.state == CpuState::run;
  const bool first = condition.scan.is_first(now);
  const auto half_period_odd = [now](milliseconds half) { return now.time_since_epoch() / half % 2 != 0; };
  if (block == 203 / 16) {
    word = with_bit(word, 203 % 16, !run);                 // SM203 CPU in STOP
    word = with_bit(word, 204 % 16, condition.is_paused);  // SM204 CPU in PAUSE
  } else if (block == 400 / 16) {
    word = with_bit(word, 0, true);                                  // SM400 always ON
    word = with_bit(word, 1, false);                                 // SM401 always OFF
    word = with_bit(word, 2, first);                                 // SM402 ON for the first scan after RUN
    word = with_bit(word, 3, run && !first);                         // SM403 OFF for the first scan after RUN
    word = with_bit(word, 10, half_period_odd(milliseconds(50)));    // SM410 0.1 s clock
    word = with_bit(word, 11, half_period_odd(milliseconds(100)));   // SM411 0.2 s clock
    word = with_bit(word, 12, half_period_odd(milliseconds(500)));   // SM412 1 s clock
    word = with_bit(word, 13, half_period_odd(milliseconds(1000)));  // SM413 2 s clock
  }
  return word;
}

std::optional<std::uint16_t> special_register(const CpuModel& model, const CpuCondition& condition,
                                              std::uint32_t number, can::Time now) noexcept {
  if (number == 203) return cpu_state(condition);
  if (const auto points = device_points_register(model, number)) return points;
  if (const auto scan = scan_register(model, condition.scan, number, now)) return scan;
  return clock_register(model, condition, number, now);
}

}  // namespace canopus::plc
