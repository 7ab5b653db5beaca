// SDO transfers on a bus that repeats, loses or changes frames: what fuzzing has found.

#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/canopen/sdo/sdo_client.hpp"

#include "canopen/conversation.hpp"

namespace canopus::canopen::sdo_disturbance_test {
namespace {

class DisturbedSdoClient : public testing::Test, public SdoClientListener {
 protected:
  DisturbedSdoClient() { client.set_server(9); }
  std::string receive(const std::string& frame) {
    client.receive(from_text(frame), now);
    return bus.drain();
  }
  void sdo_finished(SdoClient&, can::Time) override { ++finished; }

  Notebook bus;
  SdoClient client{bus};
  can::Time now{};
  int finished = 0;
};

TEST_F(DisturbedSdoClient, AbortWithoutAReason_IsNotSuccess) {
  client.upload(0x1018, 1, *this, now);
  receive("589 80 18 10 01 00 00 00 00");
  EXPECT_EQ(finished, 1);
  EXPECT_EQ(client.abort_code(), AbortCode::general);
}

TEST_F(DisturbedSdoClient, LastSegmentOfABlockTwice_ChangesNothing) {
  client.upload(0x2012, 0, *this, now, SdoClient::default_time_out, SdoClient::Mode::block);
  receive("589 C4 12 20 00 00 00 00 00");
  bus.drain();
  EXPECT_EQ(receive("589 81 24 0F 90 00 00 00 00"), "609 A2 01 7F 00 00 00 00 00");
  EXPECT_EQ(receive("589 81 24 0F 90 00 00 00 00"), "");
  EXPECT_EQ(receive("589 81 24 0F 91 00 00 00 00"), "609 80 12 20 00 01 00 04 05") << "another one";
  EXPECT_EQ(client.abort_code(), AbortCode::command_specifier);
}

// A sub-block of the server under test, or of the scripted server: 127 segments.
std::string segment_of_a_full_sub_block(const std::string& identifier, unsigned sequence) {
  char text[40];
  std::snprintf(text, sizeof text, "%s %02X 30 31 32 33 34 35 36", identifier.c_str(), sequence);
  return text;
}

struct DisturbedSdoServer : testing::Test, Conversation {
  std::string receive_full_sub_block() {
    std::string answers;
    for (unsigned sequence = 1; sequence <= 127; ++sequence) {
      answers += receive(segment_of_a_full_sub_block("605", sequence));
    }
    return answers;
  }
};

// Had it confirmed "0", the client would send the sub-block again, and the value would have it twice.
TEST_F(DisturbedSdoServer, LostConfirmationOfALaterSubBlock_WithoutCrc_TimesOutInSilence) {
  receive("605 C0 0A 20 00 00 00 00 00");
  EXPECT_EQ(receive_full_sub_block(), "585 A2 7F 7F 00 00 00 00 00");
  EXPECT_EQ(wait(2s), "1000: 585 80 0A 20 00 00 00 04 05");
}

// To say it again would end the transfer with a client that is merely slow.
TEST_F(DisturbedSdoServer, NothingOfASubBlock_IsNotConfirmedEarly) {
  receive("605 C4 0A 20 00 00 00 00 00");
  EXPECT_EQ(wait(900ms), "") << "the first";
  EXPECT_EQ(receive_full_sub_block(), "585 A2 7F 7F 00 00 00 00 00");
  EXPECT_EQ(wait(900ms), "") << "a later one";
  EXPECT_EQ(receive("605 81 30 31 32 33 34 35 36"), "585 A2 01 7F 00 00 00 00 00");
  EXPECT_EQ(wait(900ms), "") << "the end";
  // CRC of 128 times "0123456".
  EXPECT_EQ(receive("605 C1 4D 47 00 00 00 00 00"), "585 A1 00 00 00 00 00 00 00");
}

// A pause before the sub-block must not hide one within it.
TEST_F(DisturbedSdoServer, PartOfASubBlock_IsConfirmedEarly_AlsoAfterAPauseBeforeIt) {
  receive("605 C4 0A 20 00 00 00 00 00");
  EXPECT_EQ(wait(600ms), "");
  receive("605 01 30 31 32 33 34 35 36");
  EXPECT_EQ(wait(500ms), "850: 585 A2 01 7F 00 00 00 00 00");
}

TEST_F(DisturbedSdoServer, SegmentThatAsksForTheConfirmationTwice_IsAnsweredOnce) {
  receive("605 C0 0A 20 00 00 00 00 00");
  EXPECT_EQ(receive_full_sub_block(), "585 A2 7F 7F 00 00 00 00 00");
  EXPECT_EQ(receive(segment_of_a_full_sub_block("605", 127)), "");
  EXPECT_EQ(receive(segment_of_a_full_sub_block("605", 2)), "");
  EXPECT_EQ(receive(segment_of_a_full_sub_block("605", 127)), "585 A2 00 7F 00 00 00 00 00") << "of the next";
}

// Another confirmation would make the client send twice what it now repeats.
TEST_F(DisturbedSdoServer, RestOfASubBlockThatIsMerelyLate_IsNotAnswered) {
  receive("605 C4 0A 20 00 00 00 00 00");
  receive("605 01 30 31 32 33 34 35 36");
  EXPECT_EQ(wait(300ms), "250: 585 A2 01 7F 00 00 00 00 00");
  for (unsigned sequence = 2; sequence <= 127; ++sequence) {
    EXPECT_EQ(receive(segment_of_a_full_sub_block("605", sequence)), "");
  }
  EXPECT_EQ(receive_full_sub_block(), "585 A2 7F 7F 00 00 00 00 00");
  EXPECT_EQ(receive("605 81 30 31 32 33 34 35 36"), "585 A2 01 7F 00 00 00 00 00");
}

TEST_F(DisturbedSdoServer, WithoutCrc_NothingIsConfirmedEarly) {
  receive("605 C0 0A 20 00 00 00 00 00");
  receive_full_sub_block();
  receive("605 01 30 31 32 33 34 35 36");
  EXPECT_EQ(wait(2s), "1000: 585 80 0A 20 00 00 00 04 05");
  receive("605 C0 0A 20 00 00 00 00 00");
  EXPECT_EQ(wait(2s), "3000: 585 80 0A 20 00 00 00 04 05");
}

// A client under test sends; the scripted server says a confirmation again.
TEST_F(DisturbedSdoClient, ConfirmationTwice_ChangesNothing) {
  const std::vector<std::uint8_t> value(2 * 7 + 3, 0x30);
  client.download(0x2012, 0, value, *this, now, 400ms, SdoClient::Mode::block);
  bus.drain();
  EXPECT_EQ(receive("589 A4 12 20 00 02 00 00 00"),
            "609 01 30 30 30 30 30 30 30 | 609 02 30 30 30 30 30 30 30");
  EXPECT_EQ(receive("589 A2 02 02 00 00 00 00 00"), "609 81 30 30 30 00 00 00 00");
  EXPECT_EQ(receive("589 A2 02 02 00 00 00 00 00"), "");
  EXPECT_EQ(receive("589 A2 01 02 00 00 00 00 00").substr(0, 6), "609 D1");
  EXPECT_EQ(receive("589 A2 01 02 00 00 00 00 00"), "") << "the last one again";
  EXPECT_TRUE(client.busy());
  receive("589 A1 00 00 00 00 00 00 00");
  EXPECT_EQ(client.abort_code(), AbortCode::none);
}

TEST_F(DisturbedSdoClient, ConfirmationTwice_IsIgnoredWhileSegmentsAreUnderWay) {
  const std::vector<std::uint8_t> value(5 * 7, 0x30);
  client.download(0x2012, 0, value, *this, now, 400ms, SdoClient::Mode::block);
  receive("589 A4 12 20 00 03 00 00 00");
  receive("589 A2 03 03 00 00 00 00 00");
  EXPECT_EQ(receive("589 A2 03 03 00 00 00 00 00"), "");
  EXPECT_TRUE(client.busy());
  EXPECT_EQ(receive("589 A2 02 03 00 00 00 00 00").substr(0, 6), "609 C1");
}

TEST_F(DisturbedSdoClient, LostConfirmationOfALaterSubBlock_WithoutCrc_TimesOutInSilence) {
  client.upload(0x2012, 0, *this, now, 400ms, SdoClient::Mode::block);
  bus.drain();
  EXPECT_EQ(receive("589 C0 12 20 00 00 00 00 00"), "609 A3 00 00 00 00 00 00 00");
  std::string answers;
  for (unsigned sequence = 1; sequence <= 127; ++sequence) {
    answers += receive(segment_of_a_full_sub_block("589", sequence));
  }
  EXPECT_EQ(answers, "609 A2 7F 7F 00 00 00 00 00");
  std::string said;
  while (client.busy()) {
    now = client.deadline();
    client.tick(now);
    said += std::to_string(now.time_since_epoch() / 1ms) + ": " + bus.drain() + "|";
  }
  EXPECT_TRUE(said.ends_with("400: 609 80 12 20 00 00 00 04 05|")) << said;
  EXPECT_EQ(said.find("A2"), std::string::npos) << said;
  EXPECT_EQ(client.abort_code(), AbortCode::timed_out);
}

}  // namespace
}  // namespace canopus::canopen::sdo_disturbance_test
