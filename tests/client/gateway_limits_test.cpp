// What a client of the ASCII gateway may ask for at most.

#include <string>

#include <gmock/gmock.h>

#include "gateway_setup.hpp"

namespace canopus::client::gateway_limits_test {
namespace {

using can::data_frame;
using testing::ElementsAre;
using testing::IsEmpty;

class GatewayLimitsTest : public GatewaySetup {};

TEST_F(GatewayLimitsTest, SequenceNumbers_Are32Bits) {
  EXPECT_EQ(answer_to("[0] 5 start"), "[0] OK");
  EXPECT_EQ(answer_to("[4294967295] 5 start"), "[4294967295] OK");
  EXPECT_EQ(answer_to("[0xFFFFFFFF] 5 start"), "[4294967295] OK");
  EXPECT_EQ(answer_to("[0x100000000] 5 start"), "ERROR:101 #syntax error");
  EXPECT_EQ(answer_to("[-1] 5 start"), "ERROR:101 #syntax error");
  EXPECT_EQ(answer_to("[] 5 start"), "ERROR:101 #syntax error");
}

TEST_F(GatewayLimitsTest, LineWithoutEnd_IsASyntaxErrorOnceItEnds) {
  session.receive(std::string(200'000, 'x'), now);
  EXPECT_THAT(ends.lines, IsEmpty());
  EXPECT_EQ(session.buffered(), 0U) << "it is not kept";
  session.receive("\r\n5 start\r\n", now);
  EXPECT_THAT(ends.lines, ElementsAre("ERROR:101 #syntax error\r\n", "OK\r\n"));
}

TEST_F(GatewayLimitsTest, CommandSize_IsTheLongestLine) {
  EXPECT_EQ(answer_to("set command_size 32"), "OK");
  EXPECT_EQ(answer_to("5 start #" + std::string(23, 'x')), "OK");
  EXPECT_EQ(answer_to("5 start #" + std::string(24, 'x')), "ERROR:101 #syntax error");
  EXPECT_EQ(answer_to("set command_size 65536"), "OK");
  EXPECT_EQ(answer_to("set command_size 65537"), "ERROR:600 #running out of memory");
}

TEST_F(GatewayLimitsTest, ClientThatTakesNoAnswers_IsNotAskedFurther) {
  ends.clients_room = 2;
  session.receive("[1] info version\n[2] info version\n[3] info version\n[4] info version\n", now);
  EXPECT_EQ(ends.lines.size(), 2U);
  EXPECT_GT(session.buffered(), 0U);
  ends.clients_room = 3;
  session.resume(now);
  EXPECT_EQ(ends.lines.size(), 3U);
  ends.clients_room = 100;
  session.resume(now);
  EXPECT_EQ(ends.lines.back(), "[4] 0 0 0.0 0 3 2.1 1.2\r\n");
  EXPECT_EQ(session.buffered(), 0U);
}

TEST_F(GatewayLimitsTest, SdoTimeOut_HasABound) {
  EXPECT_EQ(answer_to("set sdo_timeout 65535"), "OK");
  EXPECT_EQ(answer_to("set sdo_timeout 65536"), "ERROR:101 #syntax error");
  EXPECT_EQ(answer_to("set sdo_timeout 0"), "ERROR:101 #syntax error");
}

TEST_F(GatewayLimitsTest, ObjectThatIsTooLong_IsNotRead) {
  send("[6] 5 r 0x2000 0");
  receive(data_frame(0x585, {0x41, 0x00, 0x20, 0, 0x01, 0, 0x08, 0}));
  EXPECT_THAT(ends.lines, ElementsAre("[6] ERROR:600 #running out of memory\r\n"));
  EXPECT_EQ(ends.frames.back().data[0], 0x80) << "an abort";
  send("[7] 5 r 0x2000 0");
  receive(data_frame(0x585, {0x41, 0x00, 0x20, 0, 0x00, 0, 0x08, 0}));
  EXPECT_THAT(ends.lines, IsEmpty());
  EXPECT_EQ(ends.frames.back(), data_frame(0x605, {0x60, 0, 0, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace canopus::client::gateway_limits_test
