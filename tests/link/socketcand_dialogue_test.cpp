#include "canopus/link/socketcand_dialogue.hpp"

#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::link::socketcand_dialogue_test {
namespace {

using can::Frame;
using testing::ElementsAre;
using testing::IsEmpty;
using State = SocketcandDialogue::State;

struct Ends : SocketcandDialogue::Peer {
  void message(std::string_view text) override { messages.emplace_back(text); }
  void frame_received(const Frame& frame) override { frames.push_back(frame); }
  void complaint(std::string_view text) override { complaints.emplace_back(text); }
  void controller_error(std::uint32_t error_class) override { errors.push_back(error_class); }

  void echoed() override { ++echoes; }
  void bit_rate_changed() override { ++changes; }
  void bit_rate_refused(std::string_view text) override { refusals.emplace_back(text); }

  unsigned changes = 0;
  std::vector<std::string> refusals;

  unsigned echoes = 0;
  std::vector<std::string> messages;
  std::vector<Frame> frames;
  std::vector<std::string> complaints;
  std::vector<std::uint32_t> errors;
};

class SocketcandDialogueTest : public testing::Test {
 protected:
  void join() {
    dialogue.receive("< hi >< ok >< ok >");
    ends.messages.clear();
  }
  Ends ends;
  SocketcandDialogue dialogue{"line1", ends};
};

TEST_F(SocketcandDialogueTest, Echo_IsTold) {
  dialogue.receive("< hi >< ok >< ok >< ech");
  EXPECT_EQ(ends.echoes, 0U);
  dialogue.receive("o >< frame 123 1.0 01 >");
  EXPECT_EQ(ends.echoes, 1U);
  EXPECT_THAT(ends.complaints, IsEmpty());
}

TEST_F(SocketcandDialogueTest, BitRate_IsAskedByTheNameOfTheBus_AndItsAnswerIsTold) {
  join();
  dialogue.request_bit_rate(500'000);
  EXPECT_THAT(ends.messages, ElementsAre("< line1 B 500000 >"));
  dialogue.receive("< frame 123 1.0 01 >< error 020 1.0 >");  // no answers
  EXPECT_EQ(ends.changes, 0U);
  EXPECT_THAT(ends.refusals, IsEmpty());
  dialogue.receive("< ok >< ok >");
  EXPECT_EQ(ends.changes, 1U) << "the second answers nothing we asked";
}

TEST_F(SocketcandDialogueTest, RefusedBitRate_IsTold_AlsoByServersThatDoNotKnowIt) {
  join();
  dialogue.request_bit_rate(500'000);
  dialogue.receive(
      "< error lost 7 frames, read faster >< error B: the bit rate of this bus is not set from here >");
  dialogue.request_bit_rate(500'000);
  dialogue.receive("< error unknown command >");
  EXPECT_THAT(ends.refusals,
              ElementsAre("B: the bit rate of this bus is not set from here", "unknown command"));
  EXPECT_THAT(ends.complaints, ElementsAre("lost 7 frames, read faster"));
}

TEST(SocketcandDialogue, BitRate_OfTheOnlyBusOfAServer_NeedsNoName) {
  Ends ends;
  SocketcandDialogue dialogue("", ends);
  dialogue.request_bit_rate(10'000);
  EXPECT_THAT(ends.messages, ElementsAre("< B 10000 >"));
}

std::string text_of(const Frame& frame) {
  std::array<char, socketcand_max_send> text{};
  const std::size_t size = write_socketcand_send(text, frame);
  return {text.data(), size};
}

TEST(SocketcandSend, DataFrame_HasLengthAndBytesInHexadecimal) {
  EXPECT_EQ(text_of(can::data_frame(0x601, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0xFF})),
            "< send 601 8 40 18 10 1 0 0 0 FF >");
}

TEST(SocketcandSend, FrameWithoutData_EndsAfterItsLength) {
  EXPECT_EQ(text_of(can::data_frame(0x080)), "< send 080 0 >");
}

TEST(SocketcandSend, ExtendedFrame_HasEightDigits) {
  Frame frame = can::data_frame(0x601, {5});
  frame.extended = true;
  EXPECT_EQ(text_of(frame), "< send 00000601 1 5 >");
}

TEST(SocketcandSend, RemoteFrame_HasNoBytes) {
  EXPECT_EQ(text_of(can::remote_frame(0x705, 1)), "< sendrtr 705 1 >");
}

TEST(SocketcandSend, LongestFrame_FitsItsRoom) {
  Frame frame{.identifier = 0x1FFFFFFF, .extended = true, .dlc = 15};
  frame.data.fill(0xFF);
  EXPECT_EQ(text_of(frame), "< send 1FFFFFFF 8 FF FF FF FF FF FF FF FF >");
}

TEST_F(SocketcandDialogueTest, Greeting_IsAnsweredWithTheBusName) {
  dialogue.receive("< hi >");
  EXPECT_THAT(ends.messages, ElementsAre("< open line1 >"));
  EXPECT_EQ(dialogue.state(), State::opening);
}

TEST_F(SocketcandDialogueTest, OpenedBus_IsAskedForItsFrames) {
  dialogue.receive("< hi >< ok >");
  EXPECT_THAT(ends.messages, ElementsAre("< open line1 >", "< rawmode >"));
  EXPECT_EQ(dialogue.state(), State::entering_raw);
}

TEST_F(SocketcandDialogueTest, SecondOk_JoinsTheBus) {
  dialogue.receive("< hi >< ok >< ok >");
  EXPECT_EQ(dialogue.state(), State::raw);
}

TEST(SocketcandDialogueWithoutName, Greeting_IsAnsweredWithOpenAlone) {
  Ends ends;
  SocketcandDialogue dialogue("", ends);
  dialogue.receive("< hi >");
  EXPECT_THAT(ends.messages, ElementsAre("< open >"));
}

TEST(SocketcandDialogueWithoutName, Refusal_AsksThePersonForTheName) {
  Ends ends;
  SocketcandDialogue dialogue("", ends);
  dialogue.receive("< hi >< error could not open bus >");
  EXPECT_EQ(dialogue.state(), State::failed);
  EXPECT_EQ(dialogue.error(), "the server wants the name of the bus: socketcand:HOST:PORT/BUS");
}

TEST_F(SocketcandDialogueTest, RefusedBus_IsNamedWithTheServersWords) {
  dialogue.receive("< hi >< error could not open bus >");
  EXPECT_EQ(dialogue.state(), State::failed);
  EXPECT_EQ(dialogue.error(), "the server does not open the bus \"line1\": error could not open bus");
}

TEST_F(SocketcandDialogueTest, AnotherKindOfServer_IsToldByWhatItSays) {
  dialogue.receive("SSH-2.0-OpenSSH_9.2\r\n");
  EXPECT_EQ(dialogue.state(), State::failed);
  EXPECT_EQ(dialogue.error(), "this is no socketcand server: it says \"SSH-2.0-OpenSSH_9.2??\"");
}

TEST_F(SocketcandDialogueTest, ElementWithoutEnd_IsGivenUpAfter512Characters) {
  dialogue.receive("< hi" + std::string(507, ' '));
  EXPECT_EQ(dialogue.state(), State::greeting);
  dialogue.receive(" ");
  EXPECT_EQ(dialogue.state(), State::failed);
}

TEST_F(SocketcandDialogueTest, Frame_IsHeard) {
  join();
  dialogue.receive("< frame 581 12.000345 4318100101000000 >");
  EXPECT_THAT(ends.frames, ElementsAre(can::data_frame(0x581, {0x43, 0x18, 0x10, 0x01, 1, 0, 0, 0})));
}

TEST_F(SocketcandDialogueTest, FrameWithoutData_IsHeard) {
  join();
  dialogue.receive("< frame 080 0.000000  >");
  EXPECT_THAT(ends.frames, ElementsAre(can::data_frame(0x080)));
}

TEST_F(SocketcandDialogueTest, FrameWithBlanksBetweenBytes_IsHeard) {
  join();
  dialogue.receive("< frame 123 23.424242 11 22 33 >");
  EXPECT_THAT(ends.frames, ElementsAre(can::data_frame(0x123, {0x11, 0x22, 0x33})));
}

TEST_F(SocketcandDialogueTest, FrameWithEightDigits_IsExtended) {
  join();
  dialogue.receive("< frame 00000123 1.000000 01 >");
  Frame expected = can::data_frame(0x123, {1});
  expected.extended = true;
  EXPECT_THAT(ends.frames, ElementsAre(expected));
}

TEST_F(SocketcandDialogueTest, FrameBeforeTheSecondOk_EndsTheConversation) {
  dialogue.receive("< hi >< ok >< frame 080 0.000000  >");
  EXPECT_EQ(dialogue.state(), State::failed);
  EXPECT_THAT(ends.frames, IsEmpty());
}

TEST_F(SocketcandDialogueTest, ErrorOfTheServer_IsPassedOnAndFramesGoOn) {
  join();
  dialogue.receive("< error lost 12 frames, read faster >< frame 080 0.000000  >");
  EXPECT_THAT(ends.complaints, ElementsAre("lost 12 frames, read faster"));
  EXPECT_EQ(ends.frames.size(), 1U);
}

TEST_F(SocketcandDialogueTest, ErrorFrame_IsSaidInWordsOnceUntilAFrameComes) {
  join();
  dialogue.receive("< error 020 1.000345 >< error 020 1.100345 >");
  EXPECT_THAT(ends.complaints, ElementsAre("no acknowledgement: no other node on this bus"));
  dialogue.receive("< frame 080 2.0  >< error 020 3.0 >< error 100 3.5 >");
  EXPECT_EQ(ends.complaints.size(), 2U);
  EXPECT_EQ(ends.complaints.back(), ends.complaints.front());
}

class SocketcandWrongFrame : public SocketcandDialogueTest,
                             public testing::WithParamInterface<const char*> {};

TEST_P(SocketcandWrongFrame, IsAComplaintAndNotHeard) {
  join();
  dialogue.receive(GetParam());
  EXPECT_THAT(ends.complaints, ElementsAre("a frame that cannot be read"));
  EXPECT_THAT(ends.frames, IsEmpty());
  EXPECT_EQ(dialogue.state(), State::raw);
}

INSTANTIATE_TEST_SUITE_P(Frames, SocketcandWrongFrame,
                         testing::Values("< frame >", "< frame xyz 0.0 11 >", "< frame 800 0.0 11 >",
                                         "< frame 20000000 0.0 11 >", "< frame 123 0.0 1 >",
                                         "< frame 123 0.0 112233445566778899 >", "< frame 123 0.0 zz >"));

TEST_F(SocketcandDialogueTest, ErrorFrames_AreToldEachByItsClass) {
  join();
  dialogue.receive("< error 040 12.000345 >< error 100 12.5 >< error 100 12.5 >< error too many clients >");
  EXPECT_THAT(ends.errors, ElementsAre(0x040U, 0x100U, 0x100U));
}

RC_GTEST_PROP(SocketcandDialogueBytes, CutAnywhere_AreTheSameFrames, ()) {
  const std::string text =
      "< hi >< ok >< ok >< frame 581 12.000345 4318100101000000 >< error x >< frame 080 0.0  >";
  Ends ends;
  SocketcandDialogue dialogue("line1", ends);
  for (std::size_t from = 0; from < text.size();) {
    const auto size = *rc::gen::inRange<std::size_t>(1, 20);
    dialogue.receive(std::string_view(text).substr(from, size));
    from += size;
  }
  RC_ASSERT(ends.frames.size() == 2U);
  RC_ASSERT(ends.frames[0] == can::data_frame(0x581, {0x43, 0x18, 0x10, 0x01, 1, 0, 0, 0}));
  RC_ASSERT(ends.complaints.size() == 1U);
}

}  // namespace
}  // namespace canopus::link::socketcand_dialogue_test
