#include "canopus/client/gateway/gateway.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/client/gateway/gateway_session.hpp"

#include "gateway_setup.hpp"

namespace canopus::client::gateway_test {
namespace {

using can::data_frame;
using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

class GatewayTest : public GatewaySetup {};

TEST_F(GatewayTest, ReadOfAnObject_IsAnsweredWithItsValueAndTheSequence) {
  send("[7] 1 5 r 0x1000 0 u32");
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0})));
  EXPECT_TRUE(session.waiting());
  receive(data_frame(0x585, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0}));
  EXPECT_THAT(ends.lines, ElementsAre("[7] 983441\r\n"));
  EXPECT_FALSE(session.waiting());
}

TEST_F(GatewayTest, WriteOfAnObject_IsAnsweredOk) {
  send("[8] 5 w 0x2000 1 u16 0x0A");
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x605, {0x2B, 0x00, 0x20, 1, 0x0A, 0, 0, 0})));
  receive(data_frame(0x585, {0x60, 0x00, 0x20, 1, 0, 0, 0, 0}));
  EXPECT_THAT(ends.lines, ElementsAre("[8] OK\r\n"));
}

TEST_F(GatewayTest, AbortOfTheServer_IsItsCode) {
  send("[9] 5 r 0x3000 0");
  receive(data_frame(0x585, {0x80, 0x00, 0x30, 0, 0, 0, 0x02, 0x06}));
  EXPECT_THAT(ends.lines, ElementsAre("[9] ERROR:0x06020000 #object does not exist\r\n"));
}

TEST_F(GatewayTest, SilentServer_IsAnSdoTimeOut) {
  EXPECT_EQ(answer_to("set sdo_timeout 200"), "OK");
  ends.lines.clear();
  send("[3] 5 r 0x1000 0 u32");
  pass(199ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  pass(1ms);
  ASSERT_EQ(ends.lines.size(), 1U);
  EXPECT_TRUE(ends.lines[0].starts_with("[3] ERROR:0x05040000")) << ends.lines[0];
}

TEST_F(GatewayTest, CommandTimeOut_EndsACommand) {
  EXPECT_EQ(answer_to("set command_timeout 100"), "OK");
  ends.lines.clear();
  send("[3] 5 r 0x1000 0 u32");
  pass(100ms);
  EXPECT_THAT(ends.lines, ElementsAre("[3] ERROR:103 #time-out\r\n"));
  EXPECT_EQ(ends.frames.back(), data_frame(0x605, {0x80, 0x00, 0x10, 0, 0, 0, 0x04, 0x05}));
}

TEST_F(GatewayTest, ValueOfAnotherLength_IsALengthMismatch) {
  send("5 r 0x1000 0 u16");
  receive(data_frame(0x585, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0}));
  EXPECT_TRUE(ends.lines.at(0).starts_with("ERROR:0x06070010")) << ends.lines[0];
}

TEST_F(GatewayTest, ValueWithoutItsSize_HasAsManyBytesAsTheType) {
  send("60 r 0x2000 0 u16");
  receive(data_frame(0x5BC, {0x42, 0x00, 0x20, 0, 0x34, 0x12, 0xAA, 0xBB}));
  EXPECT_THAT(ends.lines, ElementsAre("4660\r\n"));
  send("60 r 0x2000 0 i8");
  receive(data_frame(0x5BC, {0x42, 0x00, 0x20, 0, 0xFB, 0x12, 0xAA, 0xBB}));
  EXPECT_THAT(ends.lines, ElementsAre("-5\r\n"));
  send("60 r 0x2000 0 b");
  receive(data_frame(0x5BC, {0x42, 0x00, 0x20, 0, 0x01, 0x12, 0xAA, 0xBB}));
  EXPECT_THAT(ends.lines, ElementsAre("1\r\n"));
  send("60 r 0x2000 0 u32");
  receive(data_frame(0x5BC, {0x42, 0x00, 0x20, 0, 0x34, 0x12, 0, 0}));
  EXPECT_THAT(ends.lines, ElementsAre("4660\r\n"));
  send("60 r 0x2000 0 u64");
  receive(data_frame(0x5BC, {0x42, 0x00, 0x20, 0, 0x34, 0x12, 0, 0}));
  EXPECT_TRUE(ends.lines.at(0).starts_with("ERROR:0x06070010")) << ends.lines[0];
  send("60 r 0x2000 0");
  receive(data_frame(0x5BC, {0x42, 0x00, 0x20, 0, 0x34, 0x12, 0, 0}));
  EXPECT_THAT(ends.lines, ElementsAre("34 12 00 00 #size not indicated\r\n"));
}

