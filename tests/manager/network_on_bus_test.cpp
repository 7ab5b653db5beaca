// The master with real nodes as slaves, on the simulated bus: nothing scripted, exact frame times.

#include <iostream>

#include <gmock/gmock.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "master_bench.hpp"

namespace canopus::manager::test {
namespace {

canopen::DictionaryBuilder slave_objects() {
  using canopen::Access;
  using canopen::DataType;
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
  builder.variable(0x2100, {.name = "Table", .type = DataType::domain});
  return builder;
}
std::shared_ptr<const canopen::DictionaryDescription> slave_dictionary() {
  static const auto description = slave_objects().build();
  return description;
}
/// With a TPDO of one word.
std::shared_ptr<const canopen::DictionaryDescription> slave_with_tpdo() {
  using canopen::DataType;
  canopen::DictionaryBuilder builder = slave_objects();
  builder.uniform(0x6000, canopen::ObjectCode::array, "Inputs", 4,
                  {.name = "Input", .type = DataType::unsigned16, .tpdo_mappable = true});
  builder.object(0x1800, canopen::ObjectCode::record, "TPDO communication");
  builder.sub(0x1800, 1, {.value = canopen::little_endian(0x180, 4), .adds_node_id = true});
  builder.sub(0x1800, 2, {.type = DataType::unsigned8, .value = {0xFE}});
  builder.object(0x1A00, canopen::ObjectCode::record, "TPDO mapping");
  builder.sub(0x1A00, 0, {.type = DataType::unsigned8, .value = {1}});
  for (std::uint8_t sub = 1; sub <= 4; ++sub) {
    builder.sub(0x1A00, sub, {.value = canopen::little_endian(0x60000010U + 0x100U * sub, 4)});
  }
  return builder.build();
}

class MasterOnBus final : public ConfiguredMaster {
 public:
  MasterOnBus(sim::Port& port, can::Timeline& timeline) : ConfiguredMaster(port) {
    handle = timeline.add(*this);
    port.connect(*this, handle);
  }
  can::Timeline::Handle handle = 0;
};

class NetworkOnBus : public ::testing::Test {
 public:
  struct Slave {
    Slave(std::uint8_t id, sim::Bus& bus, can::Timeline& timeline,
          std::shared_ptr<const canopen::DictionaryDescription> description = slave_dictionary())
        : port(bus.add_port("slave " + std::to_string(id))), node(std::move(description), id, port) {
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
    master.node().power_on(timeline.now());
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
  timeline.refresh(master.handle);
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
    can::Time deadline() const noexcept override { return can::never; }
    std::vector<std::string> heard;
  } listener;
  bus.add_port("listener").connect(listener, timeline.add(listener));
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
  timeline.refresh(master.handle);
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

/// Bits on the wire of frames that come one after the other, with the intermission after each.
class WireTime {
 public:
  void frame(std::uint32_t identifier, std::initializer_list<std::uint8_t> bytes) {
    bits_ += can::frame_bits(can::data_frame(identifier, bytes)) + can::intermission_bits;
  }
  void frame(std::uint32_t identifier, std::span<const std::uint8_t> bytes) {
    bits_ += can::frame_bits(can::data_frame(identifier, bytes)) + can::intermission_bits;
  }
  [[nodiscard]] double seconds(std::uint32_t bit_rate) const {
    return static_cast<double>(bits_) / static_cast<double>(bit_rate);
  }

