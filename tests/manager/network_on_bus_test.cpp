// The master with real nodes as slaves, on the simulated bus: nothing scripted, exact frame times.

#include "manager/network_on_bus.hpp"

namespace canopus::manager::test::network_on_bus_test {
namespace {

TEST_F(NetworkOnBus, Slaves_AreIdentifiedConfiguredWatchedAndStarted) {
  master.stored[{0x1F80, 0}] = 0x01;
  for (std::uint8_t id = 2; id <= 10; ++id) {
    slave(id);
    master.stored[{0x1F81, id}] = 0x0D;
    master.stored[{0x1F84, id}] = 0x000F0191;
    master.stored[{0x1F88, id}] = 7;
    master.stored[{0x1016, id}] = std::uint32_t{id} << 16 | 300;
    master.files[id] = ConciseDcfWriter().add(0x1017, 0, 100, 2).file();
  }
  switch_on();
  run_for(2s);
  EXPECT_EQ(master.node().state(), NmtState::operational);
  for (Slave& device : slaves) {
    EXPECT_EQ(device.node.state(), NmtState::operational);
    EXPECT_EQ(master.master().node_state(device.node.node_id()), 5);
    EXPECT_EQ(master.master().error_control(device.node.node_id()), error_control::heartbeat_active);
  }
}

TEST_F(NetworkOnBus, SlaveUnplugged_IsFoundMissing_AndComesBackByItself) {
  master.stored[{0x1F80, 0}] = 0x01;
  Slave& device = slave(5);
  master.stored[{0x1F81, 5}] = 0x05;
  master.stored[{0x1016, 1}] = 0x0005012C;
  master.files[5] = ConciseDcfWriter().add(0x1017, 0, 100, 2).file();
  switch_on();
  run_for(1s);
  ASSERT_EQ(device.node.state(), NmtState::operational);
  device.port.plug(false);
  run_for(3s);
  EXPECT_EQ(master.master().node_state(5), node_state::missing);
  EXPECT_TRUE(master.master().starting());
  device.port.plug(true);
  run_for(3s);
  EXPECT_EQ(device.node.state(), NmtState::operational);
  EXPECT_EQ(master.master().node_state(5), 5);
  EXPECT_FALSE(master.master().starting());
}

TEST_F(NetworkOnBus, SlaveResetByRequest_IsBootedAndStartedAgain) {
  master.stored[{0x1F80, 0}] = 0x01;
  Slave& device = slave(5);
  master.stored[{0x1F81, 5}] = 0x0D;
  switch_on();
  run_for(3s);
  ASSERT_EQ(device.node.state(), NmtState::operational);
  EXPECT_EQ(master.master().request_nmt(5, 6, timeline.now()), canopen::AbortCode::none);
  run_for(3s);
  EXPECT_EQ(device.node.state(), NmtState::operational);
  EXPECT_EQ(master.master().node_state(5), 5);
}

TEST_F(NetworkOnBus, MappingInAConciseDcf_CountsFromThenOn) {
  master.stored[{0x1F80, 0}] = 0x01;
  Slave& device = slaves.emplace_back(std::uint8_t{5}, bus, timeline, slave_with_tpdo());
  master.stored[{0x1F81, 5}] = 0x0D;
  switch_on();
  run_for(3s);
  ASSERT_EQ(device.node.state(), NmtState::operational);
  struct Listener final : can::Participant {
    void receive(const can::Frame& frame, can::Time) override {
      if (frame.identifier > 0x180 && frame.identifier < 0x580) heard.push_back(text(frame));
    }
    void tick(can::Time) override {}
    std::vector<std::string> heard;
  } listener;
  timeline.add(listener);
  bus.add_port("listener").connect(listener);
  run_for(1ms);  // a controller that joins waits for an idle bus
  std::uint16_t turn = 0;
  const auto values = [&] {
    ++turn;
    for (unsigned sub = 1; sub <= 4; ++sub) {
      device.node.dictionary().set(0x6000, static_cast<std::uint8_t>(sub), turn << 8 | sub);
    }
    device.node.values_changed(timeline.now());
    run_for(10ms);
  };
  values();
  master.files[5] = ConciseDcfWriter()
                        .add(0x1800, 1, 0x80000185, 4)
                        .add(0x1A00, 0, 0, 1)
                        .add(0x1A00, 1, 0x60000310, 4)
                        .add(0x1A00, 2, 0x60000110, 4)
                        .add(0x1A00, 0, 2, 1)
                        .add(0x1800, 1, 0x000001A5, 4)
                        .file();
  EXPECT_EQ(master.master().request_configuration(5, timeline.now()), canopen::AbortCode::none);
  run_for(1s);
  listener.heard.push_back("configured");
  values();
  EXPECT_EQ(device.node.state(), NmtState::operational);
  EXPECT_THAT(listener.heard, ::testing::ElementsAre("185 01 01", "configured", "1A5 03 02 01 02"));
}

TEST_F(NetworkOnBus, GuardedSlave_IsHeardForHours) {
  master.stored[{0x1F80, 0}] = 0x01;
  slave(5);
  master.stored[{0x1F81, 5}] = 0x0064030D;
  switch_on();
  run_for(3600s);
  EXPECT_EQ(master.master().error_control(5), error_control::guarding_active);
  EXPECT_EQ(master.master().node_state(5), 5);
}

// A round of 126 requests and answers takes longer than the time-out here: what waits in line does not time
// out.
class SlowNetworkOnBus : public ::testing::TestWithParam<std::size_t> {};

TEST_P(SlowNetworkOnBus, EveryTransferGetsItsTurn) {
  can::Timeline timeline;
  sim::Bus bus{"field", 50'000, timeline};
  MasterOnBus master{bus.add_port("master"), timeline};
  std::list<NetworkOnBus::Slave> slaves;
  master.stored[{0x1F80, 0}] = 0x01;
  master.master().options().block_from = GetParam();
  for (std::uint8_t id = 2; id <= 127; ++id) {
    slaves.emplace_back(id, bus, timeline);
    master.stored[{0x1F81, id}] = 0x0D;
    master.files[id] = ConciseDcfWriter().add(0x2100, 0, std::vector<std::uint8_t>(60, id)).file();
  }
  for (auto& device : slaves) {
    device.node.power_on(timeline.now());
  }
  timeline.run_until(can::Time(1s));
  master.node().power_on(timeline.now());
  timeline.run_until(can::Time(30s));
  for (std::uint8_t id = 2; id <= 127; ++id) {
    const BootRecord& record = master.master().boot_record(id);
    ASSERT_TRUE(record.step == BootStep::booted) << explain(record, id, timeline.now());
  }
  EXPECT_EQ(master.node().state(), NmtState::operational);
}
INSTANTIATE_TEST_SUITE_P(SegmentedAndInBlocks, SlowNetworkOnBus, ::testing::Values(0U, 22U));

// The files take ten seconds on the bus; the servers wait one second for the next segment.
TEST_F(NetworkOnBus, LargeFiles_GoSideBySide) {
  master.master().options().late_boot_up = 30s;  // the boot-up messages have to wait for the end of the files
  master.stored[{0x1F80, 0}] = 0x01;
  for (std::uint8_t id = 2; id <= 11; ++id) {
    slave(id);
    master.stored[{0x1F81, id}] = 0x0D;
    master.files[id] = ConciseDcfWriter().add(0x2100, 0, std::vector<std::uint8_t>(60'000, id)).file();
  }
  switch_on();
  run_for(20s);
  for (Slave& device : slaves) {
    const std::uint8_t id = device.node.node_id();
    const BootRecord& record = master.master().boot_record(id);
    EXPECT_TRUE(record.step == BootStep::booted) << explain(record, id, timeline.now());
    const auto value = device.node.dictionary().read(0x2100, 0, timeline.now());
    ASSERT_TRUE(value.has_value());
    EXPECT_TRUE(std::ranges::equal(*value, std::vector<std::uint8_t>(60'000, id)));
  }
}

}  // namespace
}  // namespace canopus::manager::test::network_on_bus_test
