// A mapping or COB-ID that changes while the module runs counts from then on, whichever way it changed: what
// the data exchange worked out for the old one must be forgotten.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_mapping_change_test {
namespace {

CANOPUS_OF_BOTH_MODULES(MappingChange);

struct Step {
  std::uint16_t index;
  std::uint8_t sub;
  std::uint32_t value;
  unsigned length;
};
using Steps = std::vector<Step>;

// RPDO1 as one word, to G10016, and TPDO1 as one word, from G13016.
const Steps new_mappings{{0x1400, 1, 0x80000201, 4}, {0x1600, 0, 0, 1},          {0x1600, 1, 0xA5801110, 4},
                         {0x1600, 0, 1, 1},          {0x1400, 1, 0x00000201, 4}, {0x1800, 1, 0xC0000181, 4},
                         {0x1A00, 0, 0, 1},          {0x1A00, 1, 0xA1001110, 4}, {0x1A00, 0, 1, 1},
                         {0x1800, 1, 0x40000181, 4}};
// The same on other COB-IDs.
const Steps new_cob_ids{{0x1400, 1, 0x80000201, 4},
                        {0x1400, 1, 0x00000231, 4},
                        {0x1800, 1, 0xC0000181, 4},
                        {0x1800, 1, 0x400001B1, 4}};

void by_command_interface(IntelligentScenario& s, const Steps& steps) {
  for (const Step& step : steps) s.set_object(step.index, step.sub, step.value, step.length);
}
void by_sdo(IntelligentScenario& s, const Steps& steps) {
  for (const auto& [index, sub, value, length] : steps) {
    const auto low = static_cast<std::uint8_t>(index & 0xFF);
    const auto high = static_cast<std::uint8_t>(index >> 8);
    const auto byte = [value = value](unsigned number) {
      return static_cast<std::uint8_t>(value >> 8 * number);
    };
    const std::uint8_t command = length == 4 ? 0x23 : 0x2F;
    s.rx(0x601, {command, low, high, sub, byte(0), byte(1), byte(2), byte(3)});
    s.tx(0x581, {0x60, low, high, sub, 0, 0, 0, 0});
  }
}

unsigned turn = 0;  // other values each time

// RPDO1 and TPDO1 as from the factory: four words each, from the first on.
void expect_factory_mappings(IntelligentScenario& s) {
  const auto value = static_cast<std::uint8_t>(++turn);
  s.rx(0x201, {value, 1, value, 2, value, 3, value, 4});
  for (std::uint16_t word = 0; word < 4; ++word) {
    s.write(13000 + word, static_cast<std::uint16_t>(value << 8 | word));
  }
  s.exchange();
  for (std::uint16_t word = 0; word < 4; ++word) {
    s.expect(10000 + word, static_cast<std::uint16_t>((word + 1) << 8 | value));
  }
  s.tx(0x181, {0, value, 1, value, 2, value, 3, value}).no_tx();
}

// One word each, on these identifiers; G10000 stays as it is.
void expect_one_word(IntelligentScenario& s, std::uint32_t rpdo, std::uint32_t tpdo) {
  const auto value = static_cast<std::uint8_t>(++turn);
  const std::uint16_t untouched = s.read(10000);
  s.rx(rpdo, {value, 0x77});
  s.write(13000, value).write(13016, static_cast<std::uint16_t>(0x5500 | value));
  s.exchange();
  s.expect(10016, static_cast<std::uint16_t>(0x7700 | value)).expect(10000, untouched);
  s.tx(tpdo, {value, 0x55}).no_tx();
}

void operational_with_factory_mappings(IntelligentScenario& s) {
  s.power_on_as(1);
  s.nmt(0x01);
  s.ignore_tx();
  expect_factory_mappings(s);  // what the exchange works out once is worked out
}

TEST_P(MappingChange, ByTheCommandInterface_CountsInTheNextExchange) {
  spec("ME3-PDO-004", "RJ71-PDO-005 RJ71-PDO-006");
  IntelligentScenario s(GetParam());
  operational_with_factory_mappings(s);
  by_command_interface(s, new_mappings);
  expect_one_word(s, 0x201, 0x181);
  by_command_interface(s, new_cob_ids);
  expect_one_word(s, 0x231, 0x1B1);
}

TEST_P(MappingChange, BySdo_AsAConfigurationManagerDoes_CountsInTheNextExchange) {
  IntelligentScenario s(GetParam());
  operational_with_factory_mappings(s);
  by_sdo(s, new_mappings);
  expect_one_word(s, 0x201, 0x181);
  by_sdo(s, new_cob_ids);
  expect_one_word(s, 0x231, 0x1B1);
}

TEST_P(MappingChange, ByResetCommunication_OldMappingsAreBack) {
  IntelligentScenario s(GetParam());
  operational_with_factory_mappings(s);
  by_sdo(s, new_mappings);
  by_sdo(s, new_cob_ids);
  expect_one_word(s, 0x231, 0x1B1);
  s.nmt(0x82, 1);
  s.advance(5s);
  s.nmt(0x01);
  s.ignore_tx();
  expect_factory_mappings(s);
}

TEST_P(MappingChange, StoredAndRestored_CountsAfterEachRestart) {
  IntelligentScenario s(GetParam());
  operational_with_factory_mappings(s);
  by_command_interface(s, new_mappings);
  by_command_interface(s, new_cob_ids);
  s.store_objects();
  s.restart();
  s.nmt(0x01);
  s.ignore_tx();
  expect_one_word(s, 0x231, 0x1B1);
  s.set_object(0x1011, 1, 0x64616F6C, 4);
  expect_one_word(s, 0x231, 0x1B1);  // until the restart
  s.restart();
  s.nmt(0x01);
  s.ignore_tx();
  expect_factory_mappings(s);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_mapping_change_test
