// LSS master [CiA 305] in literal frames, and with slaves.

#include "canopus/lss/lss_master.hpp"

#include <deque>
#include <list>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "canopus/lss/lss_slave.hpp"

#include "master_bench.hpp"

namespace canopus::manager::test::lss_master_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr lss::LssAddress address{0x00000071, 0x0000ED63, 0x00010000, 0x12345678};

class LssMasterTest : public ::testing::Test, public can::Sink, public lss::LssMasterListener {
 public:
  virtual ~LssMasterTest() = default;
  bool send(const can::Frame& frame) override {
    lines.push_back(text(frame));
    return true;
  }
  void lss_finished(lss::LssMaster&, lss::LssResult result, can::Time) override { results.push_back(result); }
  void wait(can::Duration duration) {
    const can::Time end = now + duration;
    while (master.deadline() <= end) {
      now = master.deadline();
      master.tick(now);
    }
    now = end;
  }
  void receive(std::initializer_list<std::uint8_t> bytes) {
    std::vector<std::uint8_t> data(bytes);
    data.resize(8);
    master.receive(can::data_frame(0x7E4, data), now);
  }

  std::vector<std::string> lines;
  std::vector<lss::LssResult> results;
  can::Time now{};
  lss::LssMaster master{*this, *this};
};

TEST_F(LssMasterTest, Select_SendsTheFourParts_AndIsDoneWithTheAnswer) {
  EXPECT_TRUE(master.select(address, now));
  EXPECT_TRUE(master.busy());
  wait(10ms);
  EXPECT_THAT(lines, ElementsAre("7E5 40 71 00 00 00 00 00 00", "7E5 41 63 ED 00 00 00 00 00",
                                 "7E5 42 00 00 01 00 00 00 00", "7E5 43 78 56 34 12 00 00 00"));
  EXPECT_THAT(results, IsEmpty());
  receive({0x44});
  EXPECT_THAT(results, ElementsAre(lss::LssResult::done));
  EXPECT_FALSE(master.busy());
}

TEST_F(LssMasterTest, Select_NoAnswerIn100Ms_IsSilence) {
  master.select(address, now);
  wait(102ms);
  EXPECT_THAT(results, IsEmpty());
  wait(1ms);
  EXPECT_THAT(results, ElementsAre(lss::LssResult::silence));
}

TEST_F(LssMasterTest, ConfigureNodeId_DoneOrRefused) {
  master.configure_node_id(5, now);
  EXPECT_THAT(lines, ElementsAre("7E5 11 05 00 00 00 00 00 00"));
  receive({0x11, 0x00});
  master.configure_node_id(5, now);
  receive({0x11, 0xFF, 0x07});
  EXPECT_THAT(results, ElementsAre(lss::LssResult::done, lss::LssResult::refused));
  EXPECT_EQ(master.error(), 0xFF);
  EXPECT_EQ(master.specific_error(), 0x07);
}

TEST_F(LssMasterTest, OtherServices_InLiteralFrames) {
  master.switch_global(true, now);
  wait(1ms);
  master.switch_global(false, now);
  wait(1ms);
  master.configure_bit_timing(2, now);
  receive({0x13, 0x00});
  master.activate_bit_timing(1000ms, now);
  wait(1ms);
  master.store(now);
  receive({0x17, 0x00});
  master.inquire(3, now);
  receive({0x5D, 0x78, 0x56, 0x34, 0x12});
  EXPECT_EQ(master.value(), 0x12345678U);
  master.inquire_node_id(now);
  receive({0x5E, 0x05});
  EXPECT_EQ(master.value(), 5U);
  master.identify_unconfigured(now);
  receive({0x50});
  EXPECT_THAT(lines, ElementsAre("7E5 04 01 00 00 00 00 00 00", "7E5 04 00 00 00 00 00 00 00",
                                 "7E5 13 00 02 00 00 00 00 00", "7E5 15 E8 03 00 00 00 00 00",
                                 "7E5 17 00 00 00 00 00 00 00", "7E5 5D 00 00 00 00 00 00 00",
                                 "7E5 5E 00 00 00 00 00 00 00", "7E5 4C 00 00 00 00 00 00 00"));
  EXPECT_THAT(results, ::testing::Each(lss::LssResult::done));
  EXPECT_EQ(results.size(), 8U);
}

