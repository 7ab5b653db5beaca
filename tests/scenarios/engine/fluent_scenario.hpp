#pragma once
// The steps of every module's scenario as those of one model's, so that the model's own steps can follow them.

#include "scenarios/engine/other_models.hpp"

namespace canopus::scenario {

/// `Self` is the class made of this one.
template <typename Self, typename Model>
class FluentScenario : public OtherScenario<Model> {
 public:
  using Address = module::BufferAddress;
  Self& write(Address address, std::uint16_t value) { return step(ModuleScenario::write(address, value)); }
  Self& write(Address first, const Words& values) { return step(ModuleScenario::write(first, values)); }
  Self& expect(Address address, std::uint16_t value, Where where = Where::current()) {
    return step(ModuleScenario::expect(address, value, where));
  }
  Self& expect(Address first, const Words& values, Where where = Where::current()) {
    return step(ModuleScenario::expect(first, values, where));
  }
  Self& expect_bit(Address address, unsigned bit, bool on, Where where = Where::current()) {
    return step(ModuleScenario::expect_bit(address, bit, on, where));
  }
  Self& wait_bit(Address address, unsigned bit, bool on, can::Duration at_most = 20s,
                 Where where = Where::current()) {
    return step(ModuleScenario::wait_bit(address, bit, on, at_most, where));
  }
  Self& rx(std::uint32_t identifier, const Bytes& bytes = {}) {
    return step(ModuleScenario::rx(identifier, bytes));
  }
  Self& rx(const can::Frame& frame) { return step(ModuleScenario::rx(frame)); }
  Self& rx_remote(std::uint32_t identifier, std::uint8_t dlc = 0) {
    return step(ModuleScenario::rx_remote(identifier, dlc));
  }
  Self& tx(std::uint32_t identifier, const Bytes& bytes = {}, Where where = Where::current()) {
    return step(ModuleScenario::tx(identifier, bytes, where));
  }
  Self& tx(const can::Frame& frame, Where where = Where::current()) {
    return step(ModuleScenario::tx(frame, where));
  }
  Self& tx_remote(std::uint32_t identifier, Where where = Where::current()) {
    return step(ModuleScenario::tx_remote(identifier, where));
  }
  Self& wait_tx(std::uint32_t identifier, const Bytes& bytes = {}, can::Duration at_most = 20s,
                Where where = Where::current()) {
    return step(ModuleScenario::wait_tx(identifier, bytes, at_most, where));
  }
  Self& no_tx(Where where = Where::current()) { return step(ModuleScenario::no_tx(where)); }
  Self& ignore_tx() { return step(ModuleScenario::ignore_tx()); }
  Self& error_counters(std::uint16_t transmit, std::uint16_t receive) {
    return step(ModuleScenario::error_counters(transmit, receive));
  }
  Self& advance(can::Duration duration) { return step(ModuleScenario::advance(duration)); }
  Self& supply_on() { return step(ModuleScenario::supply_on()); }
  Self& supply_off() { return step(ModuleScenario::supply_off()); }
  Self& cpu(module::CpuState state) { return step(ModuleScenario::cpu(state)); }

 private:
  Self& step(ModuleScenario&) { return static_cast<Self&>(*this); }
};

}  // namespace canopus::scenario
