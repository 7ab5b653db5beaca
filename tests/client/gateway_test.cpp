#include "canopus/client/gateway/gateway.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/client/gateway/gateway_session.hpp"
#include "canopus/client/gateway/gateway_value.hpp"

namespace canopus::client {
namespace {

using can::data_frame;
using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

struct WireAndClient : can::Sink, GatewaySession::Peer {
  bool send(const can::Frame& frame) override {
    if (full) return false;
    frames.push_back(frame);
    return true;
  }
  void say(std::string_view line) override { lines.emplace_back(line); }

  std::vector<can::Frame> frames;
  std::vector<std::string> lines;
  bool full = false;
};

class GatewayTest : public testing::Test {
 protected:
  void say(const std::string& text) { session.receive(text + "\r\n", now); }
  /// The answer to one line.
  std::string ask(const std::string& text) {
    ends.lines.clear();
    say(text);
    return ends.lines.empty() ? "(nothing)" : ends.lines.back().substr(0, ends.lines.back().find("\r\n"));
  }
  void hear(const can::Frame& frame) {
    ends.lines.clear();
    gateway.receive(frame, now);
  }
  void pass(can::Duration time) {
    const can::Time end = now + time;
    while (std::min(gateway.deadline(), session.deadline()) <= end) {
      now = std::max(now, std::min(gateway.deadline(), session.deadline()));
      if (gateway.deadline() <= now) gateway.tick(now);
      if (session.deadline() <= now) session.tick(now);
    }
    now = end;
  }
  can::Time now{};
  WireAndClient ends;
  Gateway gateway{ends, 0, "1.2"};
  GatewaySession session{gateway, ends};
};

TEST_F(GatewayTest, ReadOfAnObject_IsAnsweredWithItsValueAndTheSequence) {
  say("[7] 1 5 r 0x1000 0 u32");
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0})));
  EXPECT_TRUE(session.waiting());
  hear(data_frame(0x585, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0}));
  EXPECT_THAT(ends.lines, ElementsAre("[7] 983441\r\n"));
  EXPECT_FALSE(session.waiting());
}

TEST_F(GatewayTest, WriteOfAnObject_IsAnsweredOk) {
  say("[8] 5 w 0x2000 1 u16 0x0A");
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x605, {0x2B, 0x00, 0x20, 1, 0x0A, 0, 0, 0})));
  hear(data_frame(0x585, {0x60, 0x00, 0x20, 1, 0, 0, 0, 0}));
  EXPECT_THAT(ends.lines, ElementsAre("[8] OK\r\n"));
}

TEST_F(GatewayTest, AbortOfTheServer_IsItsCode) {
  say("[9] 5 r 0x3000 0");
  hear(data_frame(0x585, {0x80, 0x00, 0x30, 0, 0, 0, 0x02, 0x06}));
  EXPECT_THAT(ends.lines, ElementsAre("[9] ERROR:0x06020000 #object does not exist\r\n"));
}

