#pragma once
// What the instructions of clock data do: the CPU's clock as its special registers show it, times of the day, sums of them. Slots are as
// in device_functions.hpp.

#include <cstdint>

#include "canopus/program/program.hpp"

namespace canopus::instruction_list::clock_functions {

using program::NativeCall;
using program::Slot;

// clang-format off
bool read_clock(NativeCall& call);     ///< -; first register, offset, ClockForm, destination, offset
bool set_clock(NativeCall& call);      ///< -; source, offset, has two digits of the year
bool time_of_day(NativeCall& call);    ///< seconds; source (hour, minute, second), offset
bool store_time(NativeCall& call);     ///< -; seconds, destination, offset
bool add_times(NativeCall& call);      ///< -; source, offset, source, offset, destination, offset, subtracts
bool compare_clock(NativeCall& call);  ///< 1 or 0; source, offset, source, offset, target, is of dates, comparison, first register, offset, ClockForm
bool refresh(NativeCall& call);        ///< -; device, offset, points
// clang-format on

/// How a family's registers hold its clock.
enum class ClockForm : std::uint8_t {
  bcd,     ///< SD210 to SD213 of a Q: two BCD numbers of two digits each
  binary,  ///< SD210 to SD216: year, month, day, hour, minute, second, day of the week
  fx       ///< D8013 to D8019: second, minute, hour, day, month, year, day of the week
};

}  // namespace canopus::instruction_list::clock_functions
