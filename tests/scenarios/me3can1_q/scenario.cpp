#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {

std::unique_ptr<module::ModuleEngine> make_module(std::string_view model, can::Controller& controller,
                                                  module::NonVolatileMemory& memory) {
  if (model == rj71cn91) return std::make_unique<module::rj71cn91::Rj71cn91>(controller, memory);
  return std::make_unique<module::me3can1_q::Me3can1Q>(controller, memory);
}

IntelligentScenario& IntelligentScenario::clear_errors() {
  if (!is_rj71cn91()) {
    write(29, 0);
    return *this;
  }
  y(0x0F, true);
  y(0x0F, false);
  return *this;
}

IntelligentScenario& IntelligentScenario::power_on(Where where) {
  supply_on();
  wait_bit(25, 7, false, 20s, where);
  ignore_tx();
  return *this;
}

IntelligentScenario& IntelligentScenario::power_on_as(std::uint8_t node_id, Where where) {
  power_on(where);
  write(27, node_id);
  save(1, where);
  return restart(where);
}

IntelligentScenario& IntelligentScenario::power_on_operational(Where where) {
  power_on_as(1, where);
  nmt(0x01);
  expect_bit(25, 0, true, where);
  ignore_tx();
  return *this;
}

IntelligentScenario& IntelligentScenario::power_on_as_master(Where where) {
  power_on_as(1, where);
  set_object(0x1F80, 0, 0x0000000D, 4, where);  // stays Pre-operational, starts no slave
  store_objects(where);
  restart(where);
  advance(5s);
  ignore_tx();
  expect_bit(25, 15, true, where).expect_bit(25, 8, true, where);
  return *this;
}

IntelligentScenario& IntelligentScenario::power_on_layer2(std::uint16_t mode, Where where) {
  power_on(where);
  write(21, mode);
  save(1, where);
  return restart(where);
}

IntelligentScenario& IntelligentScenario::online(Where where) {
  y(0x03, true);
  expect_x(0x03, true, where);
  if (is_rj71cn91()) ignore_tx();  // every transmit slot is sent once: shown in rj71cn91/layer2_test.cpp
  return *this;
}

IntelligentScenario& IntelligentScenario::offline(Where where) {
  y(0x03, false);
  expect_x(0x03, false, where);
  return *this;
}

IntelligentScenario& IntelligentScenario::request(unsigned number, Where where) {
  y(number, true);
  wait_x(number, true, 60s, where);
  y(number, false);
  expect_x(number, false, where);
  return *this;
}

IntelligentScenario& IntelligentScenario::save(std::uint16_t g22, Where where) {
  write(22, g22);
  request(0x1F, where);
  expect(22, 0, where);
  return *this;
}

IntelligentScenario& IntelligentScenario::restart(Where where) {
  request(0x02, where);
  ignore_tx();
  return *this;
}

IntelligentScenario& IntelligentScenario::cif(const Words& command, Where where) {
  write(1000, command);
  return request(0x17, where);
}

IntelligentScenario& IntelligentScenario::expect_abort(std::uint32_t code, std::uint16_t node, Where where) {
  const auto low = static_cast<std::uint16_t>(code), high = static_cast<std::uint16_t>(code >> 16);
  expect(1000, {0x000F, 0x0003, node, low, high}, where);
  return *this;
}

IntelligentScenario& IntelligentScenario::exchange(Where where) { return request(0x01, where); }

IntelligentScenario& IntelligentScenario::set_object(std::uint16_t index, std::uint8_t sub,
                                                     std::uint32_t value, unsigned length, Where where) {
  cif({0x0002, 0, index, sub, static_cast<std::uint16_t>(length), static_cast<std::uint16_t>(value & 0xFFFF),
       static_cast<std::uint16_t>(value >> 16)},
      where);
  expect(1000, 0x0003, where);
  return *this;
}

IntelligentScenario& IntelligentScenario::expect_object(std::uint16_t index, std::uint8_t sub,
                                                        std::uint32_t value, unsigned length, Where where) {
  cif({0x0004, 0, index, sub}, where);
  expect(1000, 0x0005, where);
  expect(1004, static_cast<std::uint16_t>(length), where);
  expect(1005, static_cast<std::uint16_t>(value & 0xFFFF), where);
  if (length > 2) expect(1006, static_cast<std::uint16_t>(value >> 16), where);
  return *this;
}

IntelligentScenario& IntelligentScenario::nmt(std::uint8_t command, std::uint8_t node) {
  rx(0x000, {command, node});
  return *this;
}

IntelligentScenario& IntelligentScenario::store_objects(Where where) {
  return set_object(0x1010, 1, 0x65766173, 4, where);
}

}  // namespace canopus::scenario
