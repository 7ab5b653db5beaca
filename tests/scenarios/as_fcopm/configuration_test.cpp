// What CANopen Builder downloads and what it would not [AS-FCOPM 10.1.1, 10.6].

#include <gmock/gmock.h>

#include "scenarios/as_fcopm/card.hpp"

namespace canopus::scenario::as_fcopm_configuration_test {
namespace {

using ::testing::ElementsAre;

fcopm::Configuration one_slave(std::uint8_t node_id = 3) {
  fcopm::Configuration configuration;
  configuration.slaves.push_back({.node_id = node_id});
  return configuration;
}

TEST(FcopmConfiguration, FactorySettings) {
  RecordProperty("spec", "ASF-CFG-001 ASF-CFG-002 ASF-CFG-003 ASF-CFG-004 ASF-CFG-005 ASF-CFG-006");
  FcopmCard card;
  card.card.power_on(card.now);
  card.run(2s);
  EXPECT_EQ(card.bus.rate, 1'000'000U) << "CANopen Builder's default";
  EXPECT_EQ(card.card.node().node_id(), 1);
  EXPECT_EQ(card.card.information().function_mode_name, "CANopen DS301, master");
  card.forget();
  card.run(1s);
  EXPECT_EQ(card.sent(0x080).size(), 20U);
  EXPECT_EQ(card.sent(0x701).size(), 5U);
  EXPECT_TRUE(fcopm::check({}).empty());
}

TEST(FcopmConfiguration, TheOwnNodeIdAndBitRate) {
  RecordProperty("spec", "ASF-CFG-007 ASF-GEN-005");
  fcopm::Configuration configuration = one_slave();
  for (const unsigned good : {1U, 64U, 127U}) {
    configuration.node_id = good;
    EXPECT_TRUE(fcopm::check(configuration).empty()) << good;
  }
  configuration.node_id = 0;
  EXPECT_THAT(fcopm::check(configuration), ElementsAre("node-ID 0; expected 1 to 127"));
  configuration.node_id = 128;
  EXPECT_THAT(fcopm::check(configuration), ElementsAre("node-ID 128; expected 1 to 127"));
  configuration.node_id = 1;
  for (const std::uint16_t wrong : std::vector<std::uint16_t>{0, 10, 100, 800}) {
    configuration.bit_rate = wrong;
    EXPECT_EQ(fcopm::check(configuration).size(), 1U) << wrong;
  }
}

TEST(FcopmConfiguration, SixtyFourSlaves_Nodes1To64) {
  RecordProperty("spec", "ASF-GEN-004 ASF-CFG-007");
  fcopm::Configuration configuration;
  configuration.node_id = 65;
  for (std::uint8_t node = 1; node <= 64; ++node) configuration.slaves.push_back({.node_id = node});
  EXPECT_TRUE(fcopm::check(configuration).empty());
  configuration.slaves.push_back({.node_id = 64});
  EXPECT_THAT(fcopm::check(configuration),
              ElementsAre("65 slaves; expected at most 64", "node 64 is in the node list already"));
  for (const std::uint8_t wrong : std::vector<std::uint8_t>{0, 65, 127})
    EXPECT_EQ(fcopm::check(one_slave(wrong)).size(), 1U) << int{wrong};
}

TEST(FcopmConfiguration, Pdos) {
  RecordProperty("spec", "ASF-PDO-010 ASF-PDO-008 ASF-GEN-009 ASF-CONN-001");
  const auto errors_of = [](fcopm::SlavePdo pdo) {
    fcopm::Configuration configuration = one_slave();
    configuration.slaves[0].tx_pdos.push_back(std::move(pdo));
    return fcopm::check(configuration);
  };
  for (const std::vector<int>& bits :
       std::vector<std::vector<int>>{{8}, {16}, {32}, {64}, {8, 16, 32}, {32, 32}, {8, 8, 8, 8, 8, 8, 8, 8}})
    EXPECT_TRUE(errors_of(fcopm_pdo(1, 255, bits)).empty());
  EXPECT_THAT(errors_of(fcopm_pdo(1, 255, {})), ElementsAre("node 3: TxPDO1 has 0 bytes; expected 1 to 8"));
  EXPECT_THAT(errors_of(fcopm_pdo(2, 255, {64, 8})),
              ElementsAre("node 3: TxPDO2 has 9 bytes; expected 1 to 8"));
  EXPECT_THAT(errors_of(fcopm_pdo(1, 255, {24})),
              ElementsAre("node 3: TxPDO1: objects of 8, 16, 32 and 64 bits can be mapped"));
  for (const std::uint8_t type : std::vector<std::uint8_t>{0, 1, 240, 254, 255})
    EXPECT_TRUE(errors_of(fcopm_pdo(1, type, {8})).empty());
  for (const std::uint8_t type : std::vector<std::uint8_t>{241, 252, 253})
    EXPECT_EQ(errors_of(fcopm_pdo(1, type, {8})).size(), 1U);
  EXPECT_THAT(
      errors_of(fcopm_pdo(5, 255, {8})),
      ElementsAre("node 3: TxPDO5 has no COB-ID of the predefined connection set; cob_id is missing"));
  fcopm::SlavePdo fifth = fcopm_pdo(5, 255, {8});
  fifth.cob_id = 0x1A0;
  EXPECT_TRUE(errors_of(fifth).empty());
  fifth.cob_id = 0x600;
  EXPECT_THAT(errors_of(fifth), ElementsAre("node 3: TxPDO5: COB-ID 600H; expected 181H to 57FH"));
}

TEST(FcopmConfiguration, ThePredefinedConnectionSet) {
  RecordProperty("spec", "ASF-CONN-001 ASF-GEN-012");
  fcopm::Configuration configuration = one_slave(64);
  for (std::uint16_t number = 1; number <= 4; ++number) {
    configuration.slaves[0].tx_pdos.push_back(fcopm_pdo(number, 255, {8}));
    configuration.slaves[0].rx_pdos.push_back(fcopm_pdo(number, 255, {8}));
  }
  ASSERT_TRUE(fcopm::check(configuration).empty());
  const fcopm::Layout layout = fcopm::lay_out(configuration);
  const std::array<std::uint16_t, 4> transmit{0x1C0, 0x2C0, 0x3C0, 0x4C0},
      receive{0x240, 0x340, 0x440, 0x540};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(layout.received[i].cob_id, transmit[i]);
    EXPECT_EQ(layout.sent[i].cob_id, receive[i]);
  }
  configuration.slaves[0].rx_pdos[1].cob_id = 0x1C0;
  EXPECT_THAT(fcopm::check(configuration),
              ElementsAre("node 64: TxPDO1: COB-ID 1C0H is another PDO's already"));
}

TEST(FcopmConfiguration, ProcessDataOf1894Bytes) {
  RecordProperty("spec", "ASF-GEN-006");
  fcopm::Configuration configuration;
  configuration.node_id = 127;
  for (std::uint8_t node = 1; node <= 60; ++node) {
    configuration.slaves.push_back({.node_id = node});
    for (std::uint16_t number = 1; number <= 4; ++number)
      configuration.slaves.back().rx_pdos.push_back(fcopm_pdo(number, 255, {64}));
  }
  EXPECT_THAT(fcopm::check(configuration), ElementsAre("the RxPDOs take 1920 bytes; expected at most 1894"));
  configuration.slaves[59].rx_pdos.resize(1);  // 237 of 8 bytes
  EXPECT_EQ(fcopm::check(configuration).size(), 1U);
  configuration.slaves[59].rx_pdos[0] = fcopm_pdo(1, 255, {32, 16});
  EXPECT_TRUE(fcopm::check(configuration).empty());
  configuration.slaves[59].rx_pdos[0] = fcopm_pdo(1, 255, {32, 16, 8});
  EXPECT_EQ(fcopm::check(configuration).size(), 1U) << "7 bytes take four words";
}

TEST(FcopmConfiguration, AHeartbeatNeedsATimeOut_AndASlaveHasNoNodeList) {
  RecordProperty("spec", "ASF-TOOL-007 ASF-GEN-001");
  fcopm::Configuration configuration = one_slave();
  configuration.slaves[0].heartbeat = 200;
  configuration.slaves[0].heartbeat_time_out = 200;
  EXPECT_EQ(fcopm::check(configuration).size(), 1U);
  configuration.slaves[0].heartbeat_time_out = 201;
  EXPECT_TRUE(fcopm::check(configuration).empty());
  configuration.work_mode = fcopm::WorkMode::slave;
  EXPECT_THAT(fcopm::check(configuration), ElementsAre("a slave has no node list"));
}

TEST(FcopmConfiguration, AFixedMappingIsLeftAlone_TimesAreWrittenWhereTheyAreGiven) {
  RecordProperty("spec", "ASF-PDO-006 ASF-TOOL-006");
  FcopmCard card;
  auto& slave = card.list(3);
  slave.tx_pdos = {fcopm_pdo(2, 254, {16})};
  slave.tx_pdos[0].writes_mapping = false;
  slave.tx_pdos[0].inhibit_time = 100;
  slave.tx_pdos[0].event_timer = 500;
  card.start();
  const std::vector<std::pair<FcopmSlave::Object, Bytes>> expected = {
      {{0x1801, 1}, {0x83, 0x02, 0x00, 0x80}},
      {{0x1801, 2}, {254}},
      {{0x1801, 3}, {100, 0}},
      {{0x1801, 5}, {0xF4, 0x01}},
      {{0x1801, 1}, {0x83, 0x02, 0x00, 0x00}}};
  EXPECT_EQ(card.slaves[3].written, expected);
}

}  // namespace
}  // namespace canopus::scenario::as_fcopm_configuration_test