TEST_F(LssMasterTest, Identify_SendsTheRanges) {
  master.identify({1, 2, 3, 5}, {1, 2, 4, 6}, now);
  wait(10ms);
  EXPECT_THAT(lines, ElementsAre("7E5 46 01 00 00 00 00 00 00", "7E5 47 02 00 00 00 00 00 00",
                                 "7E5 48 03 00 00 00 00 00 00", "7E5 49 04 00 00 00 00 00 00",
                                 "7E5 4A 05 00 00 00 00 00 00", "7E5 4B 06 00 00 00 00 00 00"));
  receive({0x4F});
  EXPECT_THAT(results, ElementsAre(lss::LssResult::done));
}

TEST_F(LssMasterTest, Busy_RefusesTheNextService) {
  master.store(now);
  EXPECT_FALSE(master.configure_node_id(5, now));
  EXPECT_FALSE(master.fastscan(now));
  master.cancel();
  EXPECT_TRUE(master.configure_node_id(5, now));
}

TEST_F(LssMasterTest, Fastscan_NobodyThere_IsSilence) {
  master.fastscan(now);
  wait(100ms);
  EXPECT_THAT(lines, ElementsAre("7E5 51 00 00 00 00 80 00 00"));
  EXPECT_THAT(results, ElementsAre(lss::LssResult::silence));
}

TEST_F(LssMasterTest, SlowScan_HalvesRevisionThenSerial_AndSelects) {
  // Revisions 4 to 7, serial numbers 0 to 3; the slave has 6 and 1.
  master.slow_scan({0x71, 0xED63, 4, 0}, {0x71, 0xED63, 7, 3}, now);
  const auto asked = [&] {  // the four bounds of the question that has just been asked
    wait(6ms);
    std::string bounds;
    for (const std::string& line : std::exchange(lines, {})) {
      if (line[4] == '4' && line[5] >= '8') bounds += line.substr(7, 2) + ' ';
    }
    return bounds;
  };
  const auto silence = [&] { wait(100ms); };
  const auto answer = [&] {
    receive({0x4F});
    EXPECT_THAT(lines, IsEmpty());  // others may still answer
    wait(100ms);
  };
  EXPECT_EQ(asked(), "04 07 00 03 ");
  answer();
  EXPECT_EQ(asked(), "04 05 00 03 ");
  silence();
  EXPECT_EQ(asked(), "06 06 00 03 ");
  answer();
  EXPECT_EQ(asked(), "06 06 00 01 ");
  answer();
  EXPECT_EQ(asked(), "06 06 00 00 ");
  silence();
  wait(6ms);
  EXPECT_THAT(lines, ElementsAre("7E5 40 71 00 00 00 00 00 00", "7E5 41 63 ED 00 00 00 00 00",
                                 "7E5 42 06 00 00 00 00 00 00", "7E5 43 01 00 00 00 00 00 00"));
  EXPECT_THAT(results, IsEmpty());
  receive({0x44});
  EXPECT_THAT(results, ElementsAre(lss::LssResult::done));
  EXPECT_EQ(master.address(), (lss::LssAddress{0x71, 0xED63, 6, 1}));
}

TEST_F(LssMasterTest, SlowScan_NobodyThere_IsSilence_GoneInTheMiddle_IsLost) {
  master.slow_scan({1, 2, 0, 0}, {1, 2, 0xFFFFFFFF, 0xFFFFFFFF}, now);
  wait(106ms);
  EXPECT_EQ(lines.size(), 6U);
  EXPECT_THAT(results, ElementsAre(lss::LssResult::silence));
  results.clear();
  master.slow_scan({1, 2, 0, 0}, {1, 2, 0xFFFFFFFF, 0xFFFFFFFF}, now);
  wait(6ms);
  receive({0x4F});
  wait(100s);
  EXPECT_THAT(results, ElementsAre(lss::LssResult::lost));
}

