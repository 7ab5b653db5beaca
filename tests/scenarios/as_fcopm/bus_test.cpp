// What the master does on the bus by itself: scenarios F, node list, auto SDO [AS-FCOPM 10.3, 10.6].

#include "scenarios/as_fcopm/card.hpp"

namespace canopus::scenario::as_fcopm_bus_test {
namespace {

class FcopmBus : public testing::Test, public FcopmCard {};

std::vector<can::Duration> gaps(const std::vector<can::Time>& times) {
  std::vector<can::Duration> found;
  for (std::size_t i = 1; i < times.size(); ++i) found.push_back(times[i] - times[i - 1]);
  return found;
}

TEST_F(FcopmBus, F01_F02_HeartbeatAndSyncOfTheMaster) {
  RecordProperty("spec",
                 "ASF-CFG-002 ASF-CFG-005 ASF-CFG-006 ASF-HB-001 ASF-HB-004 ASF-SYNC-001 ASF-TOOL-004");
  list(3);
  start();
  run(2s);
  EXPECT_EQ(sent(0x701), std::vector<Bytes>(10, {0x05}));
  EXPECT_EQ(gaps(times(0x701)), std::vector<can::Duration>(9, 200ms));
  EXPECT_EQ(sent(0x080), std::vector<Bytes>(40));
  EXPECT_EQ(gaps(times(0x080)), std::vector<can::Duration>(39, 50ms));
}

TEST_F(FcopmBus, F01_F02_OtherTimesAndAnotherNode) {
  RecordProperty("spec", "ASF-CFG-005 ASF-CFG-006 ASF-HB-001 ASF-TOOL-004");
  configuration.node_id = 99;
  configuration.cycle_period = 7;
  configuration.master_heartbeat = 300;
  list(1);
  start();
  run(2100ms);
  EXPECT_EQ(sent(0x763).size(), 7U);
  EXPECT_EQ(sent(0x080).size(), 300U);
  FcopmCard silent;
  silent.configuration.cycle_period = silent.configuration.master_heartbeat = 0;
  silent.list(3);
  silent.start();
  silent.run(2s);
  EXPECT_TRUE(silent.frames.empty());
}

TEST_F(FcopmBus, F06_NoNodeGuarding_AsMasterAndAsSlave) {
  RecordProperty("spec", "ASF-GEN-011");
  list(3);
  start();
  for (const auto& frame : frames) EXPECT_FALSE(frame.frame.remote);
  forget();
  card.receive(can::remote_frame(0x701, 1), now);
  run(1ms);
  EXPECT_TRUE(sent(0x701).empty());
  FcopmCard slave;
  slave.configuration.work_mode = fcopm::WorkMode::slave;
  slave.start();
  slave.card.receive(can::remote_frame(0x701, 1), slave.now);
  slave.run(10ms);
  EXPECT_TRUE(slave.frames.empty());
}

TEST_F(FcopmBus, TheSlavesHeartbeatIsEnabledByTheMaster) {
  RecordProperty("spec", "ASF-HB-003 ASF-TOOL-007");
  auto& watched = list(64);
  watched.heartbeat = 250;
  watched.heartbeat_time_out = 600;
  list(2);
  start();
  EXPECT_TRUE(slaves[64].was_written(0x1017, 0, {250, 0}));
  EXPECT_TRUE(slaves[2].written.empty());
}

TEST_F(FcopmBus, TwentyAutoSdosBeforeTheStart_InTheirOrder) {
  RecordProperty("spec", "ASF-SDO-006");
  auto& slave = list(3);
  slave.tx_pdos = {fcopm_pdo(1, 255, {16})};
  for (std::uint8_t i = 0; i < 20; ++i) slave.auto_sdos.push_back({0x2100, i, Bytes(i % 2 + 1U, i)});
  slave.auto_sdos[7].value = {1, 2, 3, 4};
  ASSERT_TRUE(fcopm::check(configuration).empty());
  power_on();
  while (slaves[3].written.size() < 10) run(100us);
  run(2s);
  std::vector<std::pair<FcopmSlave::Object, Bytes>> last(slaves[3].written.end() - 20,
                                                         slaves[3].written.end());
  for (std::uint8_t i = 0; i < 20; ++i) {
    EXPECT_EQ(last[i].first, (FcopmSlave::Object{0x2100, i}));
    EXPECT_EQ(last[i].second, slave.auto_sdos[i].value);
  }
  // The start comes after the last of them.
  std::size_t start_at = 0, last_at = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].frame.identifier == 0 && frames[i].frame.data[0] == 1) start_at = i;
    if (frames[i].frame.identifier == 0x603) last_at = i;
  }
  EXPECT_GT(start_at, last_at);
  EXPECT_EQ(slaves[3].state, 0x05);
  slave.auto_sdos.push_back({0x2100, 21, {1}});
  EXPECT_EQ(fcopm::check(configuration).size(), 1U);
}

TEST_F(FcopmBus, E05_AutoSdosAreDoneAtEachStartOfTheSlave) {
  RecordProperty("spec", "ASF-SDO-006 ASF-NMT-005");
  auto& slave = list(3);
  slave.auto_sdos = {{0x2100, 0, {1}}};
  start();
  slaves[3].written.clear();
  receive(0x703, {0x00});  // it has restarted by itself
  run(5s);
  EXPECT_TRUE(slaves[3].was_written(0x2100, 0, {1}));
  EXPECT_EQ(slaves[3].state, 0x05);
}

TEST_F(FcopmBus, TheMasterAloneCommands) {
  RecordProperty("spec", "ASF-NMT-006");
  list(3);
  start();
  receive(0x000, {0x02, 0x00});
  run(1s);
  EXPECT_EQ(card.node().state(), canopen::NmtState::operational);
  EXPECT_EQ(sent(0x080).size(), 20U);
}

TEST_F(FcopmBus, TheObjectsOfTheMasterCanBeRead) {
  RecordProperty("spec", "ASF-OD-002 ASF-GEN-002 ASF-SDO-005");
  list(3);
  start();
  receive(0x601, {0x40, 0x18, 0x10, 1, 0, 0, 0, 0});
  EXPECT_EQ(sent(0x581), (std::vector<Bytes>{{0x43, 0x18, 0x10, 1, 0xDD, 0x01, 0, 0}}));
}

TEST_F(FcopmBus, ARequestBeforeTheStartWaitsForNothing_OneInTheMiddleOfABootTakesItsTurn) {
  RecordProperty("spec", "ASF-SDO-005 ASF-REQ-010");
  auto& slave = list(3);
  for (std::uint8_t i = 0; i < 20; ++i) slave.auto_sdos.push_back({0x2100, i, {i}});
  slaves[3].objects[{0x3000, 0}] = {0x11, 0x22};
  power_on();
  while (slaves[3].written.empty()) run(100us);
  request({0x0101, 4, 0x0103, 0x3000, 0}, 1s);
  EXPECT_EQ(response(6), (Words{0x0101, 6, 0x4B03, 0x3000, 0, 0x2211}));
  EXPECT_EQ(slaves[3].written.size(), 20U);
}

}  // namespace
}  // namespace canopus::scenario::as_fcopm_bus_test
