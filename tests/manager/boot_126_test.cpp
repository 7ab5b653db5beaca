// 126 slaves that are booted with configurations, on the simulated bus: exact frame times.

#include "manager/network_on_bus.hpp"

namespace canopus::manager::test::boot_126_test {
namespace {

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
}  // namespace canopus::manager::test::boot_126_test
