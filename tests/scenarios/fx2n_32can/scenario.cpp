#include "scenarios/fx2n_32can/scenario.hpp"

namespace canopus::scenario {

Fx2nScenario& Fx2nScenario::power_on(Where where) {
  supply_on().wait_bit(25, 0, true, 20s, where).tx(0x77F, {0x00}, where);
  return *this;
}

Fx2nScenario& Fx2nScenario::start(std::uint8_t node_id, Where where) {
  power_on(where).write(26, 0);
  if (node_id == 127) return *this;
  write(27, node_id);
  return restart(where);
}

Fx2nScenario& Fx2nScenario::start_operational(std::uint8_t node_id, Where where) {
  start(node_id, where).cif({0x8900}).expect(1000, 0x8901, where);
  nmt(1).expect_bit(25, 9, true, where).ignore_tx();
  return *this;
}

Fx2nScenario& Fx2nScenario::start_as_manager(Where where) {
  start(1, where).set_object(0x1F80, 0, 1, 4, where).set_object(0x1010, 1, 0x6576'6173, 4, where);
  // What comes later is no boot-up message of the manager's reset any more.
  restart(where).wait_bit(25, 9, true, 5s, where).advance(10s).ignore_tx();
  return *this;
}

Fx2nScenario& Fx2nScenario::restart(Where where) {
  write(25, 1).expect_bit(25, 0, false, where).wait_bit(25, 0, true, 20s, where).ignore_tx();
  return *this;
}

Fx2nScenario& Fx2nScenario::exchange() {
  write(20, 1);
  return *this;
}

Fx2nScenario& Fx2nScenario::cif(const Words& command) {
  for (std::size_t i = 1; i < command.size(); ++i)
    write(static_cast<module::BufferAddress>(1000 + i), command[i]);
  write(1000, command.front()).advance(1ms);
  return *this;
}

Fx2nScenario& Fx2nScenario::expect_abort(std::uint32_t code, std::uint16_t node, Where where) {
  expect(1000,
         {0x000F, 0x0003, node, static_cast<std::uint16_t>(code & 0xFFFF),
          static_cast<std::uint16_t>(code >> 16)},
         where);
  return *this;
}

Fx2nScenario& Fx2nScenario::set_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                                       unsigned length, Where where) {
  cif({0x0002, 0, index, sub, static_cast<std::uint16_t>(length), static_cast<std::uint16_t>(value & 0xFFFF),
       static_cast<std::uint16_t>(value >> 16)})
      .expect(1000, 0x0003, where);
  return *this;
}

Fx2nScenario& Fx2nScenario::expect_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                                          unsigned length, Where where) {
  cif({0x0004, 0, index, sub})
      .expect(1000, 0x0005, where)
      .expect(1004, static_cast<std::uint16_t>(length), where)
      .expect(1005, static_cast<std::uint16_t>(value & 0xFFFF), where);
  if (length > 2) expect(1006, static_cast<std::uint16_t>(value >> 16), where);
  return *this;
}

Fx2nScenario& Fx2nScenario::nmt(std::uint8_t command, std::uint8_t node) {
  rx(0x000, {command, node});
  return *this;
}

Fx2nScenario& Fx2nScenario::accepts(std::uint8_t node, const Bytes& request, Where where) {
  tx(0x600U + node, request, where);
  rx(0x580U + node, {0x60, request[1], request[2], request[3], 0, 0, 0, 0});
  return *this;
}

Fx2nScenario& Fx2nScenario::aborts(std::uint8_t node, const Bytes& request, std::uint32_t code, Where where) {
  tx(0x600U + node, request, where);
  Bytes answer{0x80, request[1], request[2], request[3], 0, 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) answer[4 + i] = static_cast<std::uint8_t>(code >> (8 * i));
  rx(0x580U + node, answer);
  return *this;
}

Fx2nScenario& Fx2nScenario::says(std::uint8_t node, std::uint16_t index, std::uint8_t sub,
                                 std::uint32_t value, Where where) {
  const auto low = static_cast<std::uint8_t>(index & 0xFF), high = static_cast<std::uint8_t>(index >> 8);
  tx(0x600U + node, {0x40, low, high, sub, 0, 0, 0, 0}, where);
  Bytes answer{0x43, low, high, sub, 0, 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) answer[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
  rx(0x580U + node, answer);
  return *this;
}

Fx2nScenario& Fx2nScenario::is_silent(std::uint8_t node, Where where) {
  if (controller().sent.empty() || controller().sent.front().identifier != 0x600U + node)
    failed(where, "no SDO request to node " + std::to_string(node));
  ignore_tx().advance(500ms).ignore_tx();
  return *this;
}

}  // namespace canopus::scenario
