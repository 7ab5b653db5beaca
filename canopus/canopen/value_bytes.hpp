#pragma once
// Values of 0..8 bytes between memory and a register, little endian: the usual lengths are one load or store.

#include <cstdint>
#include <cstring>

namespace canopus::canopen {

template <typename T>
[[nodiscard]] inline T load_as(const std::uint8_t* from) noexcept {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// Zero-extended. `bytes`: 0..8.
[[nodiscard]] inline std::uint64_t load_value(const std::uint8_t* from, unsigned bytes) noexcept {
  switch (bytes) {
    case 8: return load_as<std::uint64_t>(from);
    case 4: return load_as<std::uint32_t>(from);
    case 2: return load_as<std::uint16_t>(from);
    case 1: return *from;
    default: break;
  }
  std::uint64_t value = 0;
  for (unsigned i = bytes; i-- > 0;) value = value << 8 | from[i];
  return value;
}

/// The low `bytes` (0..8) of the value.
inline void store_value(std::uint8_t* to, std::uint64_t value, unsigned bytes) noexcept {
  switch (bytes) {
    case 8: std::memcpy(to, &value, 8); return;
    case 4: std::memcpy(to, &value, 4); return;
    case 2: std::memcpy(to, &value, 2); return;
    case 1: *to = static_cast<std::uint8_t>(value); return;
    default: break;
  }
  for (unsigned i = 0; i < bytes; ++i) to[i] = static_cast<std::uint8_t>(value >> 8 * i);
}

}  // namespace canopus::canopen
