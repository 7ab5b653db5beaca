#pragma once
// The FX3U-CAN in CANopen 417 mode, for spec/fx3u-can/scenarios-417-l2.md.

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario {

/// 417 mode, saved and started anew as this node, Pre-operational, its frames gone by. `lifts`: #13000.
inline void start_lift_mode(BlockScenario& s, std::uint16_t lifts = 1, std::uint8_t node = 1,
                            Where where = Where::current()) {
  s.power_on(where).write(21, 417).write(27, node).save(1, where).restart(where);
  s.write(13000, lifts).expect(29, 0, where).ignore_tx();
}

/// READY-417: the same, Operational. Heartbeat and FROM/TO watchdog are switched off.
inline void start_lift_operational(BlockScenario& s, std::uint16_t lifts = 1, std::uint8_t node = 1,
                                   Where where = Where::current()) {
  start_lift_mode(s, lifts, node, where);
  s.write(26, 0).set_object(0x1017, 0, 0, 2, where).nmt(0x01, 0).expect_bit(25, 0, true, where).ignore_tx();
}

}  // namespace canopus::scenario
