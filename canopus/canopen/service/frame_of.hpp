#pragma once
// Data frames made as a whole. Built member by member, a frame is written in pieces and read as a whole,
// which costs the processor more than everything else an SDO server does for a request.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

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
  [[nodiscard]] constexpr std::uint32_t identifier() const noexcept { return word_ & 0x1FFF'FFFFU; }
  [[nodiscard]] constexpr bool is_extended() const noexcept { return (word_ >> 32 & 1U) != 0; }
  /// head_without_dlc() of these frames.
  [[nodiscard]] constexpr std::uint64_t without_dlc() const noexcept { return word_ << 16; }

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

/// Identifier, format and RTR of a frame as one number, to be compared.
[[nodiscard]] inline std::uint64_t head_without_dlc(const can::Frame& frame) noexcept {
  std::uint64_t head = 0;
  std::memcpy(&head, &frame, sizeof head);
  return head << 16;
}

/// Neither an extended identifier nor a remote frame: both asked with one load.
[[nodiscard]] inline bool is_base_data(const can::Frame& frame) noexcept {
  std::uint16_t extended_and_remote = 0;
  std::memcpy(&extended_and_remote,
              reinterpret_cast<const std::uint8_t*>(&frame) + offsetof(can::Frame, extended), 2);
  return extended_and_remote == 0;
}

/// The data bytes of a frame as a number: data[0] in bits 0-7 and so on.
[[nodiscard]] inline std::uint64_t data_word(const can::Frame& frame) noexcept {
  return std::bit_cast<std::uint64_t>(frame.data);
}

}  // namespace canopus::canopen
