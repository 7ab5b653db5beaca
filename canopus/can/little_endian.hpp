#pragma once
// Numbers as CANopen carries and stores them, lowest byte first, between bytes and a register. The usual
// lengths are one load or store.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace canopus::can {

static_assert(std::endian::native == std::endian::little,
              "bytes are loaded and stored as they lie in memory");

/// The number of T's size that begins at `from`.
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

/// The same of a value of any length; of more than 8 bytes the first 8 count.
[[nodiscard]] inline std::uint64_t load_value(std::span<const std::uint8_t> bytes) noexcept {
  return load_value(bytes.data(), static_cast<unsigned>(std::min<std::size_t>(bytes.size(), 8)));
}

/// The same as an UNSIGNED32; of more than 4 bytes the first 4 count.
[[nodiscard]] inline std::uint32_t load_u32(std::span<const std::uint8_t> bytes) noexcept {
  return static_cast<std::uint32_t>(load_value(bytes.first(std::min<std::size_t>(bytes.size(), 4))));
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

// Where the length is known beforehand as a mask, and 8 bytes may be touched whatever the length: no branch hangs on the
// length, which differs from value to value.

/// Of the 8 bytes at `from`, what `mask` has.
[[nodiscard]] inline std::uint64_t load_masked(const std::uint8_t* from, std::uint64_t mask) noexcept {
  return load_as<std::uint64_t>(from) & mask;
}
/// Of the 8 bytes at `to`, what `mask` has becomes as in `value`.
inline void store_masked(std::uint8_t* to, std::uint64_t value, std::uint64_t mask) noexcept {
  const std::uint64_t all = (load_as<std::uint64_t>(to) & ~mask) | (value & mask);
  std::memcpy(to, &all, sizeof all);
}

/// The same as store_value() behind what is there already.
inline void append_value(std::vector<std::uint8_t>& to, std::uint64_t value, unsigned bytes) {
  to.resize(to.size() + bytes);
  store_value(to.data() + to.size() - bytes, value, bytes);
}

/// The same alone: little_endian(0x195, 4) = 95 01 00 00.
[[nodiscard]] inline std::vector<std::uint8_t> little_endian(std::uint64_t value, unsigned bytes) {
  std::vector<std::uint8_t> result(bytes);
  store_value(result.data(), value, bytes);
  return result;
}

}  // namespace canopus::can
