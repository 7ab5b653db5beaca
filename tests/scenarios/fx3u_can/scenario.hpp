#pragma once
// The scenario language with the shorthands of spec/fx3u-can/scenarios.md: a module without signals, asked by bits of its
// buffer memory.
//
//   BlockScenario s;
//   s.power_on();              // 77F#00
//   s.write(21, 11).save();    // #21=11; #22=1, wait 0
//   s.restart();               // #25=1, wait b7=0
//   s.exchange();              // #20=1, wait b0=0
//   s.cif({0x0004, 0, 0x1000, 0}).expect(1000, 0x0005);

#include "canopus/module/models/fx3u_can/fx3u_can.hpp"

#include "scenarios/engine/fluent_scenario.hpp"

namespace canopus::scenario {

class BlockScenario : public FluentScenario<BlockScenario, module::fx3u_can::Fx3uCan> {
 public:
  /// FACTORY: supply on, initialized, boot-up gone by.
  BlockScenario& power_on(Where where = Where::current());
  /// As a node with this node-ID, saved and started anew, its frames gone by.
  BlockScenario& power_on_as(std::uint8_t node_id, Where where = Where::current());
  /// Node 127, Operational, its frames gone by.
  BlockScenario& power_on_operational(Where where = Where::current());
  /// As active NMT master, started anew, its frames gone by. `start_up`: 1F80H.
  BlockScenario& power_on_as_master(std::uint8_t node_id = 127, std::uint32_t start_up = 1,
                                    Where where = Where::current());
  /// In a Layer 2 mode (11 or 29), saved, started anew, offline.
  BlockScenario& power_on_layer2(std::uint16_t mode = 11, Where where = Where::current());
  /// #25 b4.
  BlockScenario& online(Where where = Where::current());
  BlockScenario& offline(Where where = Where::current());
  /// #22, wait until it reads 0.
  BlockScenario& save(std::uint16_t bits = 1, Where where = Where::current());
  /// #25=1, wait until b7 is 0. The frames of the restart do not matter.
  BlockScenario& restart(Where where = Where::current());
  /// #20, wait until b0 reads 0.
  BlockScenario& exchange(std::uint16_t bits = 1, Where where = Where::current());
  /// Parameters to #1001 on, the code to #1000, then 1 ms: a command without another node has ended.
  BlockScenario& cif(const Words& command);
  /// The command failed with this SDO abort code.
  BlockScenario& expect_abort(std::uint32_t code, std::uint16_t node = 0, Where where = Where::current());
  BlockScenario& set_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length,
                            Where where = Where::current());
  BlockScenario& expect_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length,
                               Where where = Where::current());
  BlockScenario& nmt(std::uint8_t command, std::uint8_t node = 0);
  /// CIF 6000H at the own node.
  BlockScenario& store_objects(Where where = Where::current());
};

}  // namespace canopus::scenario