TEST_F(LssMasterTest, AnswersToNothing_AreIgnored) {
  receive({0x44});
  master.store(now);
  receive({0x11, 0x00});
  EXPECT_THAT(results, IsEmpty());
}

// --- both

TEST(Lss, Fastscan_Finds32UnconfiguredDevices_AndGivesEachANodeId) {
  struct Device : lss::LssSlaveListener {
    Device(can::Sink& sink, const lss::LssAddress& own) : address(own), slave(sink, *this, own) {
      slave.start(lss::unconfigured, 250'000);
    }
    void node_id_assigned(std::uint8_t id, can::Time) override { node_id = id; }
    Stored store(std::uint8_t id, std::uint32_t) override {
      stored = id;
      return Stored::done;
    }
    lss::LssAddress address;
    lss::LssSlave slave;
    std::uint8_t node_id = 0;
    std::uint8_t stored = 0;
  };
  struct Bus : can::Sink, lss::LssMasterListener {
    struct Answers : can::Sink {
      explicit Answers(Bus& bus) : owner(bus) {}
      bool send(const can::Frame& frame) override {
        owner.answers.push_back(frame);
        return true;
      }
      Bus& owner;
    };
    bool send(const can::Frame& frame) override {
      ++frames;
      for (Device& device : devices) device.slave.receive(frame, now);
      return true;
    }
    void lss_finished(lss::LssMaster&, lss::LssResult result, can::Time) override { last = result; }
    lss::LssResult run() {
      while (master.busy()) {
        while (!answers.empty()) {
          master.receive(answers.front(), now);
          answers.pop_front();
        }
        if (!master.busy()) break;
        now = master.deadline();
        master.tick(now);
      }
      return last;
    }
    Answers answering{*this};
    std::list<Device> devices;
    std::deque<can::Frame> answers;
    lss::LssMaster master{*this, *this};
    lss::LssResult last = lss::LssResult::done;
    can::Time now{};
    unsigned frames = 0;
  } bus;
  std::mt19937 random(32);
  for (int i = 0; i < 32; ++i) {
    const lss::LssAddress own{0x71U + static_cast<std::uint32_t>(i % 2), static_cast<std::uint32_t>(random()),
                              i % 3 == 0 ? 0U : static_cast<std::uint32_t>(random()),
                              static_cast<std::uint32_t>(random())};
    bus.devices.emplace_back(bus.answering, own);
  }
  std::uint8_t next = 1;
  for (;;) {
    bus.master.fastscan(bus.now);
    if (bus.run() == lss::LssResult::silence) break;
    ASSERT_EQ(bus.last, lss::LssResult::done);
    ASSERT_LE(next, 32);
    const auto found = std::find_if(bus.devices.begin(), bus.devices.end(), [&](const Device& device) {
      return device.address == bus.master.address();
    });
    ASSERT_NE(found, bus.devices.end());
    bus.master.configure_node_id(next, bus.now);
    ASSERT_EQ(bus.run(), lss::LssResult::done);
    bus.master.store(bus.now);
    ASSERT_EQ(bus.run(), lss::LssResult::done);
    bus.master.switch_global(false, bus.now);
    bus.run();
    EXPECT_EQ(found->node_id, next);
    EXPECT_EQ(found->stored, next);
    ++next;
  }
  EXPECT_EQ(next, 33);
  std::set<std::uint8_t> ids;
  for (const Device& device : bus.devices) ids.insert(device.node_id);
  EXPECT_EQ(ids.size(), 32U);
  EXPECT_EQ(bus.frames, 32U * (133 + 3) + 1);
}

}  // namespace
}  // namespace canopus::manager::test::lss_master_test
