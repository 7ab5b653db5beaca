#pragma once
// Read and write access of a servo to its objects.

#include <cstdint>

#include "canopus/sim/device/behaviour.hpp"
#include "canopus/sim/device/device.hpp"

namespace canopus::sim {

/// The effective value; `otherwise`: the drive has no such object.
template <typename T>
[[nodiscard]] T value(const Device& device, const canopen::Entry& entry, T otherwise = {}) {
  return entry ? device.node().dictionary().get<T>(entry) : otherwise;
}

/// A speed or an acceleration; 0 or absent: as much as there is.
[[nodiscard]] inline double positive(const Device& device, const canopen::Entry& entry) {
  constexpr double as_much_as_there_is = 1e12;
  const auto number = value<std::uint32_t>(device, entry);
  return number == 0 ? as_much_as_there_is : number;
}

/// False: the effective value is unchanged.
inline bool put(Device& device, const canopen::Entry& entry, double number) {
  if (!entry) return false;
  const canopen::Limits limits = device.node().dictionary().description().limits(entry);
  return device.put(entry, fitted(number, entry.description->type, limits));
}

}  // namespace canopus::sim
