#include "canopus/link/socketcand_session.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::link::socketcand_session_test {
namespace {

using can::Frame;
using can::Time;
using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;
using State = SocketcandSession::State;

/// A bus that takes so many frames, and a connection that keeps what it is given.
struct Ends : can::Sink, SocketcandSession::Peer {
  bool send(const Frame& frame) override {
    if (frames.size() >= room) return false;
    frames.push_back(frame);
    return true;
  }
  void message(std::string_view text) override { messages.emplace_back(text); }
  void filtered_frame(const Frame& frame, Time when) override {
    std::array<char, socketcand_max_message> text{};
    const std::size_t size = write_socketcand_frame(text, frame, when, SocketcandData::apart);
    messages.emplace_back(text.data(), size);
  }
  Time now() const override { return time; }
  bool restart(std::uint32_t bit_rate) override {
    bit_rates.push_back(bit_rate);
    return own_bit_rate;
  }

  Time time{};
  std::vector<std::uint32_t> bit_rates;
  bool own_bit_rate = true;
  std::size_t room = 1000;
  std::vector<Frame> frames;
  std::vector<std::string> messages;
};

class SocketcandSessionTest : public testing::Test {
 protected:
  void open_raw() {
    session.start();
    session.receive("< open line1 >");
    session.receive("< rawmode >");
    ends.messages.clear();
  }