 private:
  std::uint64_t bits_ = 0;
};

constexpr std::uint8_t low(std::size_t value) { return static_cast<std::uint8_t>(value & 0xFF); }
constexpr std::uint8_t high(std::size_t value) { return static_cast<std::uint8_t>(value >> 8 & 0xFF); }

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
    timeline.refresh(device.handle);
  }
  timeline.run_until(can::Time(1s));
  master.node().power_on(timeline.now());
  timeline.refresh(master.handle);
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

/// How one configuration of 2 kB gets to a slave, frame by frame, as CiA 301 has it.
enum class Configuration2k : std::uint8_t {
  parameters,  ///< 186 entries of 4 bytes: expedited, a frame and its answer each
  in_blocks,   ///< one entry of 2000 bytes in SDO blocks
  segmented,   ///< the same in segments, each with its answer
};

class Boot126 : public NetworkOnBus, public ::testing::WithParamInterface<Configuration2k> {
 public:
  static std::vector<std::uint8_t> value() {
    std::vector<std::uint8_t> bytes(2000);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 31 + i / 256);
    return bytes;
  }
  static std::vector<std::uint8_t> file() {
    ConciseDcfWriter writer;
    if (GetParam() == Configuration2k::parameters) {
      for (std::uint8_t sub = 1; sub <= 186; ++sub) writer.add(0x2000, sub, 0x01020304U * sub, 4);
    } else {
      writer.add(0x2100, 0, value());
    }
    return writer.file();
  }
  static void configuration(WireTime& wire, std::uint8_t id) {
    const std::uint32_t to = 0x600U + id;
    const std::uint32_t from = 0x580U + id;
    const std::vector<std::uint8_t> bytes = value();
    const std::uint8_t size[] = {low(bytes.size()), high(bytes.size())};
    const auto segment = [&](std::size_t at, std::uint8_t head) {
      std::vector<std::uint8_t> data{head};
      for (std::size_t i = at; i < at + 7; ++i) data.push_back(i < bytes.size() ? bytes[i] : std::uint8_t{0});
      wire.frame(to, data);
    };
    switch (GetParam()) {
      case Configuration2k::parameters:
        for (std::uint8_t sub = 1; sub <= 186; ++sub) {
          const std::uint32_t word = 0x01020304U * sub;
          wire.frame(to, {0x23, 0x00, 0x20, sub, low(word), high(word), low(word >> 16), high(word >> 16)});
          wire.frame(from, {0x60, 0x00, 0x20, sub, 0, 0, 0, 0});
        }
        return;
      case Configuration2k::in_blocks: {
        wire.frame(to, {0xC6, 0x00, 0x21, 0x00, size[0], size[1], 0, 0});
        wire.frame(from, {0xA4, 0x00, 0x21, 0x00, 127, 0, 0, 0});
        std::uint8_t number = 0;
        for (std::size_t at = 0; at < bytes.size(); at += 7) {
          const bool last = at + 7 >= bytes.size();
          segment(at, static_cast<std::uint8_t>(++number | (last ? 0x80 : 0)));
          if (!last && number != 127) continue;
          wire.frame(from, {0xA2, number, 127, 0, 0, 0, 0, 0});
          number = 0;
        }
        wire.frame(to, {0xC1 | 2 << 2, 0, 0, 0, 0, 0, 0, 0});  // the CRC's few stuff bits apart
        wire.frame(from, {0xA1, 0, 0, 0, 0, 0, 0, 0});
        return;
      }
      case Configuration2k::segmented: {
        wire.frame(to, {0x21, 0x00, 0x21, 0x00, size[0], size[1], 0, 0});
        wire.frame(from, {0x60, 0x00, 0x21, 0x00, 0, 0, 0, 0});
        std::uint8_t toggle = 0;
        for (std::size_t at = 0; at < bytes.size(); at += 7, toggle ^= 0x10) {
          const bool last = at + 7 >= bytes.size();
          segment(at, static_cast<std::uint8_t>(toggle | (last ? 2 << 1 | 1 : 0)));
          wire.frame(from, {static_cast<std::uint8_t>(0x20 | toggle), 0, 0, 0, 0, 0, 0, 0});
        }
        return;
      }
    }
  }
  /// Every frame that the start-up needs, without a bit of pause between them: nothing can be faster. The
  /// Start commands come when the network is up.
  static WireTime minimum() {
    WireTime wire;
    wire.frame(0x701, {0x00});
    wire.frame(0x000, {0x82, 0x00});
    for (std::uint8_t id = 2; id <= 127; ++id) {
      wire.frame(0x700U + id, {0x00});
      wire.frame(0x600U + id, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
      wire.frame(0x580U + id, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
      configuration(wire, id);
    }
    return wire;
  }
};

TEST_P(Boot126, WithConciseDcfsOf2Kilobytes_TakesTheTimeOfItsBits) {
  constexpr std::uint32_t bit_rate = 1'000'000;
  master.stored[{0x1F80, 0}] = 0x01;
  if (GetParam() == Configuration2k::segmented) master.master().options().block_from = 0;
  for (std::uint8_t id = 2; id <= 127; ++id) {
    slave(id);
    master.stored[{0x1F81, id}] = 0x0D;
    master.files[id] = file();
  }
  ASSERT_GE(file().size(), 2000U);
  switch_on();
  const can::Time begin = timeline.now();
  while (master.node().state() != NmtState::operational && timeline.now() - begin < 60s) run_for(1ms);
  for (std::uint8_t id = 2; id <= 127; ++id) {
    const BootRecord& record = master.master().boot_record(id);
    ASSERT_TRUE(record.step == BootStep::booted) << explain(record, id, timeline.now());
  }
  ASSERT_EQ(master.node().state(), NmtState::operational);
  const double took = can::seconds(timeline.now()) - can::seconds(begin);
  const double least = minimum().seconds(bit_rate);
  constexpr const char* names[] = {"186 entries of 4 bytes", "2000 bytes in blocks",
                                   "2000 bytes in segments"};
  std::cout << "126 slaves, " << names[static_cast<unsigned>(GetParam())] << " each, 1 Mbit/s: " << took
            << " s, frames alone " << least << " s (" << (took / least - 1) * 100 << " % above)\n";
  EXPECT_GE(took, least);
  EXPECT_LT(took, least * 1.01 + 0.002);
  run_for(10ms);
  for (Slave& device : slaves) EXPECT_EQ(device.node.state(), NmtState::operational);
}

// Slaves that boot early start to send PDOs, which have priority over SDO, while the others are configured.
TEST_P(Boot126, WhileBootedSlavesSendPdos_NoTransferStarves) {
  master.stored[{0x1F80, 0}] = 0x01;
  if (GetParam() == Configuration2k::segmented) master.master().options().block_from = 0;
  for (std::uint8_t id = 2; id <= 127; ++id) {
    slaves.emplace_back(id, bus, timeline, slave_with_tpdo());
    master.stored[{0x1F81, id}] = 0x0D;
    master.files[id] = file();
  }
  switch_on();
  const can::Time begin = timeline.now();
  while (master.node().state() != NmtState::operational && timeline.now() - begin < 60s) run_for(1ms);
  for (std::uint8_t id = 2; id <= 127; ++id) {
    const BootRecord& record = master.master().boot_record(id);
    ASSERT_TRUE(record.step == BootStep::booted) << explain(record, id, timeline.now());
  }
  EXPECT_EQ(master.node().state(), NmtState::operational);
}

INSTANTIATE_TEST_SUITE_P(Files, Boot126,
                         ::testing::Values(Configuration2k::parameters, Configuration2k::in_blocks,
                                           Configuration2k::segmented));

}  // namespace
}  // namespace canopus::manager::test
