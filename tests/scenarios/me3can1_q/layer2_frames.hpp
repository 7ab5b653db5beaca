#pragma once
// Frames of the Layer 2 modes.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {

/// A data frame with a 29-bit identifier.
inline can::Frame extended(std::uint32_t identifier, const Bytes& bytes) {
  can::Frame frame = can::data_frame(0, bytes);
  frame.identifier = identifier;
  frame.extended = true;
  return frame;
}

inline can::Frame remote(std::uint32_t identifier, std::uint8_t dlc, bool is_extended = false) {
  return {.identifier = identifier, .extended = is_extended, .remote = true, .dlc = dlc};
}

/// Slot 1 sends 123H, as G6001 and G6002 (and D) say; online.
inline void one_slot(IntelligentScenario& s, std::uint16_t b, std::uint16_t type, std::uint16_t dlc_word,
                     std::uint16_t cycle = 0) {
  s.power_on_layer2();
  s.write(6000, {0xFFFF, b, type, cycle}).write(10000, {0x0123, 0, dlc_word});
  s.online();
}

}  // namespace canopus::scenario
