// The status registers: scenarios D of spec/as-fcopm/scenarios.md [AS-FCOPM 10.5.1].

#include "scenarios/as_fcopm/card.hpp"

namespace canopus::scenario::as_fcopm_status_test {
namespace {

class FcopmStatus : public testing::Test, public FcopmCard {};

TEST_F(FcopmStatus, D01_AllSlavesRun) {
  RecordProperty("spec", "ASF-SR-001 ASF-SR-003 ASF-SR-004 ASF-SR-006 ASF-SR-007");
  list(1 + 1);
  list(3);
  list(64);
  start();
  EXPECT_EQ(sr(821), 402U);
  EXPECT_EQ(sr(825), 0U);
  for (std::uint32_t number = 826; number <= 893; ++number) EXPECT_EQ(sr(number), 0U) << number;
  EXPECT_EQ(card.node().state(), canopen::NmtState::operational);
  receive(0x083, {1, 0x10, 1, 0, 0, 0, 0, 0});
  receive(0x085, {1, 0x10, 1, 0, 0, 0, 0, 0});
  EXPECT_EQ(code(3), 0xE0U);
  EXPECT_EQ(code(5), 0U) << "not in the node list";
  EXPECT_EQ(sr(826), 1U << 2);
}

TEST_F(FcopmStatus, D02_ASlaveThatIsNotThere_AndComesLater) {
  RecordProperty("spec", "ASF-SRN-007 ASF-SR-004 ASF-SR-005 ASF-SR-006");
  for (const std::uint8_t node : std::vector<std::uint8_t>{1, 16, 17, 33, 48, 64}) list(node).heartbeat = 0;
  configuration.node_id = 100;
  for (auto& [node, slave] : slaves) slave.is_there = false;
  start();
  for (unsigned node = 1; node <= 64; ++node) {
    const bool is_listed = slaves.contains(static_cast<std::uint8_t>(node));
    EXPECT_EQ(code(static_cast<std::uint8_t>(node)), is_listed ? 0xE6U : 0U) << node;
  }
  EXPECT_EQ((Words{sr(826), sr(827), sr(828), sr(829)}), (Words{0x8001, 0x0001, 0x8001, 0x8000}));
  EXPECT_EQ(sr(893), 0xE6U);
  slaves[17].is_there = true;
  run(5s);
  EXPECT_EQ(code(17), 0U);
  EXPECT_EQ(sr(827), 0U);
  EXPECT_EQ(slaves[17].state, 0x05) << "it was started";
  EXPECT_EQ(code(16), 0xE6U);
}

TEST_F(FcopmStatus, D03_APdoOfAnotherLength) {
  RecordProperty("spec", "ASF-SRN-002 ASF-PDO-011");
  list(3).tx_pdos = {fcopm_pdo(1, 255, {64}), fcopm_pdo(2, 255, {16})};
  start();
  receive(0x183, {1, 2, 3, 4, 5, 6});
  EXPECT_EQ(code(3), 0xE1U);
  EXPECT_TRUE(is_abnormal(3));
  EXPECT_EQ(d(24032), 0U) << "too short: not taken";
  receive(0x283, {1, 2});
  EXPECT_EQ(code(3), 0xE1U) << "the other PDO is good, this one is not";
  receive(0x183, {1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_EQ(code(3), 0U);
  receive(0x283, {1, 2, 3});
  EXPECT_EQ(code(3), 0xE1U) << "longer is wrong, too";
  receive(0x283, {1, 2, 3});
  EXPECT_EQ(code(3), 0xE1U);
  receive(0x283, {1, 2});
  EXPECT_EQ(code(3), 0U);
  EXPECT_FALSE(is_abnormal(3));
}

TEST_F(FcopmStatus, D03_APdoThatDoesNotCome) {
  RecordProperty("spec", "ASF-SRN-003 ASF-PDO-012");
  auto& slave = list(3);
  slave.tx_pdos = {fcopm_pdo(1, 4, {64}), fcopm_pdo(2, 255, {16}), fcopm_pdo(3, 255, {8})};
  slave.tx_pdos[1].event_timer = 500;
  power_on();
  while (slaves[3].state != 0x05) run(1ms);
  const auto keep = [&](can::Duration time) {
    for (const can::Time end = now + time; now < end; run(200ms)) {
      receive(0x183, {1, 2, 3, 4, 5, 6, 7, 8});
      receive(0x283, {1, 2});
    }
  };
  keep(3s);
  EXPECT_EQ(code(3), 0U) << "PDO 3 need not come: nobody knows when";
  receive(0x183, {1, 2, 3, 4, 5, 6, 7, 8});  // type 4, SYNC 50 ms: every 200 ms
  receive(0x283, {1, 2});
  run(599ms);
  EXPECT_EQ(code(3), 0U);
  run(2ms);
  EXPECT_EQ(code(3), 0xE2U) << "three times missed";
  EXPECT_TRUE(is_abnormal(3));
  receive(0x183, {1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_EQ(code(3), 0U);
  for (int i = 0; i < 2; ++i) {
    run(400ms);
    receive(0x183, {1, 2, 3, 4, 5, 6, 7, 8});
  }
  EXPECT_EQ(code(3), 0U);
  run(400ms);
  EXPECT_EQ(code(3), 0xE2U) << "PDO 2, by its event timer";
  request({0x0101, 4, 0x0303, 2, 3});  // a stopped slave sends none
  run(5s);
  EXPECT_EQ(code(3), 0U);
}

TEST_F(FcopmStatus, D03_AnAutoSdoThatIsRefused) {
  RecordProperty("spec", "ASF-SRN-004 ASF-SDO-006");
  for (const std::uint32_t abort_code : {0x06020000U, 0x06010002U}) {  // the second: a read-only object
    FcopmCard other;
    auto& slave = other.list(3);
    slave.tx_pdos = {fcopm_pdo(1, 255, {16})};
    slave.auto_sdos = {{0x2100, 1, {5}}, {0x2200, 2, {1, 2}}, {0x2300, 3, {9}}};
    FcopmSlave& there = other.slaves[3];
    there.refused[{0x2200, 2}] = abort_code;
    other.start();
    EXPECT_EQ(other.code(3), 0xE3U) << std::hex << abort_code;
    EXPECT_TRUE(other.is_abnormal(3));
    EXPECT_EQ(there.state, 0x7F) << "not started";
    EXPECT_FALSE(there.was_written(0x2300, 3, {9})) << "those behind it are left out";
    there.refused.clear();
    other.request({0x0101, 4, 0x0303, 0x81, 3});
    other.run(3s);
    EXPECT_EQ(other.code(3), 0U);
    EXPECT_EQ(there.state, 0x05);
  }
}

// What its PDOs carry is not what the registers are for: another object, or the same at another place.
TEST_F(FcopmStatus, ASlaveThatWasNotConfigured_IsShownByItsCodeAlone) {
  RecordProperty("spec", "ASF-PDO-018 ASF-SRN-004 ASF-SRN-005");
  for (const FcopmSlave::Object& object :
       std::vector<FcopmSlave::Object>{{0x1A00, 1}, {0x1A00, 0}, {0x1800, 2}, {0x1600, 1}, {0x2100, 1}}) {
    FcopmCard other;
    auto& slave = other.list(64);
    slave.rx_pdos = {fcopm_pdo(1, 255, {16})};
    slave.tx_pdos = {fcopm_pdo(1, 255, {16})};
    slave.auto_sdos = {{0x2100, 1, {5}}};
    FcopmSlave& there = other.slaves[64];
    there.refused[object] = 0x06010002;
    other.start();
    const std::uint16_t code = object.first == 0x2100 ? 0xE3U : 0xE4U;
    EXPECT_EQ(other.code(64), code) << std::hex << object.first;
    // The program starts it all the same, and it sends.
    other.request({0x0101, 4, 0x0340, 0x01, 64});
    EXPECT_EQ(there.state, 0x05);
    other.receive(0x1C0, {0x34, 0x12});
    EXPECT_EQ(other.d(24032), 0U) << std::hex << object.first;
    other.receive(0x1C0, {1, 2, 3});  // nor is its length judged
    EXPECT_EQ(other.code(64), code);
    other.forget();
    other.set_d(25032, 0x5678);
    other.run(1s);
    EXPECT_TRUE(other.sent(0x240).empty()) << "it would write another object";
    // Configured, it is one of the network.
    there.refused.clear();
    other.request({0x0201, 4, 0x0340, 0x81, 64});
    other.run(3s);
    EXPECT_EQ(other.code(64), 0U);
    EXPECT_EQ(other.sent(0x240), (std::vector<Bytes>{{0x78, 0x56}}));
    other.receive(0x1C0, {0x34, 0x12});
    EXPECT_EQ(other.d(24032), 0x1234U);
  }
}

TEST_F(FcopmStatus, D03_APdoParameterThatIsRefused) {
  RecordProperty("spec", "ASF-SRN-005 ASF-PDO-013");
  for (const FcopmSlave::Object& object :
       std::vector<FcopmSlave::Object>{{0x1400, 2}, {0x1600, 1}, {0x1801, 1}, {0x1A01, 0}, {0x1801, 5}})
    for (const std::uint32_t abort_code : {0x06090030U, 0x06010002U}) {
      FcopmCard other;
      auto& slave = other.list(64);
      slave.rx_pdos = {fcopm_pdo(1, 255, {16})};
      slave.tx_pdos = {fcopm_pdo(2, 255, {16})};
      slave.tx_pdos[0].event_timer = 100;
      slave.auto_sdos = {{0x2100, 1, {5}}};
      other.slaves[64].refused[object] = abort_code;
      other.start();
      EXPECT_EQ(other.code(64), 0xE4U) << std::hex << object.first;
      EXPECT_EQ(other.slaves[64].state, 0x7F);
      EXPECT_TRUE(other.is_abnormal(64));
      EXPECT_FALSE(other.slaves[64].was_written(0x2100, 1, {5}));
    }
}

TEST_F(FcopmStatus, D03_AnotherDeviceThanConfigured) {
  RecordProperty("spec", "ASF-SRN-006");
  const auto number = [](std::uint8_t low) { return Bytes{low, 0, 0, 0}; };
  for (const int wrong : {-1, 0, 1, 2, 3}) {
    FcopmCard other;
    auto& slave = other.list(17);
    slave.device_type = 0x10;
    slave.vendor = 0x11;
    slave.product = 0x12;
    slave.revision = 0x13;
    auto& objects = other.slaves[17].objects;
    objects[{0x1000, 0}] = number(wrong == 0 ? 0x99 : 0x10);
    objects[{0x1018, 1}] = number(wrong == 1 ? 0x99 : 0x11);
    objects[{0x1018, 2}] = number(wrong == 2 ? 0x99 : 0x12);
    objects[{0x1018, 3}] = number(wrong == 3 ? 0x99 : 0x13);
    other.start();
    EXPECT_EQ(other.code(17), wrong < 0 ? 0U : 0xE5U) << wrong;
    EXPECT_EQ(other.is_abnormal(17), wrong >= 0);
    EXPECT_EQ(other.slaves[17].state, wrong < 0 ? 0x05 : 0x7F);
  }
}

TEST_F(FcopmStatus, D03_AHeartbeatThatStops) {
  RecordProperty("spec", "ASF-SRN-008 ASF-HB-002 ASF-HB-003 ASF-SR-004");
  auto& watched = list(3);
  watched.heartbeat = 200;
  watched.heartbeat_time_out = 500;
  list(4);
  start();
  EXPECT_TRUE(slaves[3].was_written(0x1017, 0, {200, 0}));
  EXPECT_TRUE(slaves[4].written.empty()) << "no error control";
  EXPECT_EQ(code(3), 0U);
  slaves[3].is_there = slaves[4].is_there = false;
  run(250ms);
  EXPECT_EQ(code(3), 0U) << "not yet";
  run(500ms);
  EXPECT_EQ(code(3), 0xE7U);
  EXPECT_TRUE(is_abnormal(3));
  run(20s);
  EXPECT_EQ(code(3), 0xE7U) << "it stays the reason";
  EXPECT_EQ(code(4), 0U) << "without a heartbeat nobody knows";
  slaves[3].is_there = true;
  run(10s);
  EXPECT_EQ(code(3), 0U);
  EXPECT_EQ(slaves[3].state, 0x05);
}

TEST_F(FcopmStatus, D03_ASlaveThatNeverBeats_OrRefusesTo) {
  RecordProperty("spec", "ASF-SRN-008");
  for (const bool refuses : {true, false}) {
    FcopmCard other;
    auto& slave = other.list(3);
    slave.heartbeat = 100;
    slave.heartbeat_time_out = 300;
    other.slaves[3].beats = false;
    if (refuses) other.slaves[3].refused[{0x1017, 0}] = 0x06020000;
    other.start();
    EXPECT_EQ(other.code(3), 0xE7U) << refuses;
  }
}

TEST_F(FcopmStatus, D03_TheMastersNodeIdTwice) {
  RecordProperty("spec", "ASF-SRN-009");
  list(3);
  start();
  receive(0x701, {0x05});
  EXPECT_EQ(code(1), 0xE8U);
  EXPECT_TRUE(is_abnormal(1));
  EXPECT_EQ(code(3), 0U);
  FcopmCard other;
  other.configuration.node_id = 5;
  other.list(5);
  other.list(6);
  other.start();
  EXPECT_EQ(other.code(5), 0xE8U) << "in the node list";
  EXPECT_EQ(other.code(6), 0U);
}

TEST_F(FcopmStatus, AnEmergencyGoesWithItsEnd_OrWithTheSlavesRestart) {
  RecordProperty("spec", "ASF-SRN-001 ASF-EMCY-002 ASF-EMCY-005");
  list(16);
  start();
  receive(0x090, {1, 0x10, 1, 0, 0, 0, 0, 0});
  EXPECT_EQ(sr(845), 0xE0U);
  EXPECT_TRUE(is_abnormal(16));
  receive(0x090, {0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(sr(845), 0U);
  EXPECT_FALSE(is_abnormal(16));
  receive(0x090, {1, 0x10, 1, 0, 0, 0, 0, 0});
  receive(0x710, {0x00});
  EXPECT_EQ(sr(845), 0U) << "it starts anew";
}

TEST_F(FcopmStatus, TwoCausesAtOnce_TheGraverIsShown_TheOtherStays) {
  RecordProperty("spec", "ASF-SRN-001 ASF-SRN-002 ASF-SRN-008");
  auto& slave = list(3);
  slave.tx_pdos = {fcopm_pdo(1, 255, {64})};
  slave.heartbeat = 100;
  slave.heartbeat_time_out = 300;
  start();
  receive(0x083, {1, 0x10, 1, 0, 0, 0, 0, 0});
  receive(0x183, {1});
  EXPECT_EQ(code(3), 0xE1U);
  receive(0x183, {1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_EQ(code(3), 0xE0U);
  slaves[3].is_there = false;
  run(1s);
  EXPECT_EQ(code(3), 0xE7U);
  slaves[3].is_there = true;
  run(5s);
  EXPECT_EQ(code(3), 0xE0U) << "the heartbeat is back, the emergency is not over";
  receive(0x083, {0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(code(3), 0U);
}

}  // namespace
}  // namespace canopus::scenario::as_fcopm_status_test
