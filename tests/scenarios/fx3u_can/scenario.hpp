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

#include "canopus/module/fx3u_can/fx3u_can.hpp"

#include "scenarios/engine/other_models.hpp"

namespace canopus::scenario {

class BlockScenario : public OtherScenario<module::fx3u_can::Fx3uCan> {
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

  // Every module's steps, to be followed by those above.
  using Base = ModuleScenario;
  using Address = module::BufferAddress;
  BlockScenario& write(Address address, std::uint16_t value) { return step(Base::write(address, value)); }
  BlockScenario& write(Address first, const Words& values) { return step(Base::write(first, values)); }
  BlockScenario& expect(Address address, std::uint16_t value, Where where = Where::current()) {
    return step(Base::expect(address, value, where));
  }
  BlockScenario& expect(Address first, const Words& values, Where where = Where::current()) {
    return step(Base::expect(first, values, where));
  }
  BlockScenario& expect_bit(Address address, unsigned bit, bool on, Where where = Where::current()) {
    return step(Base::expect_bit(address, bit, on, where));
  }
  BlockScenario& wait_bit(Address address, unsigned bit, bool on, can::Duration at_most = 20s,
                          Where where = Where::current()) {
    return step(Base::wait_bit(address, bit, on, at_most, where));
  }
  BlockScenario& rx(std::uint32_t identifier, const Bytes& bytes = {}) {
    return step(Base::rx(identifier, bytes));
  }
  BlockScenario& rx(const can::Frame& frame) { return step(Base::rx(frame)); }
  BlockScenario& rx_remote(std::uint32_t identifier, std::uint8_t dlc = 0) {
    return step(Base::rx_remote(identifier, dlc));
  }
  BlockScenario& tx(std::uint32_t identifier, const Bytes& bytes = {}, Where where = Where::current()) {
    return step(Base::tx(identifier, bytes, where));
  }
  BlockScenario& tx(const can::Frame& frame, Where where = Where::current()) {
    return step(Base::tx(frame, where));
  }
  BlockScenario& tx_remote(std::uint32_t identifier, Where where = Where::current()) {
    return step(Base::tx_remote(identifier, where));
  }
  BlockScenario& wait_tx(std::uint32_t identifier, const Bytes& bytes = {}, can::Duration at_most = 20s,
                         Where where = Where::current()) {
    return step(Base::wait_tx(identifier, bytes, at_most, where));
  }
  BlockScenario& no_tx(Where where = Where::current()) { return step(Base::no_tx(where)); }
  BlockScenario& ignore_tx() { return step(Base::ignore_tx()); }
  BlockScenario& error_counters(std::uint16_t transmit, std::uint16_t receive) {
    return step(Base::error_counters(transmit, receive));
  }
  BlockScenario& advance(can::Duration duration) { return step(Base::advance(duration)); }
  BlockScenario& supply_on() { return step(Base::supply_on()); }
  BlockScenario& supply_off() { return step(Base::supply_off()); }
  BlockScenario& cpu(module::CpuState state) { return step(Base::cpu(state)); }

 private:
  BlockScenario& step(ModuleScenario&) { return *this; }
};

}  // namespace canopus::scenario
