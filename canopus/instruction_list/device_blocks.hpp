#pragma once
// Words and points of a program's devices, one after the other, as native functions reach them. Whatever fails leaves the fault in the
// call.

#include <cstddef>
#include <cstdint>
#include <span>

#include "canopus/program/program.hpp"

namespace canopus::instruction_list {

/// A device with what is added to its number.
struct DevicePlace {
  const program::DeviceAccess& access;
  std::int64_t offset;
};
/// The device whose number in Program::devices is in the slot; what is added to it is in the next one.
[[nodiscard]] DevicePlace place(const program::NativeCall& call, std::size_t slot);
/// The point `offset` further; false below 0 or without a CPU.
bool point_of(program::NativeCall& call, const program::DeviceAccess& access, std::int64_t offset,
              program::DevicePoint& point);
/// A bit device: its words are so many points each.
[[nodiscard]] bool has_points(const program::DeviceAccess& access);

/// Words of a block: of word devices one after the other, of K4M0 16 points each, of K1M0 4.
bool read(program::NativeCall& call, const DevicePlace& from, std::span<std::uint16_t> words);
bool write(program::NativeCall& call, const DevicePlace& to, std::span<const std::uint16_t> words);

/// True, with the fault, if there is an error; if the value is none of low to high.
bool refused(program::NativeCall& call, program::DeviceError error, const program::DeviceAccess& access);
bool out_of_range(program::NativeCall& call, std::int64_t value, std::int64_t low, std::int64_t high);

}  // namespace canopus::instruction_list
