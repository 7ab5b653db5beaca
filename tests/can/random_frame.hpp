#pragma once
// Random frames of all kinds, with long rows of equal bits more often than chance has them.

#include <cstdint>
#include <random>

#include "canopus/can/frame.hpp"

namespace canopus::can {

inline Frame random_frame(std::mt19937_64& random) {
  const std::uint64_t kind = random();
  Frame frame;
  frame.extended = (kind & 1) != 0;
  frame.remote = (kind & 6) == 0;
  frame.dlc = static_cast<std::uint8_t>((kind >> 8) & 15);
  std::uint64_t identifier = random();
  if ((kind & 0x30) == 0) identifier &= random() & random();
  if ((kind & 0x30) == 0x10) identifier |= random() | random();
  frame.identifier = static_cast<std::uint32_t>(identifier) &
                     (frame.extended ? max_extended_identifier : max_base_identifier);
  for (std::size_t byte = 0; byte < frame.length(); ++byte) {
    std::uint64_t value = random();
    if ((kind & 0xC0) == 0) value &= random() & random();
    if ((kind & 0xC0) == 0x40) value |= random() | random();
    frame.data[byte] = static_cast<std::uint8_t>(value);
  }
  return frame;
}

}  // namespace canopus::can