TEST_F(GatewayTest, SilentServer_IsAnSdoTimeOut) {
  EXPECT_EQ(ask("set sdo_timeout 200"), "OK");
  ends.lines.clear();
  say("[3] 5 r 0x1000 0 u32");
  pass(199ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  pass(1ms);
  ASSERT_EQ(ends.lines.size(), 1U);
  EXPECT_TRUE(ends.lines[0].starts_with("[3] ERROR:0x05040000")) << ends.lines[0];
}

TEST_F(GatewayTest, CommandTimeOut_EndsACommand) {
  EXPECT_EQ(ask("set command_timeout 100"), "OK");
  ends.lines.clear();
  say("[3] 5 r 0x1000 0 u32");
  pass(100ms);
  EXPECT_THAT(ends.lines, ElementsAre("[3] ERROR:103 #time-out\r\n"));
  EXPECT_EQ(ends.frames.back(), data_frame(0x605, {0x80, 0x00, 0x10, 0, 0, 0, 0x04, 0x05}));
}

TEST_F(GatewayTest, ValueOfAnotherLength_IsALengthMismatch) {
  say("5 r 0x1000 0 u16");
  hear(data_frame(0x585, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0}));
  EXPECT_TRUE(ends.lines.at(0).starts_with("ERROR:0x06070010")) << ends.lines[0];
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
  say("5 r 0x1000 0 u32");
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
  say("[2] 5 r 0x1001 0 u8");
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
  EXPECT_EQ(ask("[1] 5 start"), "[1] OK");
  EXPECT_EQ(ask("1 0 stop"), "OK");
  EXPECT_EQ(ask("5 preop"), "OK");
  EXPECT_EQ(ask("5 preoperational"), "OK");
  EXPECT_EQ(ask("5 reset node"), "OK");
  EXPECT_EQ(ask("5 reset comm"), "OK");
  EXPECT_EQ(ask("5 reset communication"), "OK");
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0, {1, 5}), data_frame(0, {2, 0}), data_frame(0, {0x80, 5}),
                                       data_frame(0, {0x80, 5}), data_frame(0, {0x81, 5}),
                                       data_frame(0, {0x82, 5}), data_frame(0, {0x82, 5})));
}

TEST_F(GatewayTest, WrongLines_AreTheirErrorAndSendNothing) {
  EXPECT_EQ(ask("[4] r 0x1000 0 u32"), "[4] ERROR:105 #no default node set");
  EXPECT_EQ(ask("2 5 r 0x1000 0 u32"), "ERROR:106 #unsupported network");
  EXPECT_EQ(ask("128 start"), "ERROR:107 #unsupported node");
  EXPECT_EQ(ask("0 r 0x1000 0"), "ERROR:107 #unsupported node");
  EXPECT_EQ(ask("[5] init 3"), "[5] ERROR:100 #request not supported");
  EXPECT_EQ(ask("lss_store"), "ERROR:100 #request not supported");
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
                           "[4294967296] 5 start",
                           "info",
                           "boot_up_indication Maybe",
                           "99999999999999999999 start"}) {
    const std::string answer = ask(text);
    EXPECT_TRUE(answer.ends_with("ERROR:101 #syntax error")) << text << ": " << answer;
  }
  EXPECT_THAT(ends.frames, IsEmpty());
}

TEST_F(GatewayTest, CommentsAndEmptyLines_AreNothing) {
  EXPECT_EQ(ask(""), "(nothing)");
  EXPECT_EQ(ask("# 5 start"), "(nothing)");
  EXPECT_EQ(ask("5 start # the drive"), "OK");
}

