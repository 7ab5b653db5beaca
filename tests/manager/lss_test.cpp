// LSS [CiA 305]: the slave and the master in literal frames, and both together.

#include <deque>
#include <list>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "canopus/lss/lss_master.hpp"
#include "canopus/lss/lss_slave.hpp"

#include "master_bench.hpp"

namespace canopus::manager::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr lss::LssAddress address{0x00000071, 0x0000ED63, 0x00010000, 0x12345678};

class LssSlaveTest : public ::testing::Test, public can::Sink, public lss::LssSlaveUser {
 public:
  LssSlaveTest() { slave.start(lss::unconfigured, 250'000); }
  virtual ~LssSlaveTest() = default;
  bool send(const can::Frame& frame) override {
    lines.push_back(text(frame));
    return true;
  }
  void node_id_assigned(std::uint8_t id, can::Time) override { assigned = id; }
  bool supports_bit_rate(std::uint32_t rate) override { return rate != 10'000; }
  void change_bit_rate(std::uint32_t rate, can::Time at) override {
    bit_rate = rate;
    changed_at = at;
  }
  Stored store(std::uint8_t id, std::uint32_t rate) override {
    stored_id = id;
    stored_rate = rate;
    return result;
  }
  std::vector<std::string> ask(std::initializer_list<std::uint8_t> bytes) {
    std::vector<std::uint8_t> data(bytes);
    data.resize(8);
    slave.receive(can::data_frame(0x7E5, data), now);
    return std::exchange(lines, {});
  }
  void configuration() { ask({0x04, 0x01}); }

  std::vector<std::string> lines;
  lss::LssSlave slave{*this, *this, address};
  can::Time now{};
  std::uint8_t assigned = 0;
  std::uint8_t stored_id = 0;
  std::uint32_t stored_rate = 0;
  std::uint32_t bit_rate = 0;
  can::Time changed_at{};
  Stored result = Stored::done;
};

TEST_F(LssSlaveTest, SwitchGlobal_IsNotAnswered) {
  EXPECT_THAT(ask({0x04, 0x01}), IsEmpty());
  EXPECT_EQ(slave.state(), lss::LssSlave::State::configuration);
  EXPECT_THAT(ask({0x04, 0x00}), IsEmpty());
  EXPECT_EQ(slave.state(), lss::LssSlave::State::waiting);
  ask({0x04, 0x02});
  EXPECT_EQ(slave.state(), lss::LssSlave::State::waiting);
}

TEST_F(LssSlaveTest, SwitchSelective_AllFourPartsMatch_IsAnswered) {
  EXPECT_THAT(ask({0x40, 0x71, 0x00, 0x00, 0x00}), IsEmpty());
  EXPECT_THAT(ask({0x41, 0x63, 0xED, 0x00, 0x00}), IsEmpty());
  EXPECT_THAT(ask({0x42, 0x00, 0x00, 0x01, 0x00}), IsEmpty());
  EXPECT_THAT(ask({0x43, 0x78, 0x56, 0x34, 0x12}), ElementsAre("7E4 44 00 00 00 00 00 00 00"));
  EXPECT_EQ(slave.state(), lss::LssSlave::State::configuration);
}

TEST_F(LssSlaveTest, SwitchSelective_OnePartDiffers_StaysWaiting) {
  ask({0x40, 0x71, 0x00, 0x00, 0x00});
  ask({0x41, 0x64, 0xED, 0x00, 0x00});
  ask({0x42, 0x00, 0x00, 0x01, 0x00});
  EXPECT_THAT(ask({0x43, 0x78, 0x56, 0x34, 0x12}), IsEmpty());
  EXPECT_EQ(slave.state(), lss::LssSlave::State::waiting);
}

TEST_F(LssSlaveTest, SwitchSelective_OutOfOrder_StaysWaiting) {
  ask({0x41, 0x63, 0xED, 0x00, 0x00});
  ask({0x40, 0x71, 0x00, 0x00, 0x00});
  ask({0x42, 0x00, 0x00, 0x01, 0x00});
  EXPECT_THAT(ask({0x43, 0x78, 0x56, 0x34, 0x12}), IsEmpty());
}

TEST_F(LssSlaveTest, ConfigurationServices_AreNotHeardWhileWaiting) {
  EXPECT_THAT(ask({0x11, 0x05}), IsEmpty());
  EXPECT_THAT(ask({0x17}), IsEmpty());
  EXPECT_THAT(ask({0x5A}), IsEmpty());
}

TEST_F(LssSlaveTest, NodeId_IsPending_UntilTheSlaveIsSwitchedToWaiting) {
  configuration();
  EXPECT_THAT(ask({0x11, 0x05}), ElementsAre("7E4 11 00 00 00 00 00 00 00"));
  EXPECT_EQ(slave.pending_node_id(), 5);
  EXPECT_EQ(assigned, 0);
  EXPECT_THAT(ask({0x5E}), ElementsAre("7E4 5E FF 00 00 00 00 00 00"));
  ask({0x04, 0x00});
  EXPECT_EQ(assigned, 5);
}

TEST_F(LssSlaveTest, NodeIdOfAConfiguredDevice_WaitsForItsNextReset) {
  slave.start(9, 250'000);
  configuration();
  ask({0x11, 0x05});
  ask({0x04, 0x00});
  EXPECT_EQ(assigned, 0);
  EXPECT_EQ(slave.pending_node_id(), 5);
}

TEST_F(LssSlaveTest, NodeIdOutOfRange_IsRefused) {
  configuration();
  for (const std::uint8_t id : {std::uint8_t{0}, std::uint8_t{128}, std::uint8_t{254}}) {
    EXPECT_THAT(ask({0x11, id}), ElementsAre("7E4 11 01 00 00 00 00 00 00"));
  }
  EXPECT_THAT(ask({0x11, 0xFF}), ElementsAre("7E4 11 00 00 00 00 00 00 00"));
}

TEST_F(LssSlaveTest, BitTiming_TableAndIndexAreChecked) {
  configuration();
  EXPECT_THAT(ask({0x13, 0x00, 0x02}), ElementsAre("7E4 13 00 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x13, 0x00, 0x05}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x13, 0x00, 0x08}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x13, 0x00, 0x09}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x13, 0x01, 0x02}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
}

TEST_F(LssSlaveTest, Activate_IsSilentForTheDelay_ChangesTheRate_AndIsSilentAgain) {
  configuration();
  ask({0x13, 0x00, 0x02});
  EXPECT_THAT(ask({0x15, 0xE8, 0x03}), IsEmpty());
  EXPECT_TRUE(slave.silent());
  EXPECT_EQ(slave.deadline(), can::Time(1s));
  EXPECT_THAT(ask({0x5E}), IsEmpty());
  slave.tick(can::Time(1s));
  EXPECT_EQ(bit_rate, 500'000U);
  EXPECT_TRUE(slave.silent());
  EXPECT_EQ(slave.deadline(), can::Time(2s));
  slave.tick(can::Time(2s));
  EXPECT_FALSE(slave.silent());
  EXPECT_EQ(slave.deadline(), can::never);
}

TEST_F(LssSlaveTest, Store_KeepsPendingNodeIdAndRate_AndTellsHowItWent) {
  configuration();
  ask({0x11, 0x05});
  ask({0x13, 0x00, 0x04});
  EXPECT_THAT(ask({0x17}), ElementsAre("7E4 17 00 00 00 00 00 00 00"));
  EXPECT_EQ(stored_id, 5);
  EXPECT_EQ(stored_rate, 125'000U);
  result = Stored::failed;
  EXPECT_THAT(ask({0x17}), ElementsAre("7E4 17 02 00 00 00 00 00 00"));
  result = Stored::not_supported;
  EXPECT_THAT(ask({0x17}), ElementsAre("7E4 17 01 00 00 00 00 00 00"));
}

TEST_F(LssSlaveTest, Inquiries_GiveTheAddress) {
  configuration();
  EXPECT_THAT(ask({0x5A}), ElementsAre("7E4 5A 71 00 00 00 00 00 00"));
  EXPECT_THAT(ask({0x5B}), ElementsAre("7E4 5B 63 ED 00 00 00 00 00"));
  EXPECT_THAT(ask({0x5C}), ElementsAre("7E4 5C 00 00 01 00 00 00 00"));
  EXPECT_THAT(ask({0x5D}), ElementsAre("7E4 5D 78 56 34 12 00 00 00"));
}

TEST_F(LssSlaveTest, Identify_InsideTheRanges_IsAnswered) {
  ask({0x46, 0x71});
  ask({0x47, 0x63, 0xED});
  ask({0x48, 0x00, 0x00, 0x01, 0x00});
  ask({0x49, 0x00, 0x00, 0x01, 0x00});
  ask({0x4A, 0x00, 0x00, 0x00, 0x00});
  EXPECT_THAT(ask({0x4B, 0xFF, 0xFF, 0xFF, 0xFF}), ElementsAre("7E4 4F 00 00 00 00 00 00 00"));
}

TEST_F(LssSlaveTest, Identify_OutsideARange_IsNotAnswered) {
  ask({0x46, 0x71});
  ask({0x47, 0x63, 0xED});
  ask({0x48, 0x01, 0x00, 0x01, 0x00});
  ask({0x49, 0xFF, 0xFF, 0xFF, 0xFF});
  ask({0x4A});
  EXPECT_THAT(ask({0x4B, 0xFF, 0xFF, 0xFF, 0xFF}), IsEmpty());
}

TEST_F(LssSlaveTest, IdentifyUnconfigured_OnlyWithoutActiveAndPendingNodeId) {
  EXPECT_THAT(ask({0x4C}), ElementsAre("7E4 50 00 00 00 00 00 00 00"));
  configuration();
  ask({0x11, 0x05});
  EXPECT_THAT(ask({0x4C}), IsEmpty());
  slave.start(9, 250'000);
  EXPECT_THAT(ask({0x4C}), IsEmpty());
}

TEST_F(LssSlaveTest, Fastscan_AnswersMatchingBits_AndEndsInConfigurationState) {
  const auto scan = [&](std::uint32_t id, std::uint8_t bit, std::uint8_t part, std::uint8_t next) {
    return ask({0x51, static_cast<std::uint8_t>(id), static_cast<std::uint8_t>(id >> 8),
                static_cast<std::uint8_t>(id >> 16), static_cast<std::uint8_t>(id >> 24), bit, part, next});
  };
  const auto heard = ElementsAre("7E4 4F 00 00 00 00 00 00 00");
  EXPECT_THAT(scan(0, 0x80, 0, 0), heard);
  EXPECT_THAT(scan(0, 7, 0, 0), heard);      // bits 31..7 of 71H are 0
  EXPECT_THAT(scan(0, 6, 0, 0), IsEmpty());  // bit 6 is 1
  EXPECT_THAT(scan(0x40, 6, 0, 0), heard);
  EXPECT_THAT(scan(0, 31, 1, 1), IsEmpty());  // not the part in question
  EXPECT_THAT(scan(0x71, 0, 0, 1), heard);
  EXPECT_THAT(scan(0xED63, 0, 1, 2), heard);
  EXPECT_THAT(scan(0x00010000, 0, 2, 3), heard);
  EXPECT_EQ(slave.state(), lss::LssSlave::State::waiting);
  EXPECT_THAT(scan(0x12345678, 0, 3, 0), heard);
  EXPECT_EQ(slave.state(), lss::LssSlave::State::configuration);
}

TEST_F(LssSlaveTest, Fastscan_ConfiguredDevice_DoesNotAnswer) {
  slave.start(9, 250'000);
  EXPECT_THAT(ask({0x51, 0, 0, 0, 0, 0x80, 0, 0}), IsEmpty());
}

TEST_F(LssSlaveTest, ForeignFrames_AreIgnored) {
  slave.receive(can::data_frame(0x7E5, {0x04, 0x01}), now);  // too short
  slave.receive(can::data_frame(0x7E4, {0x04, 0x01, 0, 0, 0, 0, 0, 0}), now);
  slave.receive(can::remote_frame(0x7E5, 8), now);
  EXPECT_EQ(slave.state(), lss::LssSlave::State::waiting);
}

// --- master

class LssMasterTest : public ::testing::Test, public can::Sink, public lss::LssMasterUser {
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
  void hear(std::initializer_list<std::uint8_t> bytes) {
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
  hear({0x44});
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
  hear({0x11, 0x00});
  master.configure_node_id(5, now);
  hear({0x11, 0xFF, 0x07});
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
  hear({0x13, 0x00});
  master.activate_bit_timing(1000ms, now);
  wait(1ms);
  master.store(now);
  hear({0x17, 0x00});
  master.inquire(3, now);
  hear({0x5D, 0x78, 0x56, 0x34, 0x12});
  EXPECT_EQ(master.value(), 0x12345678U);
  master.inquire_node_id(now);
  hear({0x5E, 0x05});
  EXPECT_EQ(master.value(), 5U);
  master.identify_unconfigured(now);
  hear({0x50});
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
  hear({0x4F});
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
    hear({0x4F});
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
  hear({0x44});
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
  hear({0x4F});
  wait(100s);
  EXPECT_THAT(results, ElementsAre(lss::LssResult::lost));
}

TEST_F(LssMasterTest, AnswersToNothing_AreIgnored) {
  hear({0x44});
  master.store(now);
  hear({0x11, 0x00});
  EXPECT_THAT(results, IsEmpty());
}

// --- both

TEST(Lss, Fastscan_Finds32UnconfiguredDevices_AndGivesEachANodeId) {
  struct Device : lss::LssSlaveUser {
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
  struct Bus : can::Sink, lss::LssMasterUser {
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
}  // namespace canopus::manager::test
