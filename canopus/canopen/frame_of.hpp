#pragma once
// Data frames made as a whole. Built member by member, a frame is written in pieces and read as a whole,
// which costs the processor more than everything else an SDO server does for a request.

#include <bit>
#include <cstddef>
#include <cstdint>

#include "canopus/can/frame.hpp"

namespace canopus::canopen {

/// `key`: identifier, bit 29 = extended. `bytes`: data[0] in bits 0-7 and so on; those beyond dlc must be 0.
[[nodiscard]] inline can::Frame frame_of(std::uint32_t key, std::uint8_t dlc, std::uint64_t bytes) noexcept {
  static_assert(std::endian::native == std::endian::little);
  static_assert(offsetof(can::Frame, identifier) == 0 && offsetof(can::Frame, extended) == 4 &&
                offsetof(can::Frame, remote) == 5 && offsetof(can::Frame, dlc) == 6 &&
                offsetof(can::Frame, data) == 8);
  // One vector, so that it is one write: queues copy frames whole, and a whole read of what was written in
  // two halves waits until both are in the cache.
  using Words = std::uint64_t __attribute__((vector_size(16)));
  const std::uint64_t extended = key >> 29 & 1U;
  return std::bit_cast<can::Frame>(
      Words{(key & 0x1FFF'FFFFU) | extended << 32 | std::uint64_t{dlc} << 48, bytes});
}

}  // namespace canopus::canopen
