// LSS slave [CiA 305] in literal frames.

#include "canopus/lss/lss_slave.hpp"

#include <deque>
#include <list>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "canopus/lss/lss_master.hpp"

#include "master_bench.hpp"

namespace canopus::manager::test::lss_slave_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr lss::LssAddress address{0x00000071, 0x0000ED63, 0x00010000, 0x12345678};

class LssSlaveTest : public ::testing::Test, public can::Sink, public lss::LssSlaveListener {
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
  std::vector<std::string> request(std::initializer_list<std::uint8_t> bytes) {
    std::vector<std::uint8_t> data(bytes);
    data.resize(8);
    slave.receive(can::data_frame(0x7E5, data), now);
    return std::exchange(lines, {});
  }
  void configuration() { request({0x04, 0x01}); }

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
  EXPECT_THAT(request({0x04, 0x01}), IsEmpty());
  EXPECT_EQ(slave.state(), lss::LssSlave::State::configuration);
  EXPECT_THAT(request({0x04, 0x00}), IsEmpty());
  EXPECT_EQ(slave.state(), lss::LssSlave::State::waiting);
  request({0x04, 0x02});
  EXPECT_EQ(slave.state(), lss::LssSlave::State::waiting);
}

TEST_F(LssSlaveTest, SwitchSelective_AllFourPartsMatch_IsAnswered) {
  EXPECT_THAT(request({0x40, 0x71, 0x00, 0x00, 0x00}), IsEmpty());
  EXPECT_THAT(request({0x41, 0x63, 0xED, 0x00, 0x00}), IsEmpty());
  EXPECT_THAT(request({0x42, 0x00, 0x00, 0x01, 0x00}), IsEmpty());
  EXPECT_THAT(request({0x43, 0x78, 0x56, 0x34, 0x12}), ElementsAre("7E4 44 00 00 00 00 00 00 00"));
  EXPECT_EQ(slave.state(), lss::LssSlave::State::configuration);
}

TEST_F(LssSlaveTest, SwitchSelective_OnePartDiffers_StaysWaiting) {
  request({0x40, 0x71, 0x00, 0x00, 0x00});
  request({0x41, 0x64, 0xED, 0x00, 0x00});
  request({0x42, 0x00, 0x00, 0x01, 0x00});
  EXPECT_THAT(request({0x43, 0x78, 0x56, 0x34, 0x12}), IsEmpty());
  EXPECT_EQ(slave.state(), lss::LssSlave::State::waiting);
}

TEST_F(LssSlaveTest, SwitchSelective_OutOfOrder_StaysWaiting) {
  request({0x41, 0x63, 0xED, 0x00, 0x00});
  request({0x40, 0x71, 0x00, 0x00, 0x00});
  request({0x42, 0x00, 0x00, 0x01, 0x00});
  EXPECT_THAT(request({0x43, 0x78, 0x56, 0x34, 0x12}), IsEmpty());
}

TEST_F(LssSlaveTest, ConfigurationServices_AreNotHeardWhileWaiting) {
  EXPECT_THAT(request({0x11, 0x05}), IsEmpty());
  EXPECT_THAT(request({0x17}), IsEmpty());
  EXPECT_THAT(request({0x5A}), IsEmpty());
}

TEST_F(LssSlaveTest, NodeId_IsPending_UntilTheSlaveIsSwitchedToWaiting) {
  configuration();
  EXPECT_THAT(request({0x11, 0x05}), ElementsAre("7E4 11 00 00 00 00 00 00 00"));
  EXPECT_EQ(slave.pending_node_id(), 5);
  EXPECT_EQ(assigned, 0);
  EXPECT_THAT(request({0x5E}), ElementsAre("7E4 5E FF 00 00 00 00 00 00"));
  request({0x04, 0x00});
  EXPECT_EQ(assigned, 5);
}

