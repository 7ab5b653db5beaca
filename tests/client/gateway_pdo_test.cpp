#include "canopus/client/gateway/gateway_pdo.hpp"

#include <gmock/gmock.h>

#include "gateway_setup.hpp"

namespace canopus::client::gateway_pdo_test {
namespace {

using can::data_frame;
using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

class GatewayPdoTest : public GatewaySetup {
 protected:
  static can::Frame extended(can::Frame frame) {
    frame.extended = true;
    return frame;
  }
};

TEST_F(GatewayPdoTest, ReceivedPdo_IsAnEventAndCanBeRead) {
  EXPECT_TRUE(answer_to("r p 2").starts_with("ERROR:102"));
  EXPECT_EQ(answer_to("set rpdo 2 0x185 event 3 u8 u16 b"), "OK");
  receive(data_frame(0x185, {0x12, 0x34, 0x56, 0x01}));
  EXPECT_THAT(ends.lines, ElementsAre("1 pdo 2 3 0x12 0x5634 0x1\r\n"));
  EXPECT_EQ(answer_to("[6] 1 r pdo 2"), "[6] 1 pdo 3 0x12 0x5634 0x1");
  receive(data_frame(0x185, {0x12}));
  EXPECT_THAT(ends.lines, ElementsAre("1 ERROR 401 #PDO length exceeded\r\n"));
}

TEST_F(GatewayPdoTest, SynchronousPdos_WaitForTheirSync) {
  EXPECT_EQ(answer_to("set rpdo 1 0x185 sync2 1 u8"), "OK");
  EXPECT_EQ(answer_to("set tpdo 1 0x205 sync1 2 u8 u16"), "OK");
  EXPECT_EQ(answer_to("w p 1 2 0x11 0x2233"), "OK");
  receive(data_frame(0x185, {9}));
  EXPECT_THAT(ends.lines, IsEmpty());
  EXPECT_THAT(ends.frames, IsEmpty());
  receive(data_frame(0x080));
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {0x11, 0x33, 0x22})));
  receive(data_frame(0x080));
  EXPECT_THAT(ends.lines, ElementsAre("1 pdo 1 1 0x9\r\n"));
}

TEST_F(GatewayPdoTest, SyncsOfAType_Are0To240) {
  EXPECT_EQ(answer_to("set tpdo 1 0x205 sync240 1 u8"), "OK");
  EXPECT_TRUE(answer_to("set tpdo 1 0x205 sync241 1 u8").starts_with("ERROR:101"));
  EXPECT_TRUE(answer_to("set tpdo 1 0x205 sync 1 u8").starts_with("ERROR:101"));
  EXPECT_EQ(answer_to("set tpdo 1 0x205 sync0 1 u8"), "OK");
  EXPECT_EQ(answer_to("w p 1 1 5"), "OK");
  receive(data_frame(0x080));
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {5}))) << "0: with the next SYNC";
}

TEST_F(GatewayPdoTest, PdoThatDoesNotFit_IsRefused) {
  EXPECT_TRUE(answer_to("set tpdo 1 0x205 event 2 u64 u8").starts_with("ERROR:401"));
  EXPECT_TRUE(answer_to("set tpdo 0 0x205 event 1 u8").starts_with("ERROR:101"));
  EXPECT_EQ(answer_to("set tpdo 1 0x205 event 2 u8 u8"), "OK");
  EXPECT_TRUE(answer_to("w p 1 1 5").starts_with("ERROR:401"));
  EXPECT_TRUE(answer_to("w p 1 2 5 256").starts_with("ERROR:401"));
  EXPECT_TRUE(answer_to("w p 2 1 5").starts_with("ERROR:102"));
  EXPECT_EQ(answer_to("w pdo 1 2 5 255"), "OK");
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {5, 255})));
}

TEST_F(GatewayPdoTest, IdentifierOf29Bits_IsBit29OfTheCobId) {
  EXPECT_EQ(answer_to("set rpdo 1 0x32345678 event 1 u16"), "OK");
  EXPECT_EQ(answer_to("set tpdo 1 0x20000185 event 1 u8"), "OK");
  receive(data_frame(0x185, {1, 2}));
  EXPECT_THAT(ends.lines, IsEmpty());
  receive(extended(data_frame(0x12345678, {0x34, 0x12})));
  EXPECT_THAT(ends.lines, ElementsAre("1 pdo 1 1 0x1234\r\n"));
  EXPECT_EQ(answer_to("w p 1 1 9"), "OK");
  EXPECT_THAT(ends.frames, ElementsAre(extended(data_frame(0x185, {9}))));
  EXPECT_TRUE(answer_to("set tpdo 2 0x800 event 1 u8").starts_with("ERROR:101"))
      << "11 bits are not enough for it";
}