TEST_F(GatewayTest, FourBytesOfAShorterType_AreItsValueIfTheOthersAre0) {
  send("60 r 0x2000 0 u16");
  receive(data_frame(0x5BC, {0x43, 0x00, 0x20, 0, 0x34, 0x12, 0, 0}));
  EXPECT_THAT(ends.lines, ElementsAre("4660 #4 bytes came, the others are 0\r\n"));
}

TEST_F(GatewayTest, AnswerOfFewerThan8Bytes_IsAnErrorThatNamesIt) {
  send("[5] 60 r 0x2000 0 u32");
  receive(data_frame(0x5BC, {0x43, 0x00, 0x20, 0, 0x92, 0x01, 0x02}));
  EXPECT_THAT(ends.lines, ElementsAre("[5] ERROR:0x06070013 #7 bytes, expected 8\r\n"));
  send("[6] 60 w 0x2000 0 u16 1");
  receive(data_frame(0x5BC, {0x60, 0x00, 0x20, 0}));
  EXPECT_THAT(ends.lines, ElementsAre("[6] ERROR:0x06070013 #4 bytes, expected 8\r\n"));
}

TEST_F(GatewayTest, CommandsBehindOneThatWaits_ComeAfterIt) {
  session.receive("[1] 5 r 0x1000 0 u32\n[2] set node 9\n[3] r 0x1001 0 u8\n", now);
  EXPECT_EQ(ends.frames.size(), 1U);
  gateway.receive(data_frame(0x585, {0x43, 0x00, 0x10, 0, 1, 0, 0, 0}), now);
  EXPECT_THAT(ends.lines, ElementsAre("[1] 1\r\n", "[2] OK\r\n"));
  EXPECT_EQ(ends.frames.at(1), data_frame(0x609, {0x40, 0x01, 0x10, 0, 0, 0, 0, 0}));
  gateway.receive(data_frame(0x589, {0x4F, 0x01, 0x10, 0, 0x11, 0, 0, 0}), now);
  EXPECT_EQ(ends.lines.back(), "[3] 17\r\n");
}

TEST_F(GatewayTest, TwoClientsOfOneNode_WaitForEachOther) {
  WireAndClient other;
  GatewaySession second(gateway, other);
  send("5 r 0x1000 0 u32");
  second.receive("5 r 0x1001 0 u8\n", now);
  EXPECT_EQ(ends.frames.size(), 1U);
  gateway.receive(data_frame(0x585, {0x43, 0x00, 0x10, 0, 1, 0, 0, 0}), now);
  EXPECT_EQ(ends.frames.size(), 2U);
  gateway.receive(data_frame(0x585, {0x4F, 0x01, 0x10, 0, 2, 0, 0, 0}), now);
  EXPECT_THAT(ends.lines, ElementsAre("1\r\n"));
  EXPECT_THAT(other.lines, ElementsAre("2\r\n"));
}

TEST_F(GatewayTest, ClientThatLeaves_GivesItsTurnToTheNext) {
  auto first = std::make_unique<GatewaySession>(gateway, ends);
  first->receive("5 r 0x1000 0 u32\n", now);
  send("[2] 5 r 0x1001 0 u8");
  first->end(now);
  first.reset();
  EXPECT_EQ(ends.frames.at(1).data[0], 0x80) << "an abort";
  EXPECT_EQ(ends.frames.at(2), data_frame(0x605, {0x40, 0x01, 0x10, 0, 0, 0, 0, 0}));
  gateway.receive(data_frame(0x585, {0x4F, 0x01, 0x10, 0, 2, 0, 0, 0}), now);
  EXPECT_THAT(ends.lines, ElementsAre("[2] 2\r\n"));
}

