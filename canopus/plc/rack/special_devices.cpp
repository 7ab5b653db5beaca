#include "canopus/plc/rack/special_devices.hpp"

#include <array>
#include <span>

#include "canopus/module/interface/word_bytes.hpp"
#include "canopus/plc/cpu/device_points.hpp"

namespace canopus::plc {

namespace {

using module::CpuState;
using std::chrono::milliseconds;

enum class Meaning : std::uint8_t {
  on,
  off,
  run,               ///< ON in RUN
  stop,              ///< ON in STOP
  pause,             ///< ON in PAUSE
  error,             ///< ON after an error that has stopped the CPU
  operation_error,   ///< the same of an FX3: in an instruction
  watchdog_error,    ///< of a scan that took too long
  first_scan,        ///< ON for the first scan after RUN
  after_first_scan,  ///< ON in RUN but for the first scan
  clock,             ///< half of the time OFF, then ON
};
struct Relay {
  std::uint16_t number;
  Meaning meaning;
  milliseconds half_period{};  // of a clock
};

// SM of the MELSEC families; those from 8000 on are the FX3's M, which an FX5 has as SM besides.
constexpr std::array melsec_relays = {
    Relay{0, Meaning::error},
    Relay{1, Meaning::error},
    Relay{203, Meaning::stop},
    Relay{204, Meaning::pause},
    Relay{400, Meaning::on},
    Relay{401, Meaning::off},
    Relay{402, Meaning::first_scan},
    Relay{403, Meaning::after_first_scan},
    Relay{410, Meaning::clock, milliseconds(50)},
    Relay{411, Meaning::clock, milliseconds(100)},
    Relay{412, Meaning::clock, milliseconds(500)},
    Relay{413, Meaning::clock, milliseconds(1000)},
    Relay{8000, Meaning::run},
    Relay{8001, Meaning::stop},
    Relay{8002, Meaning::first_scan},
    Relay{8003, Meaning::after_first_scan},
    Relay{8004, Meaning::error},
    Relay{8061, Meaning::watchdog_error},
    Relay{8067, Meaning::operation_error},
    Relay{8011, Meaning::clock, milliseconds(5)},
    Relay{8012, Meaning::clock, milliseconds(50)},
    Relay{8013, Meaning::clock, milliseconds(500)},
    Relay{8014, Meaning::clock, milliseconds(30000)},
};
constexpr std::size_t fx_relays = 11;  // of them, the last ones
constexpr std::array as300_relays = {
    Relay{400, Meaning::run},
    Relay{401, Meaning::stop},
    Relay{402, Meaning::first_scan},
    Relay{403, Meaning::after_first_scan},
};

std::span<const Relay> relays_of(CpuFamily family) {
  const std::span<const Relay> melsec(melsec_relays);
  switch (family) {
    case CpuFamily::q:
    case CpuFamily::iqr: return melsec.first(melsec.size() - fx_relays);
    case CpuFamily::fx3: return melsec.last(fx_relays);
    case CpuFamily::fx5: return melsec;
    case CpuFamily::as300: break;
  }
  return as300_relays;
}

bool is_on(const Relay& relay, const CpuCondition& condition, can::Time now) {
  const bool run = condition.state == CpuState::run;
  switch (relay.meaning) {
    case Meaning::on: return true;
    case Meaning::off: return false;
    case Meaning::run: return run;
    case Meaning::stop: return !run;
    case Meaning::pause: return condition.is_paused;
    case Meaning::error: return condition.error.has_value();
    case Meaning::watchdog_error: return condition.error && condition.error->is_watchdog;
    case Meaning::operation_error: return condition.error && !condition.error->is_watchdog;
    case Meaning::first_scan: return condition.scan.is_first(now);
    case Meaning::after_first_scan: return run && !condition.scan.is_first(now);
    case Meaning::clock: return now.time_since_epoch() / relay.half_period % 2 != 0;
  }
  return false;
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

/// Scan time of an FX, in 0.1 ms: present, minimum, maximum.
std::optional<std::uint16_t> fx_scan_register(const Scan& scan, std::uint32_t number, can::Time now) {
  if (number < 8010 || number > 8012) return std::nullopt;
  if (scan.count(now) == 0) return std::uint16_t{0};
  return static_cast<std::uint16_t>(scan.period() / std::chrono::microseconds(100));
}

/// SD420 and the scan times: current, initial, smallest and largest, in milliseconds, and the microseconds
/// besides them. They are 0 until the first scan has ended, and stay in STOP.
std::optional<std::uint16_t> scan_register(const CpuModel& model, const Scan& scan, std::uint32_t number,
                                           can::Time now) {
  if (number == 420) return static_cast<std::uint16_t>(scan.count(now));
  const std::uint32_t first = model.family == CpuFamily::q ? 520 : 518;
  if (number < first || number >= first + 8) return std::nullopt;
  if (scan.count(now) == 0) return std::uint16_t{0};
  const auto whole = scan.period() / milliseconds(1);
  const auto rest = scan.period() % milliseconds(1) / std::chrono::microseconds(1);
  return static_cast<std::uint16_t>(number % 2 == 0 ? whole : rest);
}

/// Date, time and weekday of a clock.
struct ClockFace {
  unsigned year, month, day, hour, minute, second, weekday;
};

ClockFace clock_of(const CpuCondition& condition, can::Time now) {
  const auto at = condition.clock + std::chrono::floor<std::chrono::seconds>(now - condition.clock_set);
  const auto midnight = std::chrono::floor<std::chrono::days>(at);
  const std::chrono::year_month_day date{midnight};
  const std::chrono::hh_mm_ss time{at - midnight};
  return {static_cast<unsigned>(static_cast<int>(date.year())),
          static_cast<unsigned>(date.month()),
          static_cast<unsigned>(date.day()),
          static_cast<unsigned>(time.hours().count()),
          static_cast<unsigned>(time.minutes().count()),
          static_cast<unsigned>(time.seconds().count()),
          std::chrono::weekday{midnight}.c_encoding()};  // 0 is Sunday, as the CPU counts
}

/// D8013 to D8019 of an FX3, with two digits of the year, and SD8013 to SD8019 of an FX5, with four.
std::optional<std::uint16_t> fx_clock_register(const CpuModel& model, const CpuCondition& condition,
                                               std::uint32_t number, can::Time now) {
  if (number < 8013 || number > 8019) return std::nullopt;
  const ClockFace face = clock_of(condition, now);
  const unsigned year = model.family == CpuFamily::fx3 ? face.year % 100 : face.year;
  const std::array words = {face.second, face.minute, face.hour, face.day, face.month, year, face.weekday};
  return static_cast<std::uint16_t>(words[number - 8013]);
}

std::optional<std::uint16_t> clock_register(const CpuModel& model, const CpuCondition& condition,
                                            std::uint32_t number, can::Time now) {
  if (number < 210 || number > 216) return std::nullopt;
  const auto [year, month, day, hour, minute, second, weekday] = clock_of(condition, now);
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

/// SD0 and the clock of the error behind it: as BCD pairs in three words (Q), or as SD210 to SD216 in seven (iQ-R, FX5).
std::optional<std::uint16_t> error_register(const CpuModel& model, const CpuCondition& condition,
                                            std::uint32_t number) {
  if (number > (model.bcd_clock ? 3U : 7U)) return std::nullopt;
  if (!condition.error || condition.error->code == 0) return std::uint16_t{0};
  if (number == 0) return condition.error->code;
  return clock_register(model, condition, 209 + number, condition.error->time);
}

/// D8061 and D8067 hold the code of the error, D8004 the number of the relay that shows it.
std::optional<std::uint16_t> fx_error_register(const CpuCondition& condition, std::uint32_t number) {
  if (number != 8004 && number != 8061 && number != 8067) return std::nullopt;
  if (!condition.error || condition.error->code == 0) return std::uint16_t{0};
  const std::uint16_t relay = condition.error->is_watchdog ? 8061 : 8067;
  if (number == 8004) return relay;
  return number == relay ? condition.error->code : std::uint16_t{0};
}

}  // namespace

std::uint16_t special_relays(const CpuModel& model, const CpuCondition& condition, std::uint32_t block,
                             std::uint16_t memory, can::Time now) noexcept {
  std::uint16_t word = memory;
  for (const Relay& relay : relays_of(model.family)) {
    if (relay.number / 16U == block)
      word = module::with_bit(word, relay.number % 16, is_on(relay, condition, now));
  }
  return word;
}

std::optional<std::uint16_t> special_register(const CpuModel& model, const CpuCondition& condition,
                                              std::uint32_t number, can::Time now) noexcept {
  if (model.family == CpuFamily::as300) return std::nullopt;
  if (model.family == CpuFamily::fx3 || model.family == CpuFamily::fx5) {
    if (const auto scan = fx_scan_register(condition.scan, number, now)) return scan;
    if (const auto clock = fx_clock_register(model, condition, number, now)) return clock;
    if (const auto error = fx_error_register(condition, number)) return error;
    if (model.family == CpuFamily::fx3) return std::nullopt;
  }
  if (number == 203) return cpu_state(condition);
  if (const auto error = error_register(model, condition, number)) return error;
  if (const auto points = device_points_register(model, number)) return points;
  if (const auto scan = scan_register(model, condition.scan, number, now)) return scan;
  return clock_register(model, condition, number, now);
}

}  // namespace canopus::plc