TEST_F(GatewayPdoTest, RemoteFrames_AreOf11Or29Bits) {
  EXPECT_EQ(answer_to("set rpdo 1 0x20000185 rtr 1 u16"), "OK");
  EXPECT_EQ(answer_to("set tpdo 1 0x20000205 rtr 1 u8"), "OK");
  EXPECT_EQ(answer_to("w p 1 1 9"), "OK");
  receive(can::remote_frame(0x205, 1));
  EXPECT_THAT(ends.frames, IsEmpty());
  receive(extended(can::remote_frame(0x205, 1)));
  EXPECT_EQ(answer_to("r p 1"), "(nothing)");
  EXPECT_THAT(ends.frames,
              ElementsAre(extended(data_frame(0x205, {9})), extended(can::remote_frame(0x185, 2))));
  receive(data_frame(0x185, {1, 2}));
  EXPECT_THAT(ends.lines, IsEmpty());
  receive(extended(data_frame(0x185, {1, 2})));
  EXPECT_THAT(ends.lines, ElementsAre("1 pdo 1 0x201\r\n"));
}

TEST_F(GatewayPdoTest, WrongPdos_AreTheirError) {
  EXPECT_EQ(answer_to("set rpdo 1 0x185 event 1 vs"), "ERROR:100 #request not supported");
  EXPECT_EQ(answer_to("2 set rpdo 1 0x185 event 1 u8"), "ERROR:106 #unsupported network");
  EXPECT_EQ(answer_to("set tpdox 1 0x205 event65535 65535 1 u8"), "OK");
  EXPECT_EQ(answer_to("set tpdox 1 0x205 event65536 0 1 u8"), "ERROR:101 #syntax error");
  EXPECT_EQ(answer_to("set tpdox 1 0x205 event0 65536 1 u8"), "ERROR:101 #syntax error");
  EXPECT_EQ(answer_to("set tpdo 1 0x205 event 1 u8"), "OK");
  ends.full = true;
  EXPECT_EQ(answer_to("w p 1 1 1"), "ERROR:303 #CAN buffer overflow");
}

TEST_F(GatewayPdoTest, RemovedTpdo_IsNoMore) {
  EXPECT_EQ(answer_to("set tpdo 1 0x205 event 1 u8"), "OK");
  EXPECT_EQ(answer_to("set rpdo 1 0x185 event 1 u8"), "OK");
  EXPECT_EQ(answer_to("set tpdo 1 0x80000205 event 1 u8"), "OK");
  EXPECT_TRUE(answer_to("w p 1 1 1").starts_with("ERROR:102"));
  receive(data_frame(0x185, {1}));
  EXPECT_EQ(ends.lines.size(), 1U) << "the RPDO of this number stays";
}

TEST_F(GatewayPdoTest, IdentifierInUse_IsRefused) {
  EXPECT_EQ(answer_to("set rpdo 1 0x185 event 1 u16"), "OK");
  EXPECT_EQ(answer_to("set rpdo 1 0x185 event 1 u8"), "OK") << "the same PDO may change";
  EXPECT_EQ(answer_to("set rpdo 2 0x185 event 1 u8"), "ERROR:400 #PDO already used");
  EXPECT_EQ(answer_to("set tpdo 1 0x185 event 1 u8"), "ERROR:400 #PDO already used");
  EXPECT_EQ(answer_to("set tpdo 1 0x20000185 event 1 u8"), "OK") << "another one of 29 bits";
  for (const char* other : {"0", "0x001", "0x601", "0x585", "0x705"})
    EXPECT_EQ(answer_to(std::string("set tpdo 3 ") + other + " event 1 u8"), "ERROR:400 #PDO already used")
        << other;
  EXPECT_EQ(answer_to("set rpdo 1 0x80000185 event 1 u8"), "OK") << "bit 31: it exists no longer";
  EXPECT_TRUE(answer_to("r p 1").starts_with("ERROR:102"));
  EXPECT_EQ(answer_to("set rpdo 2 0x185 event 1 u8"), "OK");
  EXPECT_EQ(answer_to("set rpdo 3 0x80000000 event 0"), "OK")
      << "of a PDO that does not exist the identifier is nothing";
}

