#pragma once
// Steps of the FX3U-CAN as NMT master.

#include <string>
#include <tuple>

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario {

/// A master as node 127 with these objects, started anew; its boot-up message has gone by.
inline void prepare_master(
    BlockScenario& s,
    const std::vector<std::tuple<std::uint16_t, std::uint8_t, std::uint32_t, unsigned>>& objects) {
  s.power_on().write(26, 0);
  for (const auto& [index, sub, value, length] : objects) s.set_object(index, sub, value, length);
  s.store_objects().save().ignore_tx().write(25, 1).ignore_tx().wait_bit(25, 7, false).tx(0x77F, {0x00});
}
/// A slave is asked for its device type, and says this.
inline void identify_slave(BlockScenario& s, std::uint8_t node, std::uint32_t type,
                           Where where = Where::current()) {
  s.wait_tx(0x600U + node, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}, 20s, where);
  s.rx(0x580U + node, {0x43, 0x00, 0x10, 0, static_cast<std::uint8_t>(type),
                       static_cast<std::uint8_t>(type >> 8), static_cast<std::uint8_t>(type >> 16), 0});
}
/// Lets time pass until the module sends this, whatever else it sends. Returns when it did.
inline can::Time when_first_sent(BlockScenario& s, std::uint32_t identifier, const Bytes& bytes,
                                 can::Duration at_most = 20s) {
  const std::string wanted = text(can::data_frame(identifier, bytes));
  for (const can::Time end = s.now() + at_most; s.now() < end;) {
    for (const can::Frame& frame : s.controller().sent) {
      if (text(frame) != wanted) continue;
      s.ignore_tx();
      return s.now();
    }
    s.ignore_tx().advance(1ms);
  }
  ADD_FAILURE() << wanted << " was not sent";
  return s.now();
}
/// Device type of a slave of these tests: digital and analogue I/O.
inline constexpr std::uint32_t type_of_slave = 0x000F'0191;

}  // namespace canopus::scenario