TEST_F(GatewayTest, FullBus_FailsManyCommandsOneByOne) {
  ends.full = true;
  std::string many;
  for (int i = 0; i < 3000; ++i) many += "5 r 0x1000 0\n";
  session.receive(many, now);
  EXPECT_EQ(ends.lines.size(), 3000U);
}

TEST_F(GatewayTest, NmtCommands_AreTheirFrames) {
  EXPECT_EQ(answer_to("[1] 5 start"), "[1] OK");
  EXPECT_EQ(answer_to("1 0 stop"), "OK");
  EXPECT_EQ(answer_to("5 preop"), "OK");
  EXPECT_EQ(answer_to("5 preoperational"), "OK");
  EXPECT_EQ(answer_to("5 reset node"), "OK");
  EXPECT_EQ(answer_to("5 reset comm"), "OK");
  EXPECT_EQ(answer_to("5 reset communication"), "OK");
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0, {1, 5}), data_frame(0, {2, 0}), data_frame(0, {0x80, 5}),
                                       data_frame(0, {0x80, 5}), data_frame(0, {0x81, 5}),
                                       data_frame(0, {0x82, 5}), data_frame(0, {0x82, 5})));
}

TEST_F(GatewayTest, WrongLines_AreTheirErrorAndSendNothing) {
  EXPECT_EQ(answer_to("[4] r 0x1000 0 u32"), "[4] ERROR:105 #no default node set");
  EXPECT_EQ(answer_to("2 5 r 0x1000 0 u32"), "ERROR:106 #unsupported network");
  EXPECT_EQ(answer_to("128 start"), "ERROR:107 #unsupported node");
  EXPECT_EQ(answer_to("0 r 0x1000 0"), "ERROR:107 #unsupported node");
  EXPECT_EQ(answer_to("2 lss_store"), "ERROR:106 #unsupported network");
  EXPECT_EQ(answer_to("1 5 set command_timeout 1"), "ERROR:106 #unsupported network");
  for (const char* text : {"hello",
                           "[x] 5 start",
                           "[1 5 start",
                           "[1] [2] start",
                           "5 r",
                           "5 r 0x10000 0",
                           "5 r 0x1000 256",
                           "5 r 0x1000 0 u12",
                           "5 r 0x1000 0 u32 9",
                           "5 w 0x1000 0",
                           "5 w 0x1000 0 u8",
                           "5 w 0x1000 0 u8 256",
                           "5 w 0x1000 0 i8 -129",
                           "5 w 0x1000 0 u8 1 2",
                           "5 w 0x1000 0 vs \"open",
                           "1 2 3 start",
                           "5 reset",
                           "5 start now",
                           "set node",
                           "set node x",
                           "set speed 1",
                           "set rpdox 1 0x205 event 0 0 1 u8",
                           "set command_size 31",
                           "init",
                           "init 10",
                           "init 0 1",
                           "lss_hello",
                           "lss_switch_glob 2",
                           "lss_switch_sel 1 2 3",
                           "lss_set_node 0",
                           "lss_conf_bitrate 2",
                           "lss_activate_bitrate 65536",
                           "lss_store now",
                           "lss_inquire_addr 4",
                           "lss_identity 1 2 4 3 0 0",
                           "_lss_fastscan 0",
                           "_lss_fastscan 1 2 3",
                           "lss_allnodes 100 128",
                           "[4294967296] 5 start",
                           "info",
                           "boot_up_indication Maybe",
                           "99999999999999999999 start"}) {
    const std::string answer = answer_to(text);
    EXPECT_TRUE(answer.ends_with("ERROR:101 #syntax error")) << text << ": " << answer;
  }
  EXPECT_THAT(ends.frames, IsEmpty());
}

TEST_F(GatewayTest, CommentsAndEmptyLines_AreNothing) {
  EXPECT_EQ(answer_to(""), "(nothing)");
  EXPECT_EQ(answer_to("# 5 start"), "(nothing)");
  EXPECT_EQ(answer_to("5 start # the drive"), "OK");
}