TEST_F(GatewayPdoTest, RpdoOfTypeRtr_IsAskedForWhenItIsRead) {
  EXPECT_EQ(answer_to("set rpdo 3 0x285 rtr 2 u8 u16"), "OK");
  EXPECT_EQ(answer_to("[4] r p 3"), "(nothing)");
  EXPECT_THAT(ends.frames, ElementsAre(can::remote_frame(0x285, 3)));
  EXPECT_TRUE(session.waiting());
  receive(data_frame(0x285, {1, 2, 3}));
  EXPECT_THAT(ends.lines, ElementsAre("[4] 1 pdo 2 0x1 0x302\r\n"));
  EXPECT_FALSE(session.waiting());
  receive(data_frame(0x285, {1, 2, 3}));
  EXPECT_THAT(ends.lines, IsEmpty()) << "nobody asked";
}

TEST_F(GatewayPdoTest, ClientsThatAskForTwoPdos_GetTheirs) {
  WireAndClient other;
  GatewaySession second(gateway, other);
  EXPECT_EQ(answer_to("set rpdo 3 0x285 rtr 1 u8"), "OK");
  EXPECT_EQ(answer_to("set rpdo 4 0x286 rtr 1 u8"), "OK");
  EXPECT_EQ(answer_to("r p 3"), "(nothing)");
  second.receive("r p 4\n", now);
  receive(data_frame(0x286, {6}));
  EXPECT_THAT(ends.lines, IsEmpty());
  EXPECT_THAT(other.lines, ElementsAre("1 pdo 1 0x6\r\n"));
  receive(data_frame(0x285, {5}));
  EXPECT_THAT(ends.lines, ElementsAre("1 pdo 1 0x5\r\n"));
}

TEST_F(GatewayPdoTest, RtrWithoutAnAnswer_IsATimeOut) {
  EXPECT_EQ(answer_to("set sdo_timeout 200"), "OK");
  EXPECT_EQ(answer_to("set rpdo 3 0x285 rtr 1 u8"), "OK");
  EXPECT_EQ(answer_to("[4] r p 3"), "(nothing)");
  pass(199ms);
  EXPECT_THAT(ends.lines, IsEmpty());
  pass(1ms);
  EXPECT_THAT(ends.lines, ElementsAre("[4] ERROR:103 #time-out\r\n"));
  receive(data_frame(0x285, {1}));
  EXPECT_THAT(ends.lines, IsEmpty());
  ends.full = true;
  EXPECT_TRUE(answer_to("r p 3").starts_with("ERROR:303"));
}

TEST_F(GatewayPdoTest, TpdoOfTypeRtr_IsSentWhenARemoteFrameAsks) {
  EXPECT_EQ(answer_to("set tpdo 1 0x205 rtr 1 u16"), "OK");
  receive(can::remote_frame(0x205, 2));
  EXPECT_THAT(ends.frames, IsEmpty()) << "it has no value yet";
  EXPECT_EQ(answer_to("w p 1 1 0x1234"), "OK");
  EXPECT_THAT(ends.frames, IsEmpty());
  receive(can::remote_frame(0x205, 2));
  receive(can::remote_frame(0x206, 2));
  EXPECT_EQ(answer_to("set tpdo 2 0x206 sync1 1 u16"), "OK");
  EXPECT_EQ(answer_to("w p 2 1 1"), "OK");
  receive(can::remote_frame(0x206, 2));
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {0x34, 0x12})));
}

TEST_F(GatewayPdoTest, InhibitTime_HoldsTheLastValueBack) {
  for (const char* form : {"set tpdox 1 0x205 event100 0 1 u8", "set tpdox 1 0x205 event 100 0 1 u8"}) {
    ends.frames.clear();
    EXPECT_EQ(answer_to(form), "OK");
    EXPECT_EQ(answer_to("w p 1 1 1"), "OK");
    EXPECT_EQ(answer_to("w p 1 1 2"), "OK");
    EXPECT_EQ(answer_to("w p 1 1 3"), "OK");
    pass(99ms);
    EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {1})));
    pass(1ms);
    EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {1}), data_frame(0x205, {3})));
    pass(1s);
    EXPECT_EQ(ends.frames.size(), 2U);
  }
}