TEST_F(LssSlaveTest, NodeIdOfAConfiguredDevice_WaitsForItsNextReset) {
  slave.start(9, 250'000);
  configuration();
  request({0x11, 0x05});
  request({0x04, 0x00});
  EXPECT_EQ(assigned, 0);
  EXPECT_EQ(slave.pending_node_id(), 5);
}

TEST_F(LssSlaveTest, NodeIdOutOfRange_IsRefused) {
  configuration();
  for (const std::uint8_t id : {std::uint8_t{0}, std::uint8_t{128}, std::uint8_t{254}}) {
    EXPECT_THAT(request({0x11, id}), ElementsAre("7E4 11 01 00 00 00 00 00 00"));
  }
  EXPECT_THAT(request({0x11, 0xFF}), ElementsAre("7E4 11 00 00 00 00 00 00 00"));
}

TEST_F(LssSlaveTest, BitTiming_TableAndIndexAreChecked) {
  configuration();
  EXPECT_THAT(request({0x13, 0x00, 0x02}), ElementsAre("7E4 13 00 00 00 00 00 00 00"));
  EXPECT_THAT(request({0x13, 0x00, 0x05}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  EXPECT_THAT(request({0x13, 0x00, 0x08}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  EXPECT_THAT(request({0x13, 0x00, 0x09}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
  EXPECT_THAT(request({0x13, 0x01, 0x02}), ElementsAre("7E4 13 01 00 00 00 00 00 00"));
}

TEST_F(LssSlaveTest, Activate_IsSilentForTheDelay_ChangesTheRate_AndIsSilentAgain) {
  configuration();
  request({0x13, 0x00, 0x02});
  EXPECT_THAT(request({0x15, 0xE8, 0x03}), IsEmpty());
  EXPECT_TRUE(slave.silent());
  EXPECT_EQ(slave.deadline(), can::Time(1s));
  EXPECT_THAT(request({0x5E}), IsEmpty());
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
  request({0x11, 0x05});
  request({0x13, 0x00, 0x04});
  EXPECT_THAT(request({0x17}), ElementsAre("7E4 17 00 00 00 00 00 00 00"));
  EXPECT_EQ(stored_id, 5);
  EXPECT_EQ(stored_rate, 125'000U);
  result = Stored::failed;
  EXPECT_THAT(request({0x17}), ElementsAre("7E4 17 02 00 00 00 00 00 00"));
  result = Stored::not_supported;
  EXPECT_THAT(request({0x17}), ElementsAre("7E4 17 01 00 00 00 00 00 00"));
}

TEST_F(LssSlaveTest, Inquiries_GiveTheAddress) {
  configuration();
  EXPECT_THAT(request({0x5A}), ElementsAre("7E4 5A 71 00 00 00 00 00 00"));
  EXPECT_THAT(request({0x5B}), ElementsAre("7E4 5B 63 ED 00 00 00 00 00"));
  EXPECT_THAT(request({0x5C}), ElementsAre("7E4 5C 00 00 01 00 00 00 00"));
  EXPECT_THAT(request({0x5D}), ElementsAre("7E4 5D 78 56 34 12 00 00 00"));
}

TEST_F(LssSlaveTest, Identify_InsideTheRanges_IsAnswered) {
  request({0x46, 0x71});
  request({0x47, 0x63, 0xED});
  request({0x48, 0x00, 0x00, 0x01, 0x00});
  request({0x49, 0x00, 0x00, 0x01, 0x00});
  request({0x4A, 0x00, 0x00, 0x00, 0x00});
  EXPECT_THAT(request({0x4B, 0xFF, 0xFF, 0xFF, 0xFF}), ElementsAre("7E4 4F 00 00 00 00 00 00 00"));
}

TEST_F(LssSlaveTest, Identify_OutsideARange_IsNotAnswered) {
  request({0x46, 0x71});
  request({0x47, 0x63, 0xED});
  request({0x48, 0x01, 0x00, 0x01, 0x00});
  request({0x49, 0xFF, 0xFF, 0xFF, 0xFF});
  request({0x4A});
  EXPECT_THAT(request({0x4B, 0xFF, 0xFF, 0xFF, 0xFF}), IsEmpty());
}

TEST_F(LssSlaveTest, IdentifyUnconfigured_OnlyWithoutActiveAndPendingNodeId) {
  EXPECT_THAT(request({0x4C}), ElementsAre("7E4 50 00 00 00 00 00 00 00"));
  configuration();
  request({0x11, 0x05});
  EXPECT_THAT(request({0x4C}), IsEmpty());
  slave.start(9, 250'000);
  EXPECT_THAT(request({0x4C}), IsEmpty());
}

TEST_F(LssSlaveTest, Fastscan_AnswersMatchingBits_AndEndsInConfigurationState) {
  const auto scan = [&](std::uint32_t id, std::uint8_t bit, std::uint8_t part, std::uint8_t next) {
    return request({0x51, static_cast<std::uint8_t>(id), static_cast<std::uint8_t>(id >> 8),
                    static_cast<std::uint8_t>(id >> 16), static_cast<std::uint8_t>(id >> 24), bit, part,
                    next});
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
  EXPECT_THAT(request({0x51, 0, 0, 0, 0, 0x80, 0, 0}), IsEmpty());
}

TEST_F(LssSlaveTest, ForeignFrames_AreIgnored) {
  slave.receive(can::data_frame(0x7E5, {0x04, 0x01}), now);  // too short
  slave.receive(can::data_frame(0x7E4, {0x04, 0x01, 0, 0, 0, 0, 0, 0}), now);
  slave.receive(can::remote_frame(0x7E5, 8), now);
  EXPECT_EQ(slave.state(), lss::LssSlave::State::waiting);
}

}  // namespace
}  // namespace canopus::manager::test::lss_slave_test