  Ends ends;
  SocketcandSession session{"line1", ends, ends};
};

std::string text_of(const Frame& frame, Time time) {
  std::array<char, socketcand_max_message> text{};
  const std::size_t size = write_socketcand_frame(text, frame, time);
  return {text.data(), size};
}

TEST(SocketcandFrame, BaseFrame_HasThreeDigitsAndDataWithoutBlanks) {
  EXPECT_EQ(text_of(can::data_frame(0x081, {0x11, 0xAB, 0x0C}), Time(23s + 424242us)),
            "< frame 081 23.424242 11AB0C >");
}

TEST(SocketcandFrame, ExtendedFrame_HasEightDigits) {
  Frame frame = can::data_frame(0x123, {1});
  frame.extended = true;
  EXPECT_EQ(text_of(frame, Time(1us)), "< frame 00000123 0.000001 01 >");
}

TEST(SocketcandFrame, FrameWithoutData_KeepsBothBlanks) {
  EXPECT_EQ(text_of(can::data_frame(0x080), Time(0s)), "< frame 080 0.000000  >");
}

TEST_F(SocketcandSessionTest, Start_SaysHi) {
  session.start();
  EXPECT_THAT(ends.messages, ElementsAre("< hi >"));
}

TEST_F(SocketcandSessionTest, BitRate_IsSetAtAnyTime_WithOrWithoutTheNameOfTheBus) {
  session.receive("< line1 B 500000 0.875 125 6 7 2 1 4 >");
  open_raw();
  session.receive("< line1 B 10000 >< B 1000000 >");
  EXPECT_THAT(ends.bit_rates, ElementsAre(500'000U, 10'000U, 1'000'000U));
  EXPECT_THAT(ends.messages, ElementsAre("< ok >", "< ok >"));
  EXPECT_EQ(session.state(), State::raw);
}

TEST_F(SocketcandSessionTest, BitRate_NoNetworkHas_OrOfAnotherBus_IsRefusedAndChangesNothing) {
  open_raw();
  for (const char* wrong :
       {"< line1 B 333333 >", "< B >", "< B 500k >", "< line1 B 99999999999999999999 >"}) {
    session.receive(wrong);
    EXPECT_EQ(ends.messages.back(),
              "< error B: expected 10000 to 1000000 bit/s, of those that CAN networks have >");
  }
  session.receive("< line2 B 500000 >");
  EXPECT_EQ(ends.messages.back(), "< error unknown command >");
  EXPECT_THAT(ends.bit_rates, IsEmpty());
}

TEST_F(SocketcandSessionTest, BitRate_OfABusWhereItIsNotSetFromHere_IsRefused) {
  open_raw();
  ends.own_bit_rate = false;
  session.receive("< B 500000 >");
  EXPECT_EQ(ends.messages.back(), "< error B: the bit rate of this bus is not set from here >");
}

TEST_F(SocketcandSessionTest, Open_OfTheBus_IsAnsweredAndIsStillQuiet) {
  session.receive("< open line1 >");
  EXPECT_THAT(ends.messages, ElementsAre("< ok >"));
  EXPECT_EQ(session.state(), State::quiet);
}

TEST_F(SocketcandSessionTest, Open_OfAnotherBus_IsAnErrorAndTheEnd) {
  session.receive("< open can7 >");
  EXPECT_THAT(ends.messages, ElementsAre("< error could not open bus >"));
  EXPECT_EQ(session.state(), State::closed);
}

TEST_F(SocketcandSessionTest, OpenWithoutAName_OpensTheOnlyBus) {
  session.receive("< open >");
  EXPECT_THAT(ends.messages, ElementsAre("< ok >"));
  EXPECT_EQ(session.state(), State::quiet);
}

TEST_F(SocketcandSessionTest, OpenOfTwoNames_IsAnErrorAndTheEnd) {
  session.receive("< open line1 line2 >");
  EXPECT_THAT(ends.messages, ElementsAre("< error could not open bus >"));
  EXPECT_EQ(session.state(), State::closed);
}

TEST_F(SocketcandSessionTest, Rawmode_IsAnsweredAndWantsFrames) {
  session.receive("< open line1 >");
  session.receive("< rawmode >");
  EXPECT_THAT(ends.messages, ElementsAre("< ok >", "< ok >"));
  EXPECT_EQ(session.state(), State::raw);
}

TEST_F(SocketcandSessionTest, Bcmmode_EndsTheFrames) {
  open_raw();
  session.receive("< bcmmode >");
  EXPECT_THAT(ends.messages, ElementsAre("< ok >"));
  EXPECT_EQ(session.state(), State::quiet);
}

TEST_F(SocketcandSessionTest, Echo_ComesBack) {
  open_raw();
  session.receive("< echo >");
  EXPECT_THAT(ends.messages, ElementsAre("< echo >"));
}

TEST_F(SocketcandSessionTest, CommandBeforeOpen_IsAnError) {
  session.receive("< rawmode >");
  EXPECT_THAT(ends.messages, ElementsAre("< error unknown command, expected open >"));
  EXPECT_EQ(session.state(), State::no_bus);
}

TEST_F(SocketcandSessionTest, SendBeforeOpen_ReachesNoBus) {
  session.receive("< send 0 2 1 5 >");
  EXPECT_THAT(ends.frames, IsEmpty());
}

TEST_F(SocketcandSessionTest, UnknownCommand_IsAnErrorAndTheSessionGoesOn) {
  open_raw();
  session.receive("< publish 0 0 123 >< echo >");
  EXPECT_THAT(ends.messages, ElementsAre("< error unknown command >", "< echo >"));
}

TEST_F(SocketcandSessionTest, Send_PutsTheFrameOnTheBus) {
  open_raw();
  session.receive("< send 601 8 40 18 10 1 0 0 0 ff >");
  EXPECT_THAT(ends.frames, ElementsAre(can::data_frame(0x601, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0xFF})));
  EXPECT_THAT(ends.messages, IsEmpty());
}

TEST_F(SocketcandSessionTest, SendWithoutData_NeedsNoMoreThanOneBlank) {
  open_raw();
  session.receive("< send 80 0  >< send 80 0 >");  // python-can writes two blanks
  EXPECT_THAT(ends.frames, ElementsAre(can::data_frame(0x080), can::data_frame(0x080)));
}

TEST_F(SocketcandSessionTest, SendWithEightDigits_IsAnExtendedFrame) {
  open_raw();
  session.receive("< send 00000601 1 5 >");
  Frame expected = can::data_frame(0x601, {5});
  expected.extended = true;
  EXPECT_THAT(ends.frames, ElementsAre(expected));
}

TEST_F(SocketcandSessionTest, Sendrtr_IsARemoteFrame) {
  open_raw();
  session.receive("< sendrtr 705 1 >");
  EXPECT_THAT(ends.frames, ElementsAre(can::remote_frame(0x705, 1)));
}

struct WrongSend {
  const char* command;
  const char* error;
};

class SocketcandWrongSend : public SocketcandSessionTest, public testing::WithParamInterface<WrongSend> {};

