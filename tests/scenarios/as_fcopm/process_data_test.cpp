// Process data of the master: scenarios E, and what 10.6 and 10.1 say of PDOs.

#include "scenarios/as_fcopm/card.hpp"

namespace canopus::scenario::as_fcopm_process_data_test {
namespace {

class FcopmProcessData : public testing::Test, public FcopmCard {
 protected:
  /// The servo of 10.6 at node 3.
  void list_servo() {
    auto& servo = list(3);
    servo.rx_pdos = {{.number = 1, .type = 255, .objects = {{0x2109, 0, 32}}},
                     {.number = 2, .type = 255, .objects = {{0x2306, 0, 16}, {0x2407, 0, 16}}}};
    servo.tx_pdos = {{.number = 1, .type = 1, .objects = {{0x2009, 0, 32}}}};
  }
};

TEST_F(FcopmProcessData, E01_TheServoIsConfiguredAndStarted) {
  RecordProperty("spec", "ASF-GEN-001 ASF-GEN-012 ASF-CONN-001 ASF-TOOL-006 ASF-CFG-004 ASF-PDO-016");
  list_servo();
  power_on();
  run(5s);
  const std::vector<std::pair<FcopmSlave::Object, Bytes>> expected = {
      {{0x1400, 1}, {0x03, 0x02, 0x00, 0x80}},
      {{0x1400, 2}, {255}},
      {{0x1600, 0}, {0}},
      {{0x1600, 1}, {0x20, 0x00, 0x09, 0x21}},
      {{0x1600, 0}, {1}},
      {{0x1400, 1}, {0x03, 0x02, 0x00, 0x00}},
      {{0x1401, 1}, {0x03, 0x03, 0x00, 0x80}},
      {{0x1401, 2}, {255}},
      {{0x1601, 0}, {0}},
      {{0x1601, 1}, {0x10, 0x00, 0x06, 0x23}},
      {{0x1601, 2}, {0x10, 0x00, 0x07, 0x24}},
      {{0x1601, 0}, {2}},
      {{0x1401, 1}, {0x03, 0x03, 0x00, 0x00}},
      {{0x1800, 1}, {0x83, 0x01, 0x00, 0x80}},
      {{0x1800, 2}, {1}},
      {{0x1A00, 0}, {0}},
      {{0x1A00, 1}, {0x20, 0x00, 0x09, 0x20}},
      {{0x1A00, 0}, {1}},
      {{0x1800, 1}, {0x83, 0x01, 0x00, 0x00}}};
  EXPECT_EQ(slaves[3].written, expected);
  EXPECT_EQ(sent(0x000).back(), (Bytes{0x01, 0x03}));
  EXPECT_EQ(slaves[3].state, 0x05);
}

TEST_F(FcopmProcessData, E02_E03_TheServoIsDriven) {
  RecordProperty("spec",
                 "ASF-PDO-005 ASF-PDO-007 ASF-PDO-016 ASF-PDO-017 ASF-PDO-004 ASF-GEN-012 ASF-PDO-014");
  list_servo();
  start();
  set_d(25034, 0x000F);
  run(2ms);
  EXPECT_EQ(sent(0x303), (std::vector<Bytes>{{0x0F, 0, 0, 0}}));
  EXPECT_TRUE(sent(0x203).empty());
  set_d(25032, 256);
  run(2ms);
  EXPECT_EQ(sent(0x203), (std::vector<Bytes>{{0, 1, 0, 0}}));
  set_d(25035, 5);
  run(2ms);
  EXPECT_EQ(sent(0x303).back(), (Bytes{0x0F, 0, 5, 0}));
  set_d(25033, 0x1234);
  run(2ms);
  EXPECT_EQ(sent(0x203).back(), (Bytes{0, 1, 0x34, 0x12})) << "low word first";
  forget();
  set_d(25032, 256);
  set_d(25036, 77);  // of no PDO
  run(1s);
  EXPECT_TRUE(sent(0x203).empty()) << "no change, no frame";
  EXPECT_TRUE(sent(0x303).empty());
  receive(0x183, {0x78, 0x56, 0x34, 0x12});
  EXPECT_EQ(d(24032), 0x5678U) << "at once";
  EXPECT_EQ(d(24033), 0x1234U);
  EXPECT_EQ(d(24034), 0U);
}

TEST_F(FcopmProcessData, WordsOfOneScanGoOutTogether_AndAreReadBack) {
  RecordProperty("spec", "ASF-PDO-005 ASF-PDO-017");
  list_servo();
  start();
  set_d(25032, 1);
  set_d(25033, 2);
  EXPECT_EQ(d(25032), 1U);
  EXPECT_TRUE(sent(0x203).empty());
  run(2ms);
  EXPECT_EQ(sent(0x203), (std::vector<Bytes>{{1, 0, 2, 0}}));
}

TEST_F(FcopmProcessData, E04_RxPdosByType) {
  RecordProperty("spec", "ASF-PDO-001 ASF-PDO-003 ASF-PDO-005 ASF-PDO-007");
  auto& slave = list(9);
  const std::array<std::uint8_t, 5> types{0, 1, 10, 254, 255};
  for (std::uint16_t i = 0; i < types.size(); ++i) {
    slave.rx_pdos.push_back(fcopm_pdo(static_cast<std::uint16_t>(i + 1), types[i], {16}));
    slave.rx_pdos.back().cob_id = static_cast<std::uint16_t>(0x210 + i);
  }
  start();
  run(1s);
  EXPECT_EQ(sent(0x080).size(), 20U);
  EXPECT_EQ(sent(0x211).size(), 20U) << "each SYNC, changed or not";
  EXPECT_EQ(sent(0x212).size(), 2U) << "each tenth";
  EXPECT_TRUE(sent(0x210).empty() && sent(0x213).empty() && sent(0x214).empty());
  const can::Time written = now;
  for (std::uint32_t word = 25032; word < 25037; ++word) set_d(word, 0x0102);
  run(2ms);
  for (const std::uint32_t id : {0x210U, 0x213U, 0x214U}) {
    EXPECT_EQ(sent(id), (std::vector<Bytes>{{2, 1}})) << id;
    EXPECT_LE(times(id).front(), written + 1ms);
  }
  EXPECT_EQ(sent(0x211).size(), 20U) << "not before the SYNC";
  run(1s);
  EXPECT_EQ(sent(0x211).back(), (Bytes{2, 1}));
  EXPECT_EQ(sent(0x212).back(), (Bytes{2, 1}));
  EXPECT_EQ(sent(0x212).size(), 4U);
  EXPECT_EQ(sent(0x210).size(), 1U);
}

TEST_F(FcopmProcessData, PdosAreThereInOperationalAlone) {
  RecordProperty("spec", "ASF-PDO-009 ASF-NMT-004");
  list_servo();
  power_on();
  set_d(25032, 7);
  while (slaves[3].state != 0x05) {
    EXPECT_TRUE(sent(0x203).empty());
    run(1ms);
  }
  run(2ms);
  EXPECT_EQ(sent(0x203), (std::vector<Bytes>{{7, 0, 0, 0}})) << "written before: it has changed";
  request({0x0101, 4, 0x0303, 0x80, 3});
  forget();
  set_d(25032, 8);
  run(1s);
  EXPECT_TRUE(sent(0x203).empty()) << "the slave is Pre-operational";
  request({0x0201, 4, 0x0303, 0x01, 3});
  run(2ms);
  EXPECT_EQ(sent(0x203), (std::vector<Bytes>{{8, 0, 0, 0}}));
  slaves[3].answers = false;
  request({0x0301, 4, 0x0303, 0x81, 3});
  run(3s);
  forget();
  set_d(25032, 9);
  run(1s);
  EXPECT_TRUE(sent(0x203).empty()) << "it boots";
  slaves[3].answers = true;
  run(5s);
  EXPECT_EQ(sent(0x203), (std::vector<Bytes>{{9, 0, 0, 0}}));
}

TEST_F(FcopmProcessData, ASlaveThatRestartsGetsItsValuesAgain) {
  RecordProperty("spec", "ASF-PDO-005");
  list_servo();
  start();
  set_d(25032, 7);
  run(5ms);
  forget();
  request({0x0101, 4, 0x0303, 0x81, 3});
  run(5s);
  EXPECT_EQ(sent(0x203), (std::vector<Bytes>{{7, 0, 0, 0}}));
  EXPECT_TRUE(sent(0x303).empty()) << "zeros are what it has";
}

TEST_F(FcopmProcessData, WhatAWatchedSlaveMissedWhileItWasStopped_ComesWithItsStart) {
  RecordProperty("spec", "ASF-PDO-005 ASF-PDO-009");
  for (const std::uint16_t value : std::vector<std::uint16_t>{7, 0}) {
    FcopmCard other;
    auto& slave = other.list(3);
    slave.rx_pdos = {fcopm_pdo(1, 255, {16}), fcopm_pdo(2, 255, {16})};
    slave.heartbeat = 200;
    slave.heartbeat_time_out = 500;
    other.start();
    other.set_d(25032, 5);
    other.run(100ms);
    other.request({0x0101, 4, 0x0303, 2, 3});
    other.set_d(25032, value);  // the next heartbeat is still to come
    other.run(1s);
    other.forget();
    other.request({0x0201, 4, 0x0303, 1, 3}, 300ms);
    EXPECT_EQ(other.sent(0x203), (std::vector<Bytes>{{static_cast<std::uint8_t>(value), 0}}));
    EXPECT_TRUE(other.sent(0x303).empty()) << "never written";
  }
}

TEST_F(FcopmProcessData, EachPdoBeginsWithAWord_InTheOrderOfTheNodeList) {
  RecordProperty("spec", "ASF-PDO-016 ASF-GEN-009 ASF-PDO-010");
  auto& second = list(20);
  second.tx_pdos = {fcopm_pdo(1, 255, {8}), fcopm_pdo(2, 255, {8, 16})};
  second.rx_pdos = {fcopm_pdo(1, 255, {8, 8, 8})};
  auto& first = list(4);
  first.tx_pdos = {fcopm_pdo(1, 255, {64}), fcopm_pdo(4, 255, {32, 32})};
  first.rx_pdos = {fcopm_pdo(2, 255, {64})};
  start();
  receive(0x194, {0xA1});
  receive(0x294, {0xB1, 0xB2, 0xB3});
  receive(0x184, {1, 2, 3, 4, 5, 6, 7, 8});
  receive(0x484, {9, 10, 11, 12, 13, 14, 15, 16});
  Words words;
  for (std::uint32_t word = 24032; word < 24044; ++word) words.push_back(d(word));
  EXPECT_EQ(words, (Words{0x00A1, 0xB2B1, 0x00B3, 0x0201, 0x0403, 0x0605, 0x0807, 0x0A09, 0x0C0B, 0x0E0D,
                          0x100F, 0}));
  for (std::uint32_t i = 0; i < 6; ++i) set_d(25032 + i, static_cast<std::uint16_t>(0x1100 * (i + 1) + i));
  run(2ms);
  EXPECT_EQ(sent(0x214), (std::vector<Bytes>{{0x00, 0x11, 0x01}}));
  EXPECT_EQ(sent(0x304), (std::vector<Bytes>{{0x02, 0x33, 0x03, 0x44, 0x04, 0x55, 0x05, 0x66}}));
}

TEST_F(FcopmProcessData, TheMostThatThereCanBe) {
  RecordProperty("spec", "ASF-GEN-004 ASF-GEN-006 ASF-GEN-007 ASF-PDO-010");
  configuration.node_id = 127;
  for (std::uint8_t node = 1; node <= 64; ++node) {
    auto& slave = list(node);
    for (std::uint16_t number = 1; number <= 4; ++number) {
      // 236 of 8 bytes and 1 of 6 are 1894 bytes; the rest cannot have any.
      const unsigned before = (node - 1U) * 4U + number - 1U;
      if (before > 236) continue;
      const std::vector<int> bits = before == 236 ? std::vector<int>{32, 16} : std::vector<int>{64};
      slave.rx_pdos.push_back(fcopm_pdo(number, 255, bits));
      slave.tx_pdos.push_back(fcopm_pdo(number, 255, bits));
    }
  }
  ASSERT_TRUE(fcopm::check(configuration).empty());
  start(8s);
  for (unsigned node = 1; node <= 64; ++node)
    ASSERT_EQ(slaves[static_cast<std::uint8_t>(node)].state, 0x05) << node;
  receive(0x1BC, {0xEE, 1, 2, 3, 4, 5, 6, 7});  // TxPDO1 of node 60: the last one
  EXPECT_EQ(code(60), 0xE1U) << "it has six bytes";
  receive(0x1BC, {1, 2, 3, 4, 5, 6});
  EXPECT_EQ(d(24976), 0x0201U);
  EXPECT_EQ(d(24978), 0x0605U);
  set_d(25978, 0xBEEF);
  run(2ms);
  EXPECT_EQ(sent(0x23C), (std::vector<Bytes>{{0, 0, 0, 0, 0xEF, 0xBE}}));
  const auto ranges = card.registers()->registers();
  EXPECT_EQ(ranges[2].last, 24978U);
  EXPECT_EQ(ranges[3].last, 25978U);
}

TEST_F(FcopmProcessData, TwoHundredAndFiftySixPdosEachWay) {
  RecordProperty("spec", "ASF-GEN-006");
  configuration.node_id = 127;
  for (std::uint8_t node = 1; node <= 64; ++node) {
    auto& slave = list(node);
    for (std::uint16_t number = 1; number <= 4; ++number) {
      slave.rx_pdos.push_back(fcopm_pdo(number, 255, {16}));
      slave.tx_pdos.push_back(fcopm_pdo(number, 255, {16}));
    }
  }
  ASSERT_TRUE(fcopm::check(configuration).empty());
  start(8s);
  receive(0x4C0, {0xCD, 0xAB});
  EXPECT_EQ(d(24287), 0xABCDU) << "TxPDO4 of node 64";
  set_d(25287, 0x1234);
  run(2ms);
  EXPECT_EQ(sent(0x540), (std::vector<Bytes>{{0x34, 0x12}}));
  configuration.slaves[5].tx_pdos.push_back(fcopm_pdo(5, 255, {16}));
  configuration.slaves[5].tx_pdos.back().cob_id = 0x5FF - 0x80;
  EXPECT_EQ(fcopm::check(configuration).size(), 1U) << "257 TxPDOs";
}

TEST_F(FcopmProcessData, NoPdoOfTheMasterCanBeAskedFor) {
  RecordProperty("spec", "ASF-PDO-008");
  list_servo();
  start();
  for (const std::uint32_t id : {0x203U, 0x303U, 0x183U, 0x701U}) card.receive(can::remote_frame(id, 4), now);
  run(1ms);
  EXPECT_TRUE(sent(0x203).empty() && sent(0x303).empty() && sent(0x183).empty());
}

TEST_F(FcopmProcessData, InputWordsAreReadOnly) {
  RecordProperty("spec", "ASF-REQ-002");
  list_servo();
  start();
  for (const std::uint32_t word : {24000U, 24031U, 24032U, 24978U}) {
    set_d(word, 0x1234);
    run(1ms);
    EXPECT_EQ(d(word), 0U) << word;
  }
  EXPECT_EQ(card.read_register(module::RegisterKind::special, 24032, now), 0U);
}

}  // namespace
}  // namespace canopus::scenario::as_fcopm_process_data_test
