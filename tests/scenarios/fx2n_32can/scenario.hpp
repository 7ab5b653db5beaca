#pragma once
// The scenario language with the shorthands of spec/fx2n-32can/scenarios.md. Frames and words are as there: W is write(), R is
// expect().
//
//   Fx2nScenario s;
//   s.power_on();                              // new from the box: node 127, 10 kbit/s
//   s.start(5);                                // node 5, watchdog off, the frames of the start gone by
//   s.start_operational(1);                    // the same, Operational, mapping mode 0
//   s.exchange();                              // W 20=1
//   s.cif({0x0004, 0, 0x1000, 0});             // run 4
//   s.expect(1000, 0x0005);

#include "canopus/module/models/fx2n_32can/fx2n_32can.hpp"

#include "scenarios/engine/fluent_scenario.hpp"

namespace canopus::scenario {

class Fx2nScenario : public FluentScenario<Fx2nScenario, module::fx2n_32can::Fx2n32Can> {
 public:
  /// Supply on, online, boot-up gone by.
  Fx2nScenario& power_on(Where where = Where::current());
  Fx2nScenario& start(std::uint8_t node_id = 127, Where where = Where::current());
  Fx2nScenario& start_operational(std::uint8_t node_id = 1, Where where = Where::current());
  /// As the network manager, Operational; node 1.
  Fx2nScenario& start_as_manager(Where where = Where::current());
  /// W 25=1, and online again. The frames of the restart do not matter.
  Fx2nScenario& restart(Where where = Where::current());
  /// W 20=1.
  Fx2nScenario& exchange();
  /// Parameters to 1001 on, the code to 1000, then 1 ms: a command without another node has ended.
  Fx2nScenario& cif(const Words& command);
  /// The command failed with this SDO abort code.
  Fx2nScenario& expect_abort(std::uint32_t code, std::uint16_t node = 0, Where where = Where::current());
  Fx2nScenario& set_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length,
                           Where where = Where::current());
  Fx2nScenario& expect_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length,
                              Where where = Where::current());
  Fx2nScenario& nmt(std::uint8_t command, std::uint8_t node = 0);

  // What another node answers to SDO requests of the module.
  /// It takes a write.
  Fx2nScenario& accepts(std::uint8_t node, const Bytes& request, Where where = Where::current());
  Fx2nScenario& aborts(std::uint8_t node, const Bytes& request, std::uint32_t code,
                       Where where = Where::current());
  /// It is asked for 32 bits, and says these.
  Fx2nScenario& says(std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                     Where where = Where::current());
  /// It is asked, and is silent until the time-out.
  Fx2nScenario& is_silent(std::uint8_t node, Where where = Where::current());
};

}  // namespace canopus::scenario
