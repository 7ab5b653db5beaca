#include "canopus/instruction_list/clock_functions.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>

#include "canopus/instruction_list/device_blocks.hpp"

namespace canopus::instruction_list::clock_functions {

namespace {

constexpr std::int64_t seconds_of_day = 24 * 60 * 60;

unsigned from_bcd(unsigned byte) { return 10 * (byte >> 4U & 0xFU) + (byte & 0xFU); }

/// Year, month, day, hour, minute, second, day of the week.
using ClockWords = std::array<std::uint16_t, 7>;

bool seconds_of(NativeCall& call, std::size_t slot, std::int64_t& seconds) {
  std::array<std::uint16_t, 3> time{};
  if (!read(call, place(call, slot), time) || out_of_range(call, time[0], 0, 23) ||
      out_of_range(call, time[1], 0, 59) || out_of_range(call, time[2], 0, 59))
    return false;
  seconds = 3600 * time[0] + 60 * time[1] + time[2];
  return true;
}

bool store_seconds(NativeCall& call, std::size_t slot, std::int64_t seconds) {
  const std::array<std::uint16_t, 3> time = {static_cast<std::uint16_t>(seconds / 3600),
                                             static_cast<std::uint16_t>(seconds / 60 % 60),
                                             static_cast<std::uint16_t>(seconds % 60)};
  return write(call, place(call, slot), time);
}

/// What the registers at the slot show.
bool clock_of(NativeCall& call, std::size_t slot, ClockForm form, ClockWords& words) {
  const std::size_t registers = form == ClockForm::bcd ? 4 : words.size();
  ClockWords found{};
  if (!read(call, place(call, slot), std::span(found).first(registers))) return false;
  const auto high = [&](std::size_t i) { return from_bcd(found[i] >> 8U); };
  const auto low = [&](std::size_t i) { return from_bcd(found[i] & 0xFFU); };
  switch (form) {
    case ClockForm::bcd: {
      const std::array each = {100 * high(3) + high(0), low(0), high(1), low(1), high(2), low(2), low(3)};
      for (std::size_t i = 0; i < each.size(); ++i) words[i] = static_cast<std::uint16_t>(each[i]);
      break;
    }
    case ClockForm::binary: words = found; break;
    case ClockForm::fx: words = {found[5], found[4], found[3], found[2], found[1], found[0], found[6]}; break;
  }
  return true;
}

/// A date of 1980 to 2079, or a time within a day.
bool is_clock_data(const std::array<std::uint16_t, 3>& words, bool is_date) {
  if (!is_date) return words[0] < 24 && words[1] < 60 && words[2] < 60;
  using namespace std::chrono;
  const year_month_day date{year(words[0]), month(words[1]), day(words[2])};
  return words[0] >= 1980 && words[0] <= 2079 && date.ok();
}

}  // namespace

bool read_clock(NativeCall& call) {
  ClockWords words{};
  return clock_of(call, 1, static_cast<ClockForm>(call.slots[3]), words) &&
         write(call, place(call, 4), words);
}

// The bits of the target choose what is compared, the last word by bit 0; bit 15 is for the clock in place of the second source. What is no
// date or time is OFF, whatever the comparison.
bool compare_clock(NativeCall& call) {
  const Slot target = call.slots[5] & 0xFFFFU;
  const bool is_date = call.slots[6] != 0;
  std::array<std::uint16_t, 3> a{};
  std::array<std::uint16_t, 3> b{};
  if (!read(call, place(call, 1), a)) return false;
  if ((target & 0x8000U) != 0) {
    ClockWords words{};
    if (!clock_of(call, 8, static_cast<ClockForm>(call.slots[10]), words)) return false;
    std::copy_n(words.begin() + (is_date ? 0 : 3), b.size(), b.begin());
  } else if (!read(call, place(call, 3), b)) {
    return false;
  }
  call.slots[0] = 0;
  const bool is_target = (target & 0x7FF8U) == 0 && (target & 7U) != 0;
  if (!is_target || !is_clock_data(a, is_date) || !is_clock_data(b, is_date)) return true;
  int order = 0;
  for (std::size_t i = 0; i < a.size() && order == 0; ++i)
    if ((target >> (2 - i) & 1U) != 0) order = a[i] < b[i] ? -1 : a[i] > b[i] ? 1 : 0;
  const std::array<bool, 6> holds = {order == 0, order != 0, order > 0, order <= 0, order < 0, order >= 0};
  call.slots[0] = holds.at(call.slots[7]) ? 1 : 0;
  return true;
}

bool set_clock(NativeCall& call) {
  ClockWords words{};
  if (!read(call, place(call, 1), words)) return false;
  const bool has_two_digits = call.slots[3] != 0;
  int year = words[0];
  if (has_two_digits) {
    if (out_of_range(call, year, 0, 99)) return false;
    year += year < 80 ? 2000 : 1900;
  }
  if (out_of_range(call, year, 1980, 2079) || out_of_range(call, words[1], 1, 12)) return false;
  using namespace std::chrono;
  const year_month_day_last last_day{std::chrono::year(year), month_day_last(month(words[1]))};
  if (out_of_range(call, words[2], 1, static_cast<unsigned>(last_day.day())) ||
      out_of_range(call, words[3], 0, 23) || out_of_range(call, words[4], 0, 59) ||
      out_of_range(call, words[5], 0, 59))
    return false;
  if (call.devices == nullptr) return true;
  call.devices->set_clock(local_days(last_day.year() / last_day.month() / day(words[2])) + hours(words[3]) +
                          minutes(words[4]) + seconds(words[5]));
  return true;
}

bool time_of_day(NativeCall& call) {
  std::int64_t seconds = 0;
  if (!seconds_of(call, 1, seconds)) return false;
  call.slots[0] = static_cast<Slot>(seconds);
  return true;
}

bool store_time(NativeCall& call) {
  const auto seconds = static_cast<std::int64_t>(call.slots[1]);
  constexpr std::int64_t most = 32'767 * 3600LL + 3599;  // hours in a word
  return !out_of_range(call, seconds, 0, most) && store_seconds(call, 2, seconds);
}

bool add_times(NativeCall& call) {
  std::int64_t a = 0;
  std::int64_t b = 0;
  if (!seconds_of(call, 1, a) || !seconds_of(call, 3, b)) return false;
  const std::int64_t sum = call.slots[7] != 0 ? a - b : a + b;
  return store_seconds(call, 5, (sum + seconds_of_day) % seconds_of_day);
}

bool refresh(NativeCall& call) {
  const program::DeviceAccess& access = call.program->devices[call.slots[1]];
  if (out_of_range(call, static_cast<std::int64_t>(call.slots[3]), 1, 32'767)) return false;
  program::DevicePoint point;
  return point_of(call, access, static_cast<std::int64_t>(call.slots[2]), point) &&
         !refused(call, call.devices->refresh(point, static_cast<std::uint32_t>(call.slots[3])), access);
}

}  // namespace canopus::instruction_list::clock_functions
