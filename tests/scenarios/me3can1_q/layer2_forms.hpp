#pragma once
// Both identifier lengths of the Layer 2 modes, and slots as their parameters set them up.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {

struct Layer2Form {
  std::uint16_t mode;
  std::uint32_t highest;
};
inline constexpr std::array layer2_forms{Layer2Form{11, 0x7FF}, Layer2Form{29, 0x1FFF'FFFF}};

inline can::Frame frame(const Layer2Form& form, std::uint32_t identifier, const Bytes& bytes) {
  can::Frame result = can::data_frame(identifier, bytes);
  result.extended = form.mode == 29;
  return result;
}
inline can::Frame remote(const Layer2Form& form, std::uint32_t identifier, std::uint8_t dlc) {
  can::Frame result = can::remote_frame(identifier, dlc);
  result.extended = form.mode == 29;
  return result;
}

/// Slots are numbered from 1, as in the manual.
constexpr module::BufferAddress parameters(unsigned slot) { return 6000 + 4 * (slot - 1); }
constexpr module::BufferAddress block(unsigned slot) { return 10000 + 7 * (slot - 1); }

/// Parameters B, C and D, and the identifier and the length word of the slot's message.
inline void set_transmit(IntelligentScenario& s, unsigned slot, std::uint32_t identifier,
                         std::uint16_t b = 0x5FFF, std::uint16_t c = 4, std::uint16_t length = 2,
                         std::uint16_t d = 1) {
  s.write(parameters(slot), {0xFFFF, b, c, d});
  s.write(block(slot),
          {static_cast<std::uint16_t>(identifier), static_cast<std::uint16_t>(identifier >> 16), length});
}

}  // namespace canopus::scenario
