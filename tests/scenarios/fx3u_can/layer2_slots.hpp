#pragma once
// Message slots of the FX3U-CAN, in both identifier lengths.

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario {

struct BlockForm {
  std::uint16_t mode;
  std::uint32_t highest;
};
inline constexpr std::array block_forms{BlockForm{11, 0x7FF}, BlockForm{29, 0x1FFF'FFFF}};

inline can::Frame data(const BlockForm& form, std::uint32_t identifier, const Bytes& bytes) {
  can::Frame result = can::data_frame(0, bytes);
  result.identifier = identifier;
  result.extended = form.mode == 29;
  return result;
}
inline can::Frame remote(const BlockForm& form, std::uint32_t identifier, std::uint8_t dlc) {
  return {.identifier = identifier, .extended = form.mode == 29, .remote = true, .dlc = dlc};
}

/// Slots are numbered from 1.
constexpr module::BufferAddress bfm_parameters(unsigned slot) { return 1100 + 4 * (slot - 1); }
constexpr module::BufferAddress bfm_block(unsigned slot) { return 100 + 7 * (slot - 1); }

inline void send_slot(BlockScenario& s, unsigned slot, std::uint32_t identifier, std::uint16_t b,
                      std::uint16_t type, std::uint16_t length, std::uint16_t cycle = 0) {
  s.write(bfm_parameters(slot), {0xFFFF, b, type, cycle});
  s.write(bfm_block(slot),
          {static_cast<std::uint16_t>(identifier), static_cast<std::uint16_t>(identifier >> 16), length});
}
inline void receive_slot(BlockScenario& s, unsigned slot, std::uint32_t identifier, std::uint32_t mask = 0) {
  s.write(bfm_parameters(slot),
          {static_cast<std::uint16_t>(identifier), static_cast<std::uint16_t>(identifier >> 16),
           static_cast<std::uint16_t>(mask), static_cast<std::uint16_t>(mask >> 16)});
}

}  // namespace canopus::scenario
