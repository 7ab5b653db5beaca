// What SR825 shows as master, and the registers beside it: scenarios D-04 and D-06 [AS-FCOPM 10.5.1].

#include "scenarios/as_fcopm/card.hpp"

namespace canopus::scenario::as_fcopm_own_state_test {
namespace {

class FcopmOwnState : public testing::Test, public FcopmCard {};

TEST_F(FcopmOwnState, D04_NodesOutsideOfTheNodeList) {
  RecordProperty("spec", "ASF-SRM-001 ASF-TOOL-008");
  list(3);
  start();
  EXPECT_EQ(sr(825), 0U);
  receive(0x704, {0x7F});
  EXPECT_EQ(sr(825), 0xF1U);
  EXPECT_EQ(code(4), 0U);
  FcopmCard empty;
  empty.start();
  EXPECT_EQ(empty.sr(825), 0xF1U) << "an empty node list";
  FcopmCard far;
  far.list(3);
  far.start();
  far.receive(0x741, {0x00});
  EXPECT_EQ(far.sr(825), 0xF1U) << "node 65 cannot be in it";
}

TEST_F(FcopmOwnState, D04_BusOffStaysUntilTheReboot) {
  RecordProperty("spec", "ASF-SRM-004");
  list(3);
  start();
  receive(0x704, {0x7F});
  bus.transmit_errors = 256;
  card.controller_changed(now);
  EXPECT_EQ(sr(825), 0xF4U);
  bus.transmit_errors = 0;
  card.controller_changed(now);
  run(5s);
  EXPECT_EQ(sr(825), 0xF4U);
  card.power_off(now);
  EXPECT_EQ(sr(825), 0U);
  card.power_on(now);
  run(5s);
  EXPECT_EQ(sr(825), 0U);
}

TEST_F(FcopmOwnState, D04_FullBuffers) {
  RecordProperty("spec", "ASF-SRM-007 ASF-SRM-008");
  list(3);
  start();
  bus.lost = 1;
  run(1s);
  EXPECT_EQ(sr(825), 0xFCU);
  bus.accepts = false;
  run(1s);
  EXPECT_EQ(sr(825), 0xFBU);
  bus.accepts = true;
  run(1s);
  EXPECT_EQ(sr(825), 0xFBU) << "until the reboot";
}

TEST_F(FcopmOwnState, D04_ADownloadRuns) {
  RecordProperty("spec", "ASF-SRM-002 ASF-CFG-010 ASF-CFG-009 ASF-TOOL-005");
  list(3);
  start();
  fcopm::Configuration next = configuration;
  next.node_id = 7;
  next.cycle_period = 20;
  next.slaves[0].auto_sdos = {{0x2100, 0, {1}}};
  card.download(next, now);
  EXPECT_EQ(sr(825), 0xF2U);
  run(1s);
  EXPECT_EQ(sr(825), 0xF2U);
  run(2s);
  EXPECT_EQ(sr(825), 0U);
  forget();
  run(1s);
  EXPECT_EQ(sent(0x080).size(), 20U) << "still every 50 ms";
  EXPECT_EQ(sent(0x707).size(), 0U);
  request({0x0101, 4, 0x0303, 0x82, 3});
  run(2s);
  EXPECT_FALSE(slaves[3].was_written(0x2100, 0, {1}));
  card.power_off(now);
  card.power_on(now);
  run(5s);
  EXPECT_TRUE(slaves[3].was_written(0x2100, 0, {1})) << "rebooted";
  EXPECT_EQ(card.node().node_id(), 7);
  forget();
  run(1s);
  EXPECT_EQ(sent(0x080).size(), 50U);
  card.download(configuration, now);
  run(1s);
  card.power_off(now);  // in the middle of it
  card.power_on(now);
  run(5s);
  EXPECT_EQ(card.node().node_id(), 7) << "what was there before";
  EXPECT_EQ(sr(825), 0U);
}

TEST_F(FcopmOwnState, D04_SettingsThatAreNone) {
  RecordProperty("spec", "ASF-SRM-005 ASF-CFG-007");
  for (const unsigned node : {0U, 128U, 1U, 127U}) {
    FcopmCard other;
    other.configuration.node_id = node;
    other.list(3);
    other.card.download(other.configuration);
    other.card.power_on(other.now);
    other.run(5s);
    const bool good = node == 1 || node == 127;
    EXPECT_EQ(other.sr(825), good ? 0U : 0xF5U) << node;
    EXPECT_EQ(other.frames.empty(), !good);
  }
}

TEST_F(FcopmOwnState, AnErrorOfTheCpu) {
  RecordProperty("spec", "ASF-SRM-003");
  list(3);
  start();
  card.cpu_changed(module::CpuState::run, now);
  card.cpu_failed(now);
  card.cpu_changed(module::CpuState::stop, now);
  EXPECT_EQ(sr(825), 0xF3U);
  card.cpu_changed(module::CpuState::run, now);
  EXPECT_EQ(sr(825), 0U);
}

TEST_F(FcopmOwnState, AnErrorOfTheInternalMemory) {
  RecordProperty("spec", "ASF-SRM-006");
  list(3);
  start();
  card.inject(module::ModuleFault::hardware_error, now);
  EXPECT_EQ(sr(825), 0xF8U);
  forget();
  set_d(25032, 1);
  EXPECT_EQ(card.deadline(), can::never) << "it does nothing any more";
  run(5s);
  EXPECT_TRUE(frames.empty());
  card.power_off(now);
  card.power_on(now);
  run(5s);
  EXPECT_EQ(sr(825), 0U);
}

TEST_F(FcopmOwnState, D06_TheBitRate) {
  RecordProperty("spec", "ASF-SR-002 ASF-GEN-005");
  for (const std::uint32_t kbit : {20U, 50U, 125U, 250U, 500U, 1000U}) {
    FcopmCard other;
    EXPECT_TRUE(other.card.preset_bit_rate(kbit * 1000));
    other.card.power_on(other.now);
    other.run(2s);
    EXPECT_EQ(other.sr(822), kbit);
    EXPECT_EQ(other.bus.rate, kbit * 1000);
  }
  for (const std::uint32_t kbit : {10U, 100U, 800U}) EXPECT_FALSE(card.preset_bit_rate(kbit * 1000)) << kbit;
  EXPECT_FALSE(card.preset_bit_rate(20500));
}

TEST_F(FcopmOwnState, TheRegistersAreReadOnly) {
  RecordProperty("spec", "ASF-SR-003");
  list(3);
  start();
  for (const std::uint32_t number : {821U, 822U, 825U, 826U, 829U, 830U, 893U}) {
    const auto before = sr(number);
    card.write_register(module::RegisterKind::special, number, 0x5555, now);
    EXPECT_EQ(sr(number), before) << number;
    set_d(number, 0x5555);
    EXPECT_EQ(sr(number), before) << number;
  }
}

}  // namespace
}  // namespace canopus::scenario::as_fcopm_own_state_test
