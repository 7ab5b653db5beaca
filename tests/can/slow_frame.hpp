#pragma once
// The wire of one frame, bit by bit, as ISO 11898-1 tells it and as slowly as that: nothing here is shared
// with the program. Levels are characters: '0' dominant, '1' recessive.

#include <cstdint>
#include <string>

#include "canopus/can/frame.hpp"

namespace canopus::can::slow {

inline void append(std::string& bits, std::uint64_t value, int count) {
  for (int bit = count - 1; bit >= 0; --bit) bits += ((value >> bit) & 1) != 0 ? '1' : '0';
}

/// SOF to the last data bit, not stuffed.
inline std::string before_crc(const Frame& frame) {
  std::string bits = "0";
  if (frame.extended) {
    append(bits, frame.identifier >> 18, 11);
    bits += "11";  // SRR, IDE
    append(bits, frame.identifier & 0x3FFFF, 18);
    bits += frame.remote ? '1' : '0';
    bits += "00";  // r1, r0
  } else {
    append(bits, frame.identifier, 11);
    bits += frame.remote ? '1' : '0';
    bits += "00";  // IDE, r0
  }
  append(bits, frame.dlc, 4);
  const int bytes = frame.remote ? 0 : (frame.dlc > 8 ? 8 : frame.dlc);
  for (int byte = 0; byte < bytes; ++byte) append(bits, frame.data[static_cast<std::size_t>(byte)], 8);
  return bits;
}

/// The shift register of ISO 11898-1: CRC_NXT = NXTBIT xor CRC_RG(14).
inline std::uint32_t crc(const std::string& bits) {
  std::uint32_t shift_register = 0;
  for (const char bit : bits) {
    const std::uint32_t next = static_cast<std::uint32_t>(bit - '0') ^ ((shift_register >> 14) & 1);
    shift_register = (shift_register << 1) & 0x7FFF;
    if (next != 0) shift_register ^= 0x4599;
  }
  return shift_register;
}

inline std::string stuffed(const std::string& bits) {
  std::string wire;
  int row = 0;
  char last = 'x';
  for (const char bit : bits) {
    row = bit == last ? row + 1 : 1;
    last = bit;
    wire += bit;
    if (row == 5) {
      last = bit == '0' ? '1' : '0';
      wire += last;
      row = 1;
    }
  }
  return wire;
}

/// SOF to the end of EOF as a transmitter without acknowledgement sends it.
inline std::string wire(const Frame& frame) {
  std::string bits = before_crc(frame);
  append(bits, crc(bits), 15);
  return stuffed(bits) + "1" + "1" + "1" + "1111111";
}

}  // namespace canopus::can::slow