TEST_F(GatewayPdoTest, EventTimer_SendsAgain) {
  EXPECT_EQ(answer_to("set tpdox 1 0x205 event 0 100 1 u8"), "OK");
  pass(1s);
  EXPECT_THAT(ends.frames, IsEmpty());
  EXPECT_EQ(answer_to("w p 1 1 1"), "OK");
  pass(250ms);
  EXPECT_EQ(ends.frames.size(), 3U);
  EXPECT_EQ(answer_to("w p 1 1 2"), "OK");
  pass(99ms);
  EXPECT_EQ(ends.frames.size(), 4U) << "the timer begins anew";
  pass(1ms);
  EXPECT_EQ(ends.frames.back(), data_frame(0x205, {2}));
  EXPECT_EQ(ends.frames.size(), 5U);
}

TEST_F(GatewayPdoTest, EventTimerShorterThanTheInhibitTime_IsAsLong) {
  EXPECT_EQ(answer_to("set tpdox 1 0x205 event 200 100 1 u8"), "OK");
  EXPECT_EQ(answer_to("w p 1 1 1"), "OK");
  pass(199ms);
  EXPECT_EQ(ends.frames.size(), 1U);
  pass(1ms);
  EXPECT_EQ(ends.frames.size(), 2U);
}

TEST_F(GatewayPdoTest, SyncsWithAndWithoutACounter_CountForEveryStartValue) {
  EXPECT_EQ(answer_to("set tpdo 1 0x205 sync1 1 u8"), "OK");
  EXPECT_EQ(answer_to("w p 1 1 7"), "OK");
  receive(extended(data_frame(0x080)));
  EXPECT_THAT(ends.frames, IsEmpty()) << "29 bits";
  receive(data_frame(0x080, {9}));
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {7})));
  EXPECT_EQ(answer_to("set tpdox 1 0x205 sync1 3 1 u8"), "OK");
  EXPECT_EQ(answer_to("w p 1 1 8"), "OK");
  receive(data_frame(0x080));
  EXPECT_EQ(ends.frames.size(), 2U) << "its producer does not count";
}

TEST_F(GatewayPdoTest, NewValue_WaitsForAsManySyncsAgain) {
  EXPECT_EQ(answer_to("set tpdo 1 0x205 sync2 1 u8"), "OK");
  EXPECT_EQ(answer_to("w p 1 1 7"), "OK");
  receive(data_frame(0x080));
  EXPECT_EQ(answer_to("w p 1 1 8"), "OK");
  receive(data_frame(0x080));
  EXPECT_THAT(ends.frames, IsEmpty());
  receive(data_frame(0x080));
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {8})));
}

TEST_F(GatewayPdoTest, SyncStartValue_IsTheFirstSyncThatCounts) {
  EXPECT_EQ(answer_to("set tpdox 1 0x205 sync2 3 1 u8"), "OK");
  EXPECT_EQ(answer_to("w p 1 1 7"), "OK");
  for (const std::uint8_t counter : std::initializer_list<std::uint8_t>{1, 2, 3})
    receive(data_frame(0x080, {counter}));
  EXPECT_THAT(ends.frames, IsEmpty());
  receive(data_frame(0x080, {4}));
  EXPECT_THAT(ends.frames, ElementsAre(data_frame(0x205, {7})));
  EXPECT_EQ(answer_to("w p 1 1 8"), "OK");
  receive(data_frame(0x080, {1}));
  receive(data_frame(0x080, {2}));
  EXPECT_EQ(ends.frames.size(), 2U) << "it counts since";
  EXPECT_TRUE(answer_to("set tpdox 1 0x205 sync2 1 u8").starts_with("ERROR:101"));
  EXPECT_TRUE(answer_to("set tpdox 1 0x205 sync2 241 1 u8").starts_with("ERROR:101"));
  EXPECT_TRUE(answer_to("set tpdo 1 0x205 event 10 20 1 u8").starts_with("ERROR:1")) << "that is tpdox";
}

}  // namespace
}  // namespace canopus::client::gateway_pdo_test