TEST_P(SocketcandWrongSend, IsAnErrorThatNamesTheFieldAndSendsNothing) {
  open_raw();
  session.receive(GetParam().command);
  EXPECT_THAT(ends.messages, ElementsAre(GetParam().error));
  EXPECT_THAT(ends.frames, IsEmpty());
  EXPECT_EQ(session.state(), State::raw);
}

INSTANTIATE_TEST_SUITE_P(
    Fields, SocketcandWrongSend,
    testing::Values(
        WrongSend{"< send >", "< error send: expected an identifier of 1 to 8 hexadecimal digits >"},
        WrongSend{"< send x 0 >", "< error send: expected an identifier of 1 to 8 hexadecimal digits >"},
        WrongSend{"< send -1 0 >", "< error send: expected an identifier of 1 to 8 hexadecimal digits >"},
        WrongSend{"< send 000000601 0 >",
                  "< error send: expected an identifier of 1 to 8 hexadecimal digits >"},
        WrongSend{"< send 800 0 >",
                  "< error send: expected an identifier up to 7FF, or of 8 digits up to 1FFFFFFF >"},
        WrongSend{"< send 20000000 0 >",
                  "< error send: expected an identifier up to 7FF, or of 8 digits up to 1FFFFFFF >"},
        WrongSend{"< send 1 >", "< error send: expected a length of 0 to 8 >"},
        WrongSend{"< send 1 9 1 2 3 4 5 6 7 8 9 >", "< error send: expected a length of 0 to 8 >"},
        WrongSend{"< send 1 2 1 >", "< error send: expected as many bytes as the length says, 0 to FF >"},
        WrongSend{"< send 1 1 100 >", "< error send: expected as many bytes as the length says, 0 to FF >"},
        WrongSend{"< send 1 1 1 2 >", "< error send: expected no more bytes than the length says >"}));

class SocketcandBcmTest : public SocketcandSessionTest {
 protected:
  SocketcandBcmTest() {
    session.receive("< open line1 >");
    ends.messages.clear();
  }
  void hear(std::initializer_list<std::uint8_t> bytes) {
    session.filter(can::data_frame(0x123, bytes), Time(23s + 424242us));
  }
};

TEST_F(SocketcandBcmTest, Subscribe_PassesFramesWithBlanksBetweenTheirBytes) {
  session.receive("< subscribe 0 0 123 >");
  EXPECT_THAT(ends.messages, IsEmpty()) << "the protocol has no answer";
  hear({0x11, 0x22, 0x33, 0x44});
  hear({});
  EXPECT_THAT(ends.messages, ElementsAre("< frame 123 23.424242 11 22 33 44 >", "< frame 123 23.424242  >"));
  session.receive("< unsubscribe 123 >");
  hear({0x11});
  EXPECT_EQ(ends.messages.size(), 2U);
}

TEST_F(SocketcandBcmTest, SubscribeOfEightDigits_IsOfAnExtendedIdentifier) {
  session.receive("< subscribe 0 0 00000123 >");
  hear({1});
  Frame frame = can::data_frame(0x123, {1});
  frame.extended = true;
  session.filter(frame, Time(1s));
  EXPECT_THAT(ends.messages, ElementsAre("< frame 00000123 1.000000 01 >"));
}

TEST_F(SocketcandBcmTest, Filter_PassesChangesAndThrottlesThem) {
  session.receive("< filter 1 500000 123 1 FF >");
  session.filter(can::data_frame(0x123, {1, 1}), Time(1s));
  session.filter(can::data_frame(0x123, {1, 2}), Time(2s));
  session.filter(can::data_frame(0x123, {2, 2}), Time(2s));
  EXPECT_THAT(ends.messages, ElementsAre("< frame 123 1.000000 01 01 >"));
  EXPECT_EQ(session.alarm(), Time(2500ms));
  session.tick(Time(2500ms));
  EXPECT_EQ(ends.messages.back(), "< frame 123 2.000000 02 02 >");
}

TEST_F(SocketcandBcmTest, Muxfilter_PassesTheNumbersThatItHas) {
  session.receive("< muxfilter 0 0 123 2 FF 00 00 00 00 00 00 00 33 FF FF FF FF FF FF FF >");
  hear({0x33, 1});
  hear({0x33, 1});
  hear({0x44, 1});
  EXPECT_THAT(ends.messages, ElementsAre("< frame 123 23.424242 33 01 >"));
}

