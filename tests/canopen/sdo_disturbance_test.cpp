// SDO transfers on a bus that repeats, loses or changes frames: what fuzzing has found.

#include <gtest/gtest.h>

#include "canopus/canopen/sdo_client.hpp"

#include "canopen/conversation.hpp"

namespace canopus::canopen {
namespace {

class DisturbedSdoClient : public testing::Test, public SdoClientUser {
 protected:
  DisturbedSdoClient() { client.set_server(9); }
  std::string hear(const std::string& frame) {
    client.receive(from_text(frame), now);
    return bus.take();
  }
  void sdo_finished(SdoClient&, can::Time) override { ++finished; }

  Notebook bus;
  SdoClient client{bus};
  can::Time now{};
  int finished = 0;
};

TEST_F(DisturbedSdoClient, AbortWithoutAReason_IsNotSuccess) {
  client.upload(0x1018, 1, *this, now);
  hear("589 80 18 10 01 00 00 00 00");
  EXPECT_EQ(finished, 1);
  EXPECT_EQ(client.abort_code(), AbortCode::general);
}

TEST_F(DisturbedSdoClient, LastSegmentOfABlockTwice_IsNotAnAbortOfTheServer) {
  client.upload(0x2012, 0, *this, now, SdoClient::default_time_out, SdoClient::Mode::block);
  hear("589 C4 12 20 00 00 00 00 00");
  bus.take();
  EXPECT_EQ(hear("589 81 24 0F 90 00 00 00 00"), "609 A2 01 7F 00 00 00 00 00");
  EXPECT_EQ(hear("589 81 24 0F 90 00 00 00 00"), "609 80 12 20 00 01 00 04 05");
  EXPECT_EQ(client.abort_code(), AbortCode::command_specifier);
}

}  // namespace
}  // namespace canopus::canopen