TEST_F(GatewayTest, LineWithoutEnd_IsASyntaxErrorOnceItEnds) {
  session.receive(std::string(200'000, 'x'), now);
  EXPECT_THAT(ends.lines, IsEmpty());
  session.receive("\r\n5 start\r\n", now);
  EXPECT_THAT(ends.lines, ElementsAre("ERROR:101 #syntax error\r\n", "OK\r\n"));
}

TEST_F(GatewayTest, EventsOfNodes_AreLines) {
  hear(data_frame(0x705, {0x00}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 BOOT_UP\r\n"));
  hear(data_frame(0x085, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 EMCY 8130 11 1 2 3 4 5\r\n"));
  EXPECT_EQ(ask("boot_up_indication Disable"), "OK");
  hear(data_frame(0x705, {0x00}));
  EXPECT_THAT(ends.lines, IsEmpty());
}

TEST_F(GatewayTest, WatchedHeartbeat_IsReportedWhenItStartsChangesAndIsLost) {
  EXPECT_EQ(ask("5 enable heartbeat 100"), "OK");
  hear(data_frame(0x705, {0x7F}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERROR 202 #heartbeat started\r\n", "1 5 ERRORx PREO\r\n"));
  pass(50ms);
  hear(data_frame(0x705, {0x05}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERRORx OPER\r\n"));
  ends.lines.clear();
  pass(99ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  pass(1ms);
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERROR 203 #heartbeat lost\r\n"));
  EXPECT_EQ(ask("5 disable heartbeat"), "OK");
  hear(data_frame(0x705, {0x05}));
  EXPECT_THAT(ends.lines, IsEmpty());
}

TEST_F(GatewayTest, Guarding_AsksAndReportsTheLostNodeOnce) {
  EXPECT_EQ(ask("5 enable guarding 100 2"), "OK");
  pass(0ms);
  EXPECT_THAT(ends.frames, ElementsAre(can::remote_frame(0x705, 1)));
  hear(data_frame(0x705, {0x85}));
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERRORx OPER\r\n"));
  ends.lines.clear();
  pass(500ms);
  EXPECT_THAT(ends.lines, ElementsAre("1 5 ERROR 200 #lost guarding message\r\n"));
}

TEST_F(GatewayTest, OwnHeartbeat_NeedsANodeId) {
  EXPECT_TRUE(ask("set heartbeat 100").starts_with("ERROR:102"));
  EXPECT_EQ(ask("set id 7"), "OK");
  EXPECT_EQ(ask("set heartbeat 100"), "OK");
  pass(250ms);
  EXPECT_THAT(ends.frames,
              ElementsAre(data_frame(0x707, {5}), data_frame(0x707, {5}), data_frame(0x707, {5})));
  EXPECT_EQ(ask("set heartbeat 0"), "OK");
  pass(250ms);
  EXPECT_EQ(ends.frames.size(), 3U);
}

TEST_F(GatewayTest, ReceivedPdo_IsAnEventAndCanBeRead) {
  EXPECT_TRUE(ask("r p 2").starts_with("ERROR:102"));
  EXPECT_EQ(ask("set rpdo 2 0x185 event 3 u8 u16 b"), "OK");
  hear(data_frame(0x185, {0x12, 0x34, 0x56, 0x01}));
  EXPECT_THAT(ends.lines, ElementsAre("1 pdo 2 3 0x12 0x5634 0x1\r\n"));
  EXPECT_EQ(ask("[6] 1 r pdo 2"), "[6] 1 pdo 3 0x12 0x5634 0x1");
  hear(data_frame(0x185, {0x12}));
  EXPECT_THAT(ends.lines, ElementsAre("1 ERROR 401 #PDO length exceeded\r\n"));
}

TEST_F(GatewayTest, SynchronousPdos_WaitForTheirSync) {
  EXPECT_EQ(ask("set rpdo 1 0x185 sync2 1 u8"), "OK");
  EXPECT_EQ(ask("set tpdo 1 0x205 sync1 2 u8 u16"), "OK");
  EXPECT_EQ(ask("w p 1 2 0x11 0x2233"), "OK");
  hear(data_frame(0x185, {9}));
  EXPECT_THAT(ends.lines, IsEmpty());
  EXPECT_THAT(ends.frames, IsEmpty());
  hear(data_frame(0x080));
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {0x11, 0x33, 0x22})));
  hear(data_frame(0x080));
  EXPECT_THAT(ends.lines, ElementsAre("1 pdo 1 1 0x9\r\n"));
}

TEST_F(GatewayTest, PdoThatDoesNotFit_IsRefused) {
  EXPECT_TRUE(ask("set tpdo 1 0x205 event 2 u64 u8").starts_with("ERROR:401"));
  EXPECT_TRUE(ask("set tpdo 1 0x205 rtr 1 u8").starts_with("ERROR:100"));
  EXPECT_TRUE(ask("set tpdo 0 0x205 event 1 u8").starts_with("ERROR:101"));
  EXPECT_EQ(ask("set tpdo 1 0x205 event 2 u8 u8"), "OK");
  EXPECT_TRUE(ask("w p 1 1 5").starts_with("ERROR:401"));
  EXPECT_TRUE(ask("w p 1 2 5 256").starts_with("ERROR:401"));
  EXPECT_TRUE(ask("w p 2 1 5").starts_with("ERROR:102"));
  EXPECT_EQ(ask("w pdo 1 2 5 255"), "OK");
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {5, 255})));
}

TEST_F(GatewayTest, Version_IsInfo) { EXPECT_EQ(ask("[1] info version"), "[1] 0 0 0.0 0 3 2.1 1.2"); }

struct ValueRow {
  const char* type;
  const char* text;
  std::vector<std::uint8_t> bytes;
  const char* shown;
};
class GatewayValue : public testing::TestWithParam<ValueRow> {};

TEST_P(GatewayValue, IsEncodedAndShown) {
  const auto type = parse_gateway_type(GetParam().type);
  ASSERT_TRUE(type);
  EXPECT_EQ(encode_gateway_value(GetParam().text, *type), GetParam().bytes);
  EXPECT_EQ(show_gateway_value(GetParam().bytes, *type), GetParam().shown);
}

INSTANTIATE_TEST_SUITE_P(
    Types, GatewayValue,
    testing::Values(
        ValueRow{"b", "1", {1}, "1"}, ValueRow{"i8", "-5", {0xFB}, "-5"},
        ValueRow{"i16", "-32768", {0, 0x80}, "-32768"}, ValueRow{"i24", "-2", {0xFE, 0xFF, 0xFF}, "-2"},
        ValueRow{"u32", "0x10", {0x10, 0, 0, 0}, "16"}, ValueRow{"u8", "010", {8}, "8"},
        ValueRow{"u40", "4294967296", {0, 0, 0, 0, 1}, "4294967296"},
        ValueRow{"i64", "-9223372036854775808", {0, 0, 0, 0, 0, 0, 0, 0x80}, "-9223372036854775808"},
        ValueRow{"x16", "255", {0xFF, 0}, "0x00FF"}, ValueRow{"r32", "1.5", {0, 0, 0xC0, 0x3F}, "1.5"},
        ValueRow{"r64", "-2", {0, 0, 0, 0, 0, 0, 0, 0xC0}, "-2"},
        ValueRow{"t", "2 1000", {0xE8, 3, 0, 0, 2, 0}, "2 1000"},
        ValueRow{"vs", "\"a \"\"b\"\"\"", {'a', ' ', '"', 'b', '"'}, "\"a \"\"b\"\"\""},
        ValueRow{"os", "AQID/w==", {1, 2, 3, 0xFF}, "AQID/w=="}, ValueRow{"d", "AQI=", {1, 2}, "AQI="},
        ValueRow{"d", "AQID", {1, 2, 3}, "AQID"}, ValueRow{"hex", "01 FFab", {1, 0xFF, 0xAB}, "01 FF AB"}));

TEST(GatewayValueText, ControlCharactersOfANode_StayInTheirLine) {
  const std::vector<std::uint8_t> bytes = {'a', '\r', '\n', 0x1B, 'b', 0, 0};
  EXPECT_EQ(show_gateway_value(bytes, *parse_gateway_type("vs")), "\"a\\x0d\\x0a\\x1bb\"");
}

TEST(GatewayValueText, WhatIsNoValue_IsNone) {
  const auto encode = [](const char* type, const char* text) {
    return encode_gateway_value(text, *parse_gateway_type(type));
  };
  for (const auto& [type, text] : std::vector<std::pair<const char*, const char*>>{{"b", "2"},
                                                                                   {"u8", "-1"},
                                                                                   {"u8", ""},
                                                                                   {"i8", "128"},
                                                                                   {"r32", "1e99"},
                                                                                   {"r32", "x"},
                                                                                   {"t", "1"},
                                                                                   {"t", "1 2 3"},
                                                                                   {"d", "AQ"},
                                                                                   {"d", "A==="},
                                                                                   {"d", "AQ=D"},
                                                                                   {"hex", "1"},
                                                                                   {"hex", "0x"},
                                                                                   {"vs", "a b"},
                                                                                   {"vs", "\"a\"b\""}}) {
    EXPECT_EQ(encode(type, text), std::nullopt) << type << ' ' << text;
  }
  for (const char* name : {"", "u", "u0", "u7", "u72", "u08", "i", "f32", "q8"})
    EXPECT_FALSE(parse_gateway_type(name)) << name;
}

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
}  // namespace canopus::client
