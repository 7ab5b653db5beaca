#include "canopus/instruction_list/device_blocks.hpp"

#include <limits>

namespace canopus::instruction_list {

using program::DeviceAccess;
using program::DeviceError;
using program::DevicePoint;
using program::FaultCode;
using program::NativeCall;

bool refused(NativeCall& call, DeviceError error, const DeviceAccess& access) {
  if (error == DeviceError::none) return false;
  call.fault.code = error == DeviceError::no_module ? FaultCode::no_module : FaultCode::device_out_of_range;
  call.fault.device = access.text;
  return true;
}

bool out_of_range(NativeCall& call, std::int64_t value, std::int64_t low, std::int64_t high) {
  if (value >= low && value <= high) return false;
  call.fault.code = FaultCode::value_out_of_range;
  call.fault.value = value;
  call.fault.low = low;
  call.fault.high = high;
  return true;
}

DevicePlace place(const NativeCall& call, std::size_t slot) {
  return {call.program->devices[call.slots[slot]], static_cast<std::int64_t>(call.slots[slot + 1])};
}

bool has_points(const DeviceAccess& access) {
  return access.form == DeviceAccess::Form::points || access.form == DeviceAccess::Form::bit;
}

bool point_of(NativeCall& call, const DeviceAccess& access, std::int64_t offset, DevicePoint& point) {
  point = access.point;
  const std::int64_t number = std::int64_t{point.number} + offset;
  if (call.devices == nullptr) return !refused(call, DeviceError::no_module, access);
  if (number < 0 || number > std::numeric_limits<std::int32_t>::max())
    return !refused(call, DeviceError::out_of_range, access);
  point.number = static_cast<std::uint32_t>(number);
  return true;
}

bool read(NativeCall& call, const DevicePlace& from, std::span<std::uint16_t> words) {
  DevicePoint point;
  if (!point_of(call, from.access, from.offset, point)) return false;
  if (!has_points(from.access)) return !refused(call, call.devices->read_words(point, words), from.access);
  for (std::uint16_t& word : words) {
    std::uint32_t bits = 0;
    if (refused(call, call.devices->read_bits(point, from.access.count, bits), from.access)) return false;
    word = static_cast<std::uint16_t>(bits);
    point.number += from.access.count;
  }
  return true;
}

bool write(NativeCall& call, const DevicePlace& to, std::span<const std::uint16_t> words) {
  DevicePoint point;
  if (!point_of(call, to.access, to.offset, point)) return false;
  if (!has_points(to.access)) return !refused(call, call.devices->write_words(point, words), to.access);
  for (const std::uint16_t word : words) {
    if (refused(call, call.devices->write_bits(point, to.access.count, word), to.access)) return false;
    point.number += to.access.count;
  }
  return true;
}

}  // namespace canopus::instruction_list
