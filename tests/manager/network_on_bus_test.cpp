// The master with real nodes as slaves, on the simulated bus: nothing scripted, exact frame times.

#include <iostream>

#include <gmock/gmock.h>

#include "canopus/manager/concise_dcf.hpp"
#include "canopus/sim/bus.hpp"

#include "master_bench.hpp"

namespace canopus::manager::test {
namespace {

std::shared_ptr<const canopen::DictionaryDescription> slave_dictionary() {
  using canopen::Access;
  using canopen::DataType;
  static const auto description = [] {
    canopen::DictionaryBuilder builder;
    builder.variable(
        0x1000,
        {.name = "Device type", .access = Access::read_only, .value = canopen::little_endian(0x000F0191, 4)});
    builder.variable(0x1001,
                     {.name = "Error register", .type = DataType::unsigned8, .access = Access::read_only});
    builder.variable(0x1017, {.name = "Producer heartbeat time", .type = DataType::unsigned16});
    builder.uniform(0x1018, canopen::ObjectCode::record, "Identity", 4,
                    {.name = "Identity", .access = Access::read_only, .value = canopen::little_endian(7, 4)});
    builder.uniform(0x2000, canopen::ObjectCode::array, "Parameters", 190, {.name = "Parameter"});
    return builder.build();
  }();
  return description;
}

/// A master on a port: its node, then the master, as NmtMaster wants to be driven.
class MasterOnBus final : public can::Participant, public canopen::NodeListener, public ConfigurationSource {
 public:
  MasterOnBus(sim::Port& port, can::Timeline& timeline)
      : node(master_dictionary(), 1, port), master(node, port) {
    node.set_listener(this);
    master.set_configuration_source(this);
    handle = timeline.add(*this);
    port.connect(*this, handle);
  }
  void receive(const can::Frame& frame, can::Time now) override {
    node.receive(frame, now);
    master.receive(frame, now);
  }
  void tick(can::Time now) override {
    if (node.deadline() <= now) node.tick(now);
    if (master.deadline() <= now) master.tick(now);
  }
  can::Time deadline() const noexcept override { return std::min(node.deadline(), master.deadline()); }
  void reset_requested(canopen::NmtCommand, can::Time now) override { master.stop(now); }
  void reset_done(canopen::NmtCommand, can::Time now) override {
    for (const auto& [place, value] : stored) node.dictionary().set(place.first, place.second, value);
    master.start(now);
  }
  void nmt_state_changed(NmtState state, can::Time now) override { master.own_state_changed(state, now); }
  void heartbeat_received(std::uint8_t id, NmtState state, can::Time now) override {
    master.heartbeat_received(id, state, now);
  }
  void heartbeat_lost(std::uint8_t id, can::Time now) override { master.heartbeat_lost(id, now); }
  std::span<const std::uint8_t> concise_dcf(std::uint8_t id) override { return files[id]; }

  canopen::Node node;
  NmtMaster master;
  can::Timeline::Handle handle = 0;
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t> stored;
  std::map<std::uint8_t, std::vector<std::uint8_t>> files;
};

class NetworkOnBus : public ::testing::Test {
 public:
  struct Slave {
    Slave(std::uint8_t id, sim::Bus& bus, can::Timeline& timeline)
        : port(bus.add_port("slave " + std::to_string(id))), node(slave_dictionary(), id, port) {
      handle = timeline.add(node);
      port.connect(node, handle);
    }
    sim::Port& port;
    canopen::Node node;
    can::Timeline::Handle handle;
  };

  Slave& slave(std::uint8_t id) { return slaves.emplace_back(id, bus, timeline); }
  void switch_on() {
    for (Slave& device : slaves) {
      device.node.power_on(timeline.now());
      timeline.refresh(device.handle);
    }
    run_for(100ms);
    master.node.power_on(timeline.now());
    timeline.refresh(master.handle);
  }
  void run_for(can::Duration duration) { timeline.run_until(timeline.now() + duration); }

  can::Timeline timeline;
  sim::Bus bus{"field", 1'000'000, timeline};
  MasterOnBus master{bus.add_port("master"), timeline};
  std::list<Slave> slaves;
};

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
  EXPECT_EQ(master.node.state(), NmtState::operational);
  for (Slave& device : slaves) {
    EXPECT_EQ(device.node.state(), NmtState::operational);
    EXPECT_EQ(master.master.node_state(device.node.node_id()), 5);
    EXPECT_EQ(master.master.error_control(device.node.node_id()), error_control::heartbeat_active);
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
  EXPECT_EQ(master.master.node_state(5), node_state::missing);
  EXPECT_TRUE(master.master.starting());
  device.port.plug(true);
  run_for(3s);
  EXPECT_EQ(device.node.state(), NmtState::operational);
  EXPECT_EQ(master.master.node_state(5), 5);
  EXPECT_FALSE(master.master.starting());
}

TEST_F(NetworkOnBus, GuardedSlave_IsHeardForHours) {
  master.stored[{0x1F80, 0}] = 0x01;
  slave(5);
  master.stored[{0x1F81, 5}] = 0x0064030D;
  switch_on();
  run_for(3600s);
  EXPECT_EQ(master.master.error_control(5), error_control::guarding_active);
  EXPECT_EQ(master.master.node_state(5), 5);
}

TEST_F(NetworkOnBus, Boot126Slaves_WithConciseDcfsOf2Kilobytes_TakesHardlyLongerThanItsBits) {
  master.stored[{0x1F80, 0}] = 0x01;
  ConciseDcfWriter writer;
  for (std::uint8_t sub = 1; sub <= 186; ++sub) writer.add(0x2000, sub, 0x01020304U * sub, 4);
  ASSERT_GE(writer.file().size(), 2000U);
  for (std::uint8_t id = 2; id <= 127; ++id) {
    slave(id);
    master.stored[{0x1F81, id}] = 0x0D;
    master.files[id] = writer.file();
  }
  switch_on();
  const can::Time begin = timeline.now();
  can::Time done{};
  while (timeline.now() - begin < 60s) {
    run_for(10ms);
    if (master.node.state() == NmtState::operational) {
      done = timeline.now();
      break;
    }
  }
  ASSERT_EQ(master.node.state(), NmtState::operational);
  const double took = can::seconds(done) - can::seconds(begin);
  const double bits = static_cast<double>(bus.load(timeline.now()).bits) / 1e6;
  std::cout << "126 slaves: " << took << " s at 1 Mbit/s, " << bits << " s of it frames\n";
  EXPECT_LT(took, bits * 1.05 + 0.02);
  for (Slave& device : slaves) EXPECT_EQ(device.node.state(), NmtState::operational);
}

}  // namespace
}  // namespace canopus::manager::test
