// The stream of bytes around the requests: halves, floods, what is no request at all, and any bytes whatever.

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "plc/conversation.hpp"

namespace canopus::plc::melsec_session_test {
namespace {

using testing::bytes;
using testing::Plc;
using testing::shown;

const std::string read_d100 =
    bytes("54 00 01 00 00 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00");
constexpr std::size_t read_d100_reply = 17;

TEST(MelsecSession, HalfARequest_WaitsForTheRest) {
  Plc plc;
  for (std::size_t i = 0; i + 1 < read_d100.size(); ++i) {
    EXPECT_EQ(plc.raw(read_d100.substr(i, 1)), "");
    EXPECT_TRUE(plc.session->half_request());
  }
  EXPECT_EQ(plc.raw(read_d100.substr(read_d100.size() - 1)).size(), read_d100_reply);
  EXPECT_FALSE(plc.session->half_request());
}

TEST(MelsecSession, HalfAnAsciiRequest_WaitsForTheRest) {
  Plc plc;
  const std::string request = "500000FF03FF000018000404010000D*0001000001";
  for (std::size_t i = 0; i + 1 < request.size(); ++i) EXPECT_EQ(plc.raw(request.substr(i, 1)), "");
  EXPECT_EQ(plc.raw("1"), "D00000FF03FF00000800000000");
}

TEST(MelsecSession, HasRequest_FromTheLastByteOfARequestOn) {
  for (const std::string& request :
       {read_d100, std::string("500000FF03FF000018000404010000D*0001000001"),
        bytes("01 ff 0a 00 64 00 00 00 20 44 01 00"), std::string("01ff000A4420000000640100")}) {
    Plc plc(r04cpu(), {.takes_1e = true});
    for (std::size_t i = 0; i < request.size(); ++i) {
      EXPECT_FALSE(plc.session->has_request()) << i << " bytes of " << shown(request);
      plc.session->space()[0] = static_cast<std::uint8_t>(request[i]);
      plc.session->received(1);
    }
    EXPECT_TRUE(plc.session->has_request()) << shown(request);
    EXPECT_EQ(plc.session->process(plc.now), 1U);
    EXPECT_FALSE(plc.session->has_request()) << shown(request);
  }
}

TEST(MelsecSession, HasRequest_WhereWhatHasComeIsNone_UntilTheSessionIsOver) {
  for (const std::string& request :
       {std::string("X"), bytes("50 01"), bytes("50 00 00 ff ff 03 00 ff ff"), bytes("0b")}) {
    Plc plc(r04cpu(), {.takes_1e = request[0] == 0x0b});
    std::ranges::copy(request, plc.session->space().begin());
    plc.session->received(request.size());
    EXPECT_TRUE(plc.session->has_request()) << shown(request);
    plc.session->process(plc.now);
    EXPECT_FALSE(plc.session->has_request()) << shown(request);
  }
}

TEST(MelsecSession, AskedInBetween_ItAnswersTheSame) {
  const std::string two_words = bytes("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 02 00");
  std::string other_serial = read_d100;
  other_serial[2] = 7;
  const std::string stream = read_d100 + two_words + other_serial + bytes("50 00 00 ff ff 03 00 02 00 10 00");
  const std::string plain = Plc().raw(stream);
  for (std::size_t cut = 1; cut <= stream.size(); ++cut) {
    Plc plc;
    const auto receive = [&plc](const std::string& part) {
      std::ranges::copy(part, plc.session->space().begin());
      plc.session->received(part.size());
    };
    receive(stream.substr(0, cut));
    (void)plc.session->has_request();
    if (cut < stream.size()) receive(stream.substr(cut));
    plc.session->process(plc.now);
    const auto output = plc.session->output();
    EXPECT_EQ(shown({reinterpret_cast<const char*>(output.data()), output.size()}), shown(plain))
        << "asked after " << cut << " bytes";
  }
}

TEST(MelsecSession, RequestsInOneSegment_AreAnsweredInOneOutput) {
  Plc plc;
  std::string requests;
  for (char serial = 1; serial <= 100; ++serial) {
    requests += read_d100;
    requests[requests.size() - read_d100.size() + 2] = serial;
  }
  const auto space = plc.session->space();
  std::ranges::copy(requests, space.begin());
  plc.session->received(requests.size());
  EXPECT_EQ(plc.session->process(plc.now), 100U);
  const auto output = plc.session->output();
  ASSERT_EQ(output.size(), 100 * read_d100_reply);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(output[i * read_d100_reply + 2], i + 1);
}

TEST(MelsecSession, ClientThatTakesNoReplies_IsNotAnsweredFurtherAndLosesNothing) {
  Plc plc;
  // 960 words: 1931 bytes a reply.
  const std::string request = bytes("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 00 00 00 a8 c0 03");
  std::size_t asked = 0;
  std::size_t answered = 0;
  while (plc.session->space().size() >= request.size()) {
    std::ranges::copy(request, plc.session->space().begin());
    plc.session->received(request.size());
    ++asked;
    answered += plc.session->process(plc.now);
  }
  EXPECT_LE(plc.session->output().size(), 65536U);
  EXPECT_LT(answered, asked);
  while (!plc.session->output().empty()) {
    plc.session->sent(plc.session->output().size());
    answered += plc.session->process(plc.now);
  }
  EXPECT_EQ(answered, asked);
}

TEST(MelsecSession, WhatIsNoRequest_EndsTheSessionWithoutAnAnswer) {
  for (const char* text : {"GET / HTTP/1.1\r\n", "\x01\xff", "5100", "50000000000000000G0000", "X"}) {
    Plc plc;
    EXPECT_EQ(plc.raw(text), "") << text;
    EXPECT_TRUE(plc.session->over()) << text;
  }
  Plc plc;
  EXPECT_EQ(plc.raw(bytes("50 01 00")), "");
  EXPECT_TRUE(plc.session->over());
}

TEST(MelsecSession, OtherDataCodeLater_EndsTheSession) {
  Plc plc;
  EXPECT_EQ(plc.raw(read_d100).size(), read_d100_reply);
  EXPECT_EQ(plc.raw("500000FF03FF00000C001001010000"), "");
  EXPECT_TRUE(plc.session->over());
}

TEST(MelsecSession, LengthThatNoRequestHas_IsRefusedAndEndsTheSession) {
  Plc plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 01 18 10 00"),
            "d0 00 00 ff ff 03 00 0b 00 61 c0 00 ff ff 03 00 00 00 00 00");
  EXPECT_TRUE(plc.session->over());
}

TEST(MelsecSession, LongestRequest_IsReadToItsEnd) {
  Plc plc;
  // 1401 in ASCII with 960 words.
  std::string request = "500000FF03FF000F18001014010000D*00000003C0";
  for (int i = 0; i < 960; ++i) request += "0A0B";
  EXPECT_EQ(plc.raw(request), "D00000FF03FF0000040000");
  EXPECT_EQ(plc.word(Device::d, 959), 0x0A0B);
}

RC_GTEST_PROP(MelsecSession, AnyChunking_GivesTheSameAnswers, ()) {
  const std::string conversation =
      read_d100 + bytes("50 00 00 ff ff 03 00 06 00 10 00 99 99 00 00") + read_d100;
  const std::string whole = Plc{}.raw(conversation);
  Plc plc;
  std::string reply;
  for (std::size_t at = 0; at < conversation.size();) {
    const std::size_t count = *rc::gen::inRange<std::size_t>(1, 30);
    reply += plc.raw(std::string_view(conversation).substr(at, count));
    at += count;
  }
  RC_ASSERT(reply == whole);
}

RC_GTEST_PROP(MelsecSession, AnyBytes_LeaveTheSessionUsableOrOver, ()) {
  // Half of them look like requests, so that they come past the header.
  auto stream = *rc::gen::container<std::string>(rc::gen::arbitrary<char>());
  if (*rc::gen::arbitrary<bool>())
    stream = bytes("50 00 00 ff ff 03 00") + static_cast<char>(stream.size()) + '\0' + stream;
  Plc plc;
  (void)plc.raw(stream);
  RC_ASSERT(plc.session->over() || !plc.session->space().empty());
  RC_ASSERT(plc.session->output().empty());
}

RC_GTEST_PROP(MelsecSession, WordsWritten_AreReadBack, ()) {
  const auto count = *rc::gen::inRange<unsigned>(1, 961);
  const auto first = *rc::gen::inRange<unsigned>(0, 18432 - count + 1);
  std::string request = bytes("50 00 00 ff ff 03 00 00 00 10 00 01 14 00 00 00 00 00 a8 00 00");
  const auto put = [&](std::size_t at, unsigned value) {
    request[at] = static_cast<char>(value);
    request[at + 1] = static_cast<char>(value >> 8U);
  };
  put(7, 12 + 2 * count);
  put(15, first);
  put(19, count);
  const auto words =
      *rc::gen::container<std::vector<std::uint16_t>>(count, rc::gen::arbitrary<std::uint16_t>());
  for (const std::uint16_t word : words) {
    request += static_cast<char>(word);
    request += static_cast<char>(word >> 8U);
  }
  Plc plc;
  RC_ASSERT(shown(plc.raw(request)) == "d0 00 00 ff ff 03 00 02 00 00 00");
  request.resize(21);
  put(7, 12);
  request[12] = '\x04';
  const std::string reply = plc.raw(request);
  RC_ASSERT(reply.size() == 11 + 2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned low = static_cast<unsigned char>(reply[11 + 2 * i]);
    const unsigned high = static_cast<unsigned char>(reply[12 + 2 * i]);
    RC_ASSERT((high << 8U | low) == words[i]);
  }
}

}  // namespace
}  // namespace canopus::plc::melsec_session_test
