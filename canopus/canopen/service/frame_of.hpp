#pragma once
// Data frames made as a whole. Built member by member, a frame is written in pieces and read as a whole,
// which costs the processor more than everything else an SDO server does for a request.

#include <bit>
#include <cstddef>
#include <cstdint>

#include "canopus/can/frame.hpp"

namespace canopus::canopen {

static_assert(std::endian::native == std::endian::little);
static_assert(offsetof(can::Frame, identifier) == 0 && offsetof(can::Frame, extended) == 4 &&
              offsetof(can::Frame, remote) == 5 && offsetof(can::Frame, dlc) == 6 &&
              offsetof(can::Frame, data) == 8);

/// Everything of a data frame that is not data, worked out once for all frames of a channel.
class FrameHead {
 public:
  FrameHead() = default;
  /// `key`: identifier, bit 29 = extended.
  constexpr FrameHead(std::uint32_t key, std::uint8_t dlc) noexcept
      : word_((key & 0x1FFF'FFFFU) | std::uint64_t{key >> 29 & 1U} << 32 | std::uint64_t{dlc} << 48) {}
  [[nodiscard]] constexpr std::uint64_t word() const noexcept { return word_; }

 private:
  std::uint64_t word_ = 0;
};

/// `bytes`: data[0] in bits 0-7 and so on; those beyond the head's dlc must be 0.
[[nodiscard]] inline can::Frame frame_of(FrameHead head, std::uint64_t bytes) noexcept {
  // One vector, so that it is one write: queues copy frames whole, and a whole read of what was written in
  // two halves waits until both are in the cache.
  using Words = std::uint64_t __attribute__((vector_size(16)));
  return std::bit_cast<can::Frame>(Words{head.word(), bytes});
}

/// The data bytes of a frame as a number: data[0] in bits 0-7 and so on.
[[nodiscard]] inline std::uint64_t data_word(const can::Frame& frame) noexcept {
  return std::bit_cast<std::uint64_t>(frame.data);
}

}  // namespace canopus::canopen