TEST_F(SocketcandBcmTest, MuxfilterOf257Contents_IsTheLongestElement) {
  std::string command = "< muxfilter 0 0 123 257";
  for (int i = 0; i < 257; ++i) command += " FF FF FF FF FF FF FF FF";
  session.receive(command + " >");
  EXPECT_THAT(ends.messages, IsEmpty());
  session.receive("< muxfilter " + std::string(socketcand_max_muxfilter, '0'));
  EXPECT_EQ(session.state(), State::closed);
}

TEST_F(SocketcandBcmTest, Add_SendsInAPeriod_UpdateAndDeleteChangeIt) {
  session.receive("< add 0 20000 123 4 42 42 42 42 >");
  EXPECT_THAT(ends.frames, ElementsAre(can::data_frame(0x123, {0x42, 0x42, 0x42, 0x42})));
  EXPECT_EQ(session.alarm(), Time(20ms));
  session.receive("< update 123 3 11 22 33 >");
  session.tick(Time(20ms));
  EXPECT_EQ(ends.frames.back(), can::data_frame(0x123, {0x11, 0x22, 0x33}));
  session.receive("< delete 123 >");
  EXPECT_EQ(session.alarm(), can::never);
  EXPECT_THAT(ends.messages, IsEmpty());
}

TEST_F(SocketcandBcmTest, Rawmode_EndsJobsAndFilters) {
  session.receive("< add 1 0 123 0 >< subscribe 0 0 123 >< rawmode >< bcmmode >");
  EXPECT_EQ(session.alarm(), can::never);
  ends.messages.clear();
  hear({1});
  EXPECT_THAT(ends.messages, IsEmpty());
}

TEST_F(SocketcandBcmTest, InRawmode_JobsAndFiltersAreErrors) {
  session.receive("< rawmode >");
  ends.messages.clear();
  session.receive("< subscribe 0 0 123 >< add 1 0 123 0 >");
  EXPECT_THAT(ends.messages, ElementsAre("< error subscribe: expected in bcmmode, not in rawmode >",
                                         "< error add: expected in bcmmode, not in rawmode >"));
  EXPECT_THAT(ends.frames, IsEmpty());
}

TEST_F(SocketcandBcmTest, ClientThatIsGone_HasNoJobs) {
  session.receive("< add 1 0 123 0 >");
  session.drop();
  EXPECT_EQ(session.alarm(), can::never);
}

TEST_F(SocketcandBcmTest, OtherModes_AreRefusedInASentence) {
  session.receive("< isotpmode >< isotpconf 1 2 0 0 0 >< controlmode >< statistics 1000 >< list >");
  EXPECT_THAT(ends.messages,
              ElementsAre("< error isotpmode: ISO-TP is not offered here, frames alone >",
                          "< error isotpconf: ISO-TP is not offered here, frames alone >",
                          "< error controlmode: statistics are not offered here >",
                          "< error statistics: statistics are not offered here >",
                          "< error list: no command of the protocol; the only bus here is line1 >"));
  EXPECT_EQ(session.state(), State::quiet);
}

TEST_F(SocketcandSessionTest, ListBeforeOpen_NamesTheBus) {
  session.receive("< list >");
  EXPECT_THAT(ends.messages,
              ElementsAre("< error list: no command of the protocol; the only bus here is line1 >"));
  EXPECT_EQ(session.state(), State::no_bus);
}

class SocketcandWrongBcm : public SocketcandBcmTest, public testing::WithParamInterface<WrongSend> {};