TEST_F(GatewayTest, EventsOfNodes_AreLines) {
  receive(data_frame(0x705, {0x00}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 BOOT_UP\r\n"));
  receive(data_frame(0x085, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 EMCY 8130 11 1 2 3 4 5\r\n"));
  EXPECT_EQ(answer_to("boot_up_indication Disable"), "OK");
  receive(data_frame(0x705, {0x00}));
  EXPECT_THAT(ends.lines, IsEmpty());
}

TEST_F(GatewayTest, WatchedHeartbeat_IsReportedWhenItStartsChangesAndIsLost) {
  EXPECT_EQ(answer_to("5 enable heartbeat 100"), "OK");
  receive(data_frame(0x705, {0x7F}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERROR 202 #heartbeat started\r\n", "1 5 ERRORx PREO\r\n"));
  pass(50ms);
  receive(data_frame(0x705, {0x05}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERRORx OPER\r\n"));
  ends.lines.clear();
  pass(99ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  pass(1ms);
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERROR 203 #heartbeat lost\r\n"));
  EXPECT_EQ(answer_to("5 disable heartbeat"), "OK");
  receive(data_frame(0x705, {0x05}));
  EXPECT_THAT(ends.lines, IsEmpty());
}

TEST_F(GatewayTest, Guarding_AsksAndReportsTheLostNodeOnce) {
  EXPECT_EQ(answer_to("5 enable guarding 100 2"), "OK");
  pass(0ms);
  EXPECT_THAT(ends.frames, ElementsAre(can::remote_frame(0x705, 1)));
  receive(data_frame(0x705, {0x85}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERRORx OPER\r\n"));
  ends.lines.clear();
  pass(199ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  pass(1ms);
  EXPECT_EQ(ends.lines.at(0), "1 5 ERROR 200 #lost guarding message\r\n");
  EXPECT_THAT(ends.lines, ElementsAre(testing::_, "1 5 ERROR 201 #lost connection\r\n"));
  pass(500ms);
  EXPECT_EQ(ends.lines.size(), 2U) << "each is said once";
}

TEST_F(GatewayTest, GuardedNodeThatMissesOneAnswer_IsALostMessageAndStaysConnected) {
  EXPECT_EQ(answer_to("5 enable guarding 100 3"), "OK");
  pass(0ms);
  receive(data_frame(0x705, {0x85}));
  pass(150ms);
  receive(data_frame(0x705, {0x05}));
  pass(100ms);
  receive(data_frame(0x705, {0x85}));
  EXPECT_THAT(ends.lines, IsEmpty());
  // Asked at 300 ms without an answer, and again at 400 ms: one is lost. The life time would end at 550 ms.
  pass(149ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  pass(1ms);
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERROR 200 #lost guarding message\r\n"));
  receive(data_frame(0x705, {0x05}));
  EXPECT_THAT(ends.lines, IsEmpty());
}

TEST_F(GatewayTest, WatchedNodeThatLeavesTheStateItWasSentTo_IsInAWrongState) {
  EXPECT_EQ(answer_to("5 enable heartbeat 100"), "OK");
  EXPECT_EQ(answer_to("5 start"), "OK");
  receive(data_frame(0x705, {0x7F}));  // sent before the command came
  receive(data_frame(0x705, {0x05}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERRORx OPER\r\n"));
  receive(data_frame(0x705, {0x04}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERRORx STOP\r\n", "1 5 ERROR 204 #wrong NMT state\r\n"));
  EXPECT_EQ(answer_to("5 reset node"), "OK");
  receive(data_frame(0x705, {0x05}));
  receive(data_frame(0x705, {0x7F}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERRORx PREO\r\n"));
  EXPECT_EQ(answer_to("5 start"), "OK");
  gateway.reset(now);
  EXPECT_EQ(answer_to("5 enable heartbeat 100"), "OK");
  receive(data_frame(0x705, {0x05}));
  receive(data_frame(0x705, {0x7F}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERRORx PREO\r\n")) << "commands before a reset are forgotten";
}

TEST_F(GatewayTest, StateOfTheController_IsAnEvent) {
  gateway.controller_error(GatewayError::error_passive);
  gateway.controller_error(GatewayError::bus_off);
  EXPECT_THAT(ends.lines, ElementsAre("1 ERROR 300 #error passive\r\n", "1 ERROR 301 #bus-off\r\n"));
}

TEST_F(GatewayTest, BusThatTakesNoFrame_IsAnOverflow) {
  ends.full = true;
  EXPECT_EQ(answer_to("5 start"), "ERROR:303 #CAN buffer overflow");
}

TEST_F(GatewayTest, Init_StartsTheControllerAtTheRateOfItsIndexAndForgetsWhatWasSet) {
  std::vector<std::uint32_t> rates;
  gateway.set_restart([&](std::uint32_t rate) {
    rates.push_back(rate);
    return std::expected<void, std::string>();
  });
  WireAndClient other;
  GatewaySession second(gateway, other);
  second.receive("[1] 5 r 0x1000 0 u32\n[2] lss_get_node\n", now);
  EXPECT_EQ(answer_to("set id 7"), "OK");
  EXPECT_EQ(answer_to("set heartbeat 100"), "OK");
  EXPECT_EQ(answer_to("9 enable heartbeat 100"), "OK");
  EXPECT_EQ(answer_to("set rpdo 1 0x185 event 1 u8"), "OK");
  ends.frames.clear();
  EXPECT_EQ(answer_to("init 3"), "OK");
  EXPECT_THAT(rates, ElementsAre(250'000U));
  EXPECT_THAT(ends.frames, testing::Contains(data_frame(0x707, {0})));
  ASSERT_EQ(other.lines.size(), 2U);
  EXPECT_TRUE(other.lines[0].starts_with("[1] ERROR:0x08000021")) << other.lines[0];
  EXPECT_TRUE(other.lines[1].starts_with("[2] ERROR:102")) << other.lines[1];
  ends.frames.clear();
  receive(data_frame(0x185, {1}));
  EXPECT_THAT(ends.lines, IsEmpty());
  receive(data_frame(0x709, {5}));
  pass(1s);
  EXPECT_THAT(ends.lines, IsEmpty());
  EXPECT_THAT(ends.frames, IsEmpty());
}

TEST_F(GatewayTest, InitThatCannotBe_ChangesNothing) {
  EXPECT_EQ(answer_to("set rpdo 1 0x185 event 1 u8"), "OK");
  EXPECT_EQ(answer_to("[5] init 3"),
            "[5] ERROR:304 #CAN init: the bit rate of this bus is not set from here");
  EXPECT_EQ(answer_to("init 5"), "ERROR:100 #request not supported");
  EXPECT_EQ(answer_to("init 9"), "ERROR:100 #request not supported");
  receive(data_frame(0x185, {1}));
  EXPECT_THAT(ends.lines, ElementsAre("1 pdo 1 1 0x1\r\n"));
}

TEST_F(GatewayTest, OwnHeartbeat_NeedsANodeId) {
  EXPECT_TRUE(answer_to("set heartbeat 100").starts_with("ERROR:102"));
  EXPECT_EQ(answer_to("set id 7"), "OK");
  EXPECT_EQ(answer_to("set heartbeat 100"), "OK");
  pass(250ms);
  EXPECT_THAT(ends.frames,
              ElementsAre(data_frame(0x707, {5}), data_frame(0x707, {5}), data_frame(0x707, {5})));
  EXPECT_EQ(answer_to("set heartbeat 0"), "OK");
  pass(250ms);
  EXPECT_EQ(ends.frames.size(), 3U);
}

TEST_F(GatewayTest, Version_IsInfo) { EXPECT_EQ(answer_to("[1] info version"), "[1] 0 0 0.0 0 3 2.1 1.2"); }

RC_GTEST_PROP(GatewayProperties, CutAnywhere_TheConversationIsTheSame, ()) {
  const std::string text = "[1] 5 start\r\nset node 9\n[2] start # x\n\n[3] boo\r\ninfo version\r\n";
  const auto answers = [&](bool whole) {
    WireAndClient ends;
    Gateway gateway(ends, 0, "1");
    GatewaySession session(gateway, ends);
    for (std::string_view rest = text; !rest.empty();) {
      const auto size = whole ? rest.size() : *rc::gen::inRange<std::size_t>(1, rest.size() + 1);
      session.receive(rest.substr(0, size), {});
      rest.remove_prefix(size);
    }
    return ends.lines;
  };
  RC_ASSERT(answers(false) == answers(true));
}

}  // namespace
}  // namespace canopus::client::gateway_test
