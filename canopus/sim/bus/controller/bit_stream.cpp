#include "canopus/sim/bus/controller/bit_stream.hpp"

#include "canopus/can/frame_bits.hpp"

namespace canopus::sim {

void BitStream::append_bit(bool recessive, bool stuff) noexcept {
  bits[size++] = {.dominant = !recessive, .stuff = stuff};
  row_ = recessive == last_recessive_ ? row_ + 1 : 1;
  last_recessive_ = recessive;
}

void BitStream::append(std::uint64_t value, unsigned count) noexcept {
  while (count-- > 0) {
    append_bit(((value >> count) & 1U) != 0, false);
    if (row_ == 5) append_bit(!last_recessive_, true);
  }
}

BitStream::BitStream(const can::Frame& frame) noexcept {
  const std::uint64_t remote = frame.remote ? 1 : 0;
  append(0, 1);  // SOF
  if (frame.extended) {
    append(frame.identifier >> 18, 11);
    append(3, 2);  // SRR, IDE
    append(frame.identifier, 18);
  } else {
    append(frame.identifier, 11);
  }
  append_bit(remote != 0, false);
  arbitration_end = size;
  if (row_ == 5) append_bit(!last_recessive_, true);
  append(0, 2);  // r1 and r0, or IDE and r0
  append(frame.dlc, 4);
  for (const std::uint8_t byte : frame.bytes()) append(byte, 8);
  append(can::frame_crc(frame), 15);
  ack_slot = size + 1;
  for (unsigned bit = 0; bit < 1 + 1 + 1 + 7; ++bit) bits[size++] = {};  // CRC delimiter, ACK, EOF
}

}  // namespace canopus::sim