TEST_P(SocketcandWrongBcm, IsAnErrorThatNamesTheFieldAndChangesNothing) {
  session.receive(GetParam().command);
  EXPECT_THAT(ends.messages, ElementsAre(GetParam().error));
  EXPECT_THAT(ends.frames, IsEmpty());
  EXPECT_EQ(session.alarm(), can::never);
  ends.messages.clear();
  hear({1});
  EXPECT_THAT(ends.messages, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Fields, SocketcandWrongBcm,
    testing::Values(
        WrongSend{"< subscribe 123 >", "< error subscribe: expected seconds and microseconds >"},
        WrongSend{"< subscribe 0 x 123 >", "< error subscribe: expected seconds and microseconds >"},
        WrongSend{"< subscribe 2000000000 0 123 >", "< error subscribe: expected seconds and microseconds >"},
        WrongSend{"< subscribe 0 0 >",
                  "< error subscribe: expected an identifier of 1 to 8 hexadecimal digits >"},
        WrongSend{"< subscribe 0 0 123 1 >", "< error subscribe: expected fewer words >"},
        WrongSend{"< unsubscribe 123 >", "< error unsubscribe: this identifier has no filter >"},
        WrongSend{"< filter 0 0 123 9 >", "< error filter: expected a length of 0 to 8 >"},
        WrongSend{"< filter 0 0 123 2 FF >",
                  "< error filter: expected as many bytes as the length says, 0 to FF >"},
        WrongSend{"< filter 0 0 123 1 FF FF >", "< error filter: expected fewer words >"},
        WrongSend{"< muxfilter 0 0 123 1 FF >", "< error muxfilter: expected 2 to 257 contents of 8 bytes >"},
        WrongSend{"< muxfilter 0 0 123 258 FF >",
                  "< error muxfilter: expected 2 to 257 contents of 8 bytes >"},
        WrongSend{"< muxfilter 0 0 123 2 FF 0 0 0 0 0 0 0 33 >",
                  "< error muxfilter: expected 8 bytes for each content, 0 to FF >"},
        WrongSend{"< add 1 0 123 1 >", "< error add: expected as many bytes as the length says, 0 to FF >"},
        WrongSend{"< add 1 123 0 >", "< error add: expected a length of 0 to 8 >"},
        WrongSend{"< update 123 1 11 >", "< error update: no frame of this identifier is sent >"},
        WrongSend{"< delete 123 >", "< error delete: no frame of this identifier is sent >"},
        WrongSend{"< delete 123 0 >", "< error delete: expected nothing behind the identifier >"}));

TEST_F(SocketcandSessionTest, GarbageBetweenElements_IsAnErrorAndTheEnd) {
  open_raw();
  session.receive("GET / HTTP/1.1\r\n< echo >");
  EXPECT_THAT(ends.messages, ElementsAre("< error expected an element in angle brackets >"));
  EXPECT_EQ(session.state(), State::closed);
}

TEST_F(SocketcandSessionTest, BlanksAndLineEndsBetweenElements_AreAllowed) {
  open_raw();
  session.receive("\r\n < echo >\n");
  EXPECT_THAT(ends.messages, ElementsAre("< echo >"));
}

TEST_F(SocketcandSessionTest, ElementOf128Characters_IsStillUnderstood) {
  open_raw();
  session.receive("< echo" + std::string(121, ' ') + ">");
  EXPECT_THAT(ends.messages, ElementsAre("< echo >"));
}

TEST_F(SocketcandSessionTest, ElementOf129Characters_IsAnErrorAndTheEnd) {
  open_raw();
  session.receive("< echo" + std::string(122, ' ') + ">");
  EXPECT_THAT(ends.messages, ElementsAre("< error element longer than 128 characters >"));
  EXPECT_EQ(session.state(), State::closed);
}

TEST_F(SocketcandSessionTest, ElementWithoutEnd_IsCutOffBeforeItEatsMemory) {
  open_raw();
  session.receive("<" + std::string(127, 'a'));
  EXPECT_THAT(ends.messages, ElementsAre("< error element longer than 128 characters >"));
}

TEST_F(SocketcandSessionTest, ElementInsideAnElement_IsTakenAsANewOne) {
  open_raw();
  session.receive("< send 1 < echo >");
  EXPECT_THAT(ends.messages,
              ElementsAre("< error expected a closing bracket, found another opening one >", "< echo >"));
}

TEST_F(SocketcandSessionTest, AfterTheEnd_NothingIsAnswered) {
  session.receive("< open can7 >");
  ends.messages.clear();
  session.receive("< open line1 >");
  EXPECT_THAT(ends.messages, IsEmpty());
}

TEST_F(SocketcandSessionTest, FrameTheBusRefuses_WaitsAndHoldsUpWhatFollows) {
  open_raw();
  ends.room = 1;
  session.receive("< send 1 0 >< send 2 0 >< echo >");
  EXPECT_TRUE(session.waiting());
  EXPECT_THAT(ends.frames, ElementsAre(can::data_frame(1)));
  EXPECT_THAT(ends.messages, IsEmpty());
}

TEST_F(SocketcandSessionTest, Resume_GoesOnInOrder) {
  open_raw();
  ends.room = 1;
  session.receive("< send 1 0 >< send 2 0 >< echo >");
  ends.room = 2;
  session.resume();
  EXPECT_FALSE(session.waiting());
  EXPECT_THAT(ends.frames, ElementsAre(can::data_frame(1), can::data_frame(2)));
  EXPECT_THAT(ends.messages, ElementsAre("< echo >"));
}

TEST_F(SocketcandSessionTest, ResumeWhileTheBusIsStillFull_GoesOnWaiting) {
  open_raw();
  ends.room = 0;
  session.receive("< send 1 0 >");
  session.resume();
  EXPECT_TRUE(session.waiting());
}

constexpr char conversation[] =
    "< open line1 >< rawmode >< send 601 8 40 0 10 0 0 0 0 0 >\n< echo >< what >< send 0 2 1 5 >";

TEST_F(SocketcandSessionTest, DropWaiting_LosesWhatTheBusDoesNotTakeAndGoesOn) {
  open_raw();
  ends.room = 0;
  session.receive("< send 1 0 >< send 2 0 >< echo >< send 3 0 >< send 4");
  session.drop_waiting();
  EXPECT_FALSE(session.waiting());
  EXPECT_THAT(ends.messages, ElementsAre("< echo >"));
  EXPECT_EQ(session.frames_dropped(), 3U);
  ends.room = 1000;
  session.receive(" 0 >");
  EXPECT_THAT(ends.frames, ElementsAre(can::data_frame(0x004)));
}

TEST_F(SocketcandSessionTest, Drop_CountsTheFramesThatTheBusHasNotTaken) {
  open_raw();
  ends.room = 0;
  session.receive("< send 1 0 >< send 2 0 >< echo >< sendrtr 3 1 >< se");
  session.drop();
  ends.room = 1000;
  session.resume();
  session.receive("nd 4 0 >< send 5");
  EXPECT_THAT(ends.frames, IsEmpty());
  EXPECT_THAT(ends.messages, IsEmpty());
  EXPECT_EQ(session.frames_dropped(), 4U);
}

RC_GTEST_PROP(SocketcandSessionProperties, AnyChunking_GivesTheSameConversation, ()) {
  Ends ends;
  SocketcandSession session("line1", ends, ends);
  std::string_view rest = conversation;
  while (!rest.empty()) {
    const auto size = *rc::gen::inRange<std::size_t>(1, rest.size() + 1);
    session.receive(rest.substr(0, size));
    rest.remove_prefix(size);
  }
  RC_ASSERT(ends.messages ==
            (std::vector<std::string>{"< ok >", "< ok >", "< echo >", "< error unknown command >"}));
  RC_ASSERT(ends.frames == (std::vector<Frame>{can::data_frame(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}),
                                               can::data_frame(0x000, {0x01, 0x05})}));
}

RC_GTEST_PROP(SocketcandSessionProperties, AnyBytes_GiveWellFormedAnswersOnly, ()) {
  Ends ends;
  SocketcandSession session("line1", ends, ends);
  session.receive("< open line1 >");
  const auto words = *rc::gen::container<std::vector<std::string>>(
      rc::gen::element<std::string>("<", ">", " ", "send", "echo", "0", "8", "7FF", "\xFF", "\n", "add",
                                    "subscribe", "filter", "muxfilter", "update", "delete", "list"));
  for (const std::string& word : words) {
    session.receive(word);
    session.filter(can::data_frame(0x7FF, {1}), ends.time);
    ends.time += 1ms;
    session.tick(ends.time);
  }
  for (const std::string& message : ends.messages) {
    RC_ASSERT(message.size() <= socketcand_max_message);
    RC_ASSERT(message.starts_with("< "));
    RC_ASSERT(message.ends_with(" >"));
    RC_ASSERT(std::ranges::count_if(message, [](char c) { return c == '<' || c == '>'; }) == 2);
  }
}

}  // namespace
}  // namespace canopus::link::socketcand_session_test
