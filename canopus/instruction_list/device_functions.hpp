#pragma once
// What instructions do that are more than a few instructions of the register machine: blocks of devices, modules, timers, counters,
// rotation, texts. Each works on a row of slots, in the order of its structure; "device" is a number in Program::devices, "offset" what
// an index register adds to it. All of them fail with the machine's fault.

#include <cstdint>

#include "canopus/program/program.hpp"

namespace canopus::instruction_list::device_functions {

using program::NativeCall;
using program::Slot;

// clang-format off
bool read_indexed(NativeCall& call);   ///< result; device, offset
bool write_indexed(NativeCall& call);  ///< -; device, offset, value
bool block_move(NativeCall& call);     ///< -; source, offset, destination, offset, n
bool fill(NativeCall& call);           ///< -; value, destination, offset, n, words of the value
bool shift_in(NativeCall& call);       ///< -; source (or `none`), offset, destination, offset, n1, n2, is left
bool from(NativeCall& call);           ///< -; module, address, destination, offset, n, words of one
bool to(NativeCall& call);             ///< -; module, address, source (or `none`), offset, n, words of one, constant
bool rotate(NativeCall& call);         ///< result; value, n, bits, Rotation, carry (in and out)
bool to_bcd(NativeCall& call);         ///< result; value, digits
bool from_bcd(NativeCall& call);       ///< result; value, digits
bool move_text(NativeCall& call);      ///< -; source (or `none`), offset, place of a constant, its length, destination, offset
bool compare_text(NativeCall& call);   ///< -1, 0, 1; source (or `none`), offset, place, length, and the same again
bool timer(NativeCall& call);          ///< contact; condition, setting, contact, coil, value, unit in ns, is retentive, state
bool counter(NativeCall& call);        ///< -; condition, setting, contact, coil, value
bool count_bits(NativeCall& call);     ///< result; value
bool mean(NativeCall& call);           ///< result; source, offset, n, words of one, the largest n, has no sign
bool limit(NativeCall& call);          ///< result; lower limit, upper limit, value
bool square_root(NativeCall& call);    ///< result; value
bool counter_32(NativeCall& call);     ///< -; condition, setting, contact, coil, low word, high word, counts down
// clang-format on

/// In place of a device's number.
inline constexpr Slot none = ~Slot{0};

enum class Rotation : std::uint8_t {
  right,
  right_with_carry,
  left,
  left_with_carry,
  shift_right,
  shift_left
};

}  // namespace canopus::instruction_list::device_functions
