#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario {

BlockScenario& BlockScenario::power_on(Where where) {
  supply_on().wait_bit(25, 7, false, 20s, where).tx(0x77F, {0x00}, where);
  return *this;
}

BlockScenario& BlockScenario::power_on_as(std::uint8_t node_id, Where where) {
  power_on(where).write(27, node_id);
  return save(1, where).restart(where);
}

BlockScenario& BlockScenario::power_on_operational(Where where) {
  power_on(where).rx(0x000, {0x01, 0x00}).expect_bit(25, 0, true, where).ignore_tx();
  return *this;
}

BlockScenario& BlockScenario::power_on_as_master(std::uint8_t node_id, std::uint32_t start_up, Where where) {
  power_on_as(node_id, where).set_object(0x1F80, 0, start_up, 4, where).store_objects(where).restart(where);
  ignore_tx();
  return *this;
}

BlockScenario& BlockScenario::power_on_layer2(std::uint16_t mode, Where where) {
  power_on(where).write(21, mode);
  return save(1, where).restart(where);
}

BlockScenario& BlockScenario::online(Where where) {
  write(25, 1U << 4).expect_bit(25, 0, true, where);
  return *this;
}

BlockScenario& BlockScenario::offline(Where where) {
  write(25, 0).expect_bit(25, 0, false, where);
  return *this;
}

BlockScenario& BlockScenario::save(std::uint16_t bits, Where where) {
  write(22, bits)
      .expect(22, bits, where)
      .wait_bit(22, 0, false, 20s, where)
      .wait_bit(22, 1, false, 20s, where);
  return *this;
}

BlockScenario& BlockScenario::restart(Where where) {
  write(25, 1).expect_bit(25, 7, true, where).wait_bit(25, 7, false, 20s, where).ignore_tx();
  return *this;
}

BlockScenario& BlockScenario::exchange(std::uint16_t bits, Where where) {
  write(20, bits).advance(1ms).wait_bit(20, 0, false, 1s, where);
  return *this;
}

BlockScenario& BlockScenario::cif(const Words& command) {
  for (std::size_t i = 1; i < command.size(); ++i)
    write(static_cast<module::BufferAddress>(1000 + i), command[i]);
  write(1000, command.front()).advance(1ms);
  return *this;
}

BlockScenario& BlockScenario::expect_abort(std::uint32_t code, std::uint16_t node, Where where) {
  expect(1000,
         {0x000F, 0x0003, node, static_cast<std::uint16_t>(code & 0xFFFF),
          static_cast<std::uint16_t>(code >> 16)},
         where);
  return *this;
}

BlockScenario& BlockScenario::set_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                                         unsigned length, Where where) {
  cif({0x0002, 0, index, sub, static_cast<std::uint16_t>(length), static_cast<std::uint16_t>(value & 0xFFFF),
       static_cast<std::uint16_t>(value >> 16)})
      .expect(1000, 0x0003, where);
  return *this;
}

BlockScenario& BlockScenario::expect_object(std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                                            unsigned length, Where where) {
  cif({0x0004, 0, index, sub})
      .expect(1000, 0x0005, where)
      .expect(1004, static_cast<std::uint16_t>(length), where);
  expect(1005, static_cast<std::uint16_t>(value & 0xFFFF), where);
  if (length > 2) expect(1006, static_cast<std::uint16_t>(value >> 16), where);
  return *this;
}

BlockScenario& BlockScenario::nmt(std::uint8_t command, std::uint8_t node) {
  rx(0x000, {command, node});
  return *this;
}

BlockScenario& BlockScenario::store_objects(Where where) {
  cif({0x6000, 0, 0xFFFF}).expect(1000, 0x6001, where);
  return *this;
}

}  // namespace canopus::scenario
