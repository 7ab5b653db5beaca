#pragma once
// The scenario language with the shorthands of spec/me3can1-q/scenarios.md.

#include "canopus/module/me3can1_q/me3can1_q.hpp"

#include "scenarios/scenario.hpp"

namespace canopus::scenario {

/// Holds what must live longer than a scenario's steps: the module's memory, its controller, the module.
struct Me3can1QBench {
  RamMemory memory;
  FreeBus bus;
  module::me3can1_q::Me3can1Q module{bus, memory};
};

class Me3Scenario : private Me3can1QBench, public ModuleScenario {
 public:
  Me3Scenario() : ModuleScenario(Me3can1QBench::module, Me3can1QBench::bus) {}

  [[nodiscard]] RamMemory& flash() { return memory; }
  [[nodiscard]] FreeBus& controller() { return bus; }
  [[nodiscard]] module::me3can1_q::Me3can1Q& plug_in() { return Me3can1QBench::module; }

  /// Supply on, initialization over, boot-up frame gone by.
  Me3Scenario& power_on(Where where = Where::current());
  /// As a node with another node-ID than the factory's 127, settings saved.
  Me3Scenario& power_on_as(std::uint8_t node_id, Where where = Where::current());
  /// In a Layer 2 mode (11 or 29), saved, started anew, offline.
  Me3Scenario& power_on_layer2(std::uint16_t mode = 11, Where where = Where::current());
  /// Y03=1 -> X03 1.
  Me3Scenario& online(Where where = Where::current());
  /// Y03=0 -> X03 0.
  Me3Scenario& offline(Where where = Where::current());
  /// `save`: G22=1; Y1F=1; wait X1F -> 1 (G22 -> 0); Y1F=0.
  Me3Scenario& save(std::uint16_t g22 = 1, Where where = Where::current());
  /// `restart`: Y02=1; wait X02 -> 1; Y02=0. The frames of the restart do not matter.
  Me3Scenario& restart(Where where = Where::current());
  /// Command words to G1000 on, then `cif`: Y17=1; wait X17 -> 1; Y17=0; X17 -> 0.
  Me3Scenario& cif(const Words& command, Where where = Where::current());
  /// The command at G1000 failed with this SDO abort code: error 000FH, class 0003H (SDO), the node, the code.
  Me3Scenario& expect_abort(std::uint32_t code, std::uint16_t node = 0, Where where = Where::current());
  /// Y01=1; wait X01 -> 1; Y01=0; X01 -> 0.
  Me3Scenario& exchange(Where where = Where::current());
  /// Writes an object of the module itself through the CIF (node 0), which must succeed.
  Me3Scenario& set_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length,
                          Where where = Where::current());
  /// Reads an object of the module itself through the CIF (node 0), which must succeed and have this value.
  Me3Scenario& expect_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length,
                             Where where = Where::current());
  /// NMT master's command to this node or all.
  Me3Scenario& nmt(std::uint8_t command, std::uint8_t node = 0);
  /// 1010H/01 = "save".
  Me3Scenario& store_objects(Where where = Where::current());

 private:
  Me3Scenario& request(unsigned number, Where where);
};

}  // namespace canopus::scenario
