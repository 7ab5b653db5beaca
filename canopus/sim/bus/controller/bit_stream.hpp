#pragma once
// The bits of one frame as its transmitter sends them: the slow way, where single bits of the wire are
// needed. can::frame_bits() counts the same bits without listing them.

#include <array>
#include <cstddef>
#include <cstdint>

#include "canopus/can/frame.hpp"

namespace canopus::sim {

struct BitStream {
  struct Bit {
    bool dominant = false;
    bool stuff = false;
  };
  static constexpr std::size_t max_bits = 160;

  explicit BitStream(const can::Frame& frame) noexcept;
  BitStream() noexcept = default;

  std::array<Bit, max_bits> bits{};
  std::size_t size = 0;             ///< SOF to the last bit of EOF
  std::size_t arbitration_end = 0;  ///< first bit after the arbitration field
  std::size_t ack_slot = 0;

 private:
  void append(std::uint64_t value, unsigned count) noexcept;
  void append_bit(bool recessive, bool stuffed) noexcept;

  bool last_recessive_ = true;
  unsigned row_ = 0;
};

/// The next state of a CRC register after `bit`.
[[nodiscard]] constexpr std::uint16_t crc_step(std::uint16_t crc, bool recessive) noexcept {
  const bool feed = recessive != ((crc & 0x4000) != 0);
  const unsigned shifted = (static_cast<unsigned>(crc) << 1) & 0x7FFF;
  return static_cast<std::uint16_t>(feed ? shifted ^ 0x4599 : shifted);
}

}  // namespace canopus::sim
