// What is refused in 1E frames, and that nothing happened then; frames in a stream; any bytes.

#include "plc/plc_1e.hpp"

namespace canopus::plc::melsec_1e_refusals_test {
namespace {

// --- refusals ---

TEST(Melsec1e, UnknownSubheader_Is50H) {
  EXPECT_EQ(request("0a ff 0a 00"), "8a 50");
  EXPECT_EQ(request("3c ff 0a 00"), "bc 50");
  EXPECT_EQ(request_ascii("17FF000A"), "9750");
}

TEST(Melsec1e, UnknownSubheader_TakesWhatCameWithItAndNothingElse) {
  Plc1e plc;
  EXPECT_EQ(plc.request("0a ff 0a 00 01 02 03 04 05 06 07 08"), "8a 50");
  EXPECT_FALSE(plc.session->over());
  EXPECT_EQ(plc.request("01 ff 0a 00 64 00 00 00 20 44 01 00"), "81 00 00 00");
}

TEST(Melsec1e, WhatIsNoSubheaderAtAll_EndsTheSession) {
  Plc1e plc;
  EXPECT_EQ(plc.request("47 45 54 20"), "");
  EXPECT_TRUE(plc.session->over());
}

TEST(Melsec1e, AnotherFrame_EndsTheSession) {
  Plc1e plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00"), "");
  EXPECT_TRUE(plc.session->over());
  Plc only_3e;
  EXPECT_EQ(only_3e.request("01 ff 0a 00 64 00 00 00 20 44 01 00"), "");
  EXPECT_TRUE(only_3e.session->over());
}

TEST(Melsec1e, AsciiThatIsNoNumber_Is54H) {
  EXPECT_EQ(request_ascii("01FF000A44200000006x0200"), "8154");
  EXPECT_EQ(request_ascii("01FF00xA4420000000640200"), "8154");
  EXPECT_EQ(request_ascii("03FF000A442000000064x200"), "8354");  // a number of points that is none
  EXPECT_EQ(request_ascii("02FF000A4D200000003202002x"), "8254");
}

TEST(Melsec1e, AsciiInSmallLetters_IsTaken_AndALoopbackStaysAsItWas) {
  Plc1e plc;
  EXPECT_EQ(plc.raw("03ff000a4420000000640200"
                    "1234abcd"),
            "8300");
  EXPECT_EQ(plc.word(Device::d, 101), 0xABCD);
  EXPECT_EQ(plc.raw("16ff000a02abCd"), "960002abCd");
  EXPECT_EQ(plc.raw("13ff000a16ff000a02abcd"), "9300960002abcd");
  EXPECT_EQ(plc.raw("0eff000a000000020000"), "8E000000");
  EXPECT_EQ(plc.datagram("01ff000a4420000000650100"), "8100ABCD");
  EXPECT_EQ(plc.datagram("16ff000a02abCd"), "960002abCd");
}

TEST(Melsec1e, OnlineChange_WhereItIsNotEnabled_Is55HInRunOnly) {
  Plc1e plc(r04cpu(), port_1e(WritePermission::in_stop));
  const std::string requests[] = {
      "02 ff 0a 00 32 00 00 00 20 4d 01 00 10", "03 ff 0a 00 64 00 00 00 20 44 01 00 34 12",
      "04 ff 0a 00 01 00 02 00 00 00 20 4d 01", "05 ff 0a 00 01 00 0a 00 00 00 20 44 34 12",
      "0f ff 0a 00 00 00 00 02 00 00 34 12"};
  for (const std::string& request : requests) EXPECT_EQ(plc.request(request).substr(3), "55") << request;
  EXPECT_EQ(plc.word(Device::d, 100), 0);
  EXPECT_TRUE(plc.module.writes.empty());
  EXPECT_EQ(plc.request("01 ff 0a 00 64 00 00 00 20 44 01 00"), "81 00 00 00");
  EXPECT_EQ(plc.request("14 ff 0a 00"), "94 00");
  for (const std::string& request : requests) EXPECT_EQ(plc.request(request).substr(3), "00") << request;
}

TEST(Melsec1e, ClientThatMayOnlyLook_DoesNotStopTheCpuEither) {
  Plc1e plc(r04cpu(), port_1e(WritePermission::never));
  EXPECT_EQ(plc.request("14 ff 0a 00"), "94 5b 18 00");
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::run);
  EXPECT_EQ(plc.request("03 ff 0a 00 64 00 00 00 20 44 01 00 34 12"), "83 55");
}

TEST(Melsec1e, UnknownDevice_Is56H) {
  EXPECT_EQ(request("01 ff 0a 00 64 00 00 00 20 51 01 00"), "81 56");
  EXPECT_EQ(request("04 ff 0a 00 01 00 02 00 00 00 20 51 01"), "84 56");
  EXPECT_EQ(request_ascii("01FF000A5120000000640100"), "8156");
}

TEST(Melsec1e, MorePointsThanAModuleOfTheQSeriesTakes_Are57H) {
  EXPECT_EQ(request("01 ff 0a 00 00 00 00 00 20 4d 80 00").substr(0, 5), "81 00");  // 128 words of M
  EXPECT_EQ(request("01 ff 0a 00 00 00 00 00 20 4d 81 00"), "81 57");
  const std::string words_41(2 * 41, '\0');
  EXPECT_EQ(shown(Plc1e{}.raw(bytes("03 ff 0a 00 00 00 00 00 20 4d 29 00") + words_41)), "83 57");
  std::string points;
  for (int i = 0; i < 81; ++i) points += bytes("00 00 00 00 20 4d 01");
  Plc1e plc;
  EXPECT_EQ(shown(plc.raw(bytes("04 ff 0a 00 51 00") + points)), "84 57");
  EXPECT_FALSE(plc.bit(Device::m, 0));
  points.clear();
  for (int i = 0; i < 41; ++i) points += bytes("00 00 00 00 20 44 01 00");
  EXPECT_EQ(shown(plc.raw(bytes("05 ff 0a 00 29 00") + points)), "85 57");
  EXPECT_EQ(plc.word(Device::d, 0), 0);
}

TEST(Melsec1e, MorePointsThanAnFx3uTakes_Are57H) {
  const auto fx = [](const std::string& request) { return Plc1e(fx3u()).request(request).substr(0, 5); };
  EXPECT_EQ(fx("01 ff 0a 00 00 00 00 00 20 44 40 00"), "81 00");
  EXPECT_EQ(fx("01 ff 0a 00 00 00 00 00 20 44 41 00"), "81 57");
  EXPECT_EQ(fx("01 ff 0a 00 00 00 00 00 20 4d 20 00"), "81 00");
  EXPECT_EQ(fx("01 ff 0a 00 00 00 00 00 20 4d 21 00"), "81 57");
  const std::string bits_161(81, '\0');
  EXPECT_EQ(shown(Plc1e(fx3u()).raw(bytes("02 ff 0a 00 00 00 00 00 20 4d a1 00") + bits_161)), "82 57");
  EXPECT_EQ(fx("0e ff 0a 00 00 00 00 02 00 00"), "8e 50");  // an FX has no such command
}

TEST(Melsec1e, PointsBeyondTheLastDevice_Are57H_AFirstOneThere58H) {
  EXPECT_EQ(request("01 ff 0a 00 ff 47 00 00 20 44 01 00"), "81 00 00 00");  // D18431
  EXPECT_EQ(request("01 ff 0a 00 ff 47 00 00 20 44 02 00"), "81 57");
  EXPECT_EQ(request("01 ff 0a 00 00 48 00 00 20 44 01 00"), "81 58");
  EXPECT_EQ(request("01 ff 0a 00 ff ff ff ff 20 44 01 00"), "81 58");
  EXPECT_EQ(request_ascii("01FF000A4420FFFFFFFF0100"), "8158");
}

TEST(Melsec1e, WriteBeyondTheLastDevice_WritesNothing) {
  Plc1e plc;
  EXPECT_EQ(plc.request("03 ff 0a 00 ff 47 00 00 20 44 02 00 34 12 78 56"), "83 57");
  EXPECT_EQ(plc.word(Device::d, 18431), 0);
  EXPECT_EQ(plc.request("05 ff 0a 00 02 00 0a 00 00 00 20 44 34 12 00 48 00 00 20 44 01 00"), "85 58");
  EXPECT_EQ(plc.word(Device::d, 10), 0);
}

TEST(Melsec1e, BitsOfWords_AndWordsOfBitsNotFrom16_Are58H) {
  EXPECT_EQ(request("00 ff 0a 00 64 00 00 00 20 44 01 00"), "80 58");
  EXPECT_EQ(request("02 ff 0a 00 64 00 00 00 20 44 01 00 10"), "82 58");
  EXPECT_EQ(request("01 ff 0a 00 11 00 00 00 20 4d 01 00"), "81 58");
  EXPECT_EQ(request("05 ff 0a 00 01 00 11 00 00 00 20 4d 01 00"), "85 58");
}

TEST(Melsec1e, PcNumber_OtherThanFfH_Is5bHWith10H) {
  EXPECT_EQ(request("01 00 0a 00 64 00 00 00 20 44 01 00"), "81 5b 10 00");
  EXPECT_EQ(request_ascii("0100000A4420000000640100"), "815B1000");
  EXPECT_EQ(request("14 01 0a 00"), "94 5b 10 00");
}

TEST(Melsec1e, BufferMemory_WithoutAModule_Is5bHWith12H) {
  EXPECT_EQ(request("0e ff 0a 00 00 00 00 02 55 00"), "8e 5b 12 00");
  EXPECT_EQ(request_ascii("0FFF000A0000000255007856"), "8F5B1200");
}

TEST(Melsec1e, BufferMemory_BeyondTheModules_OrOdd) {
  Plc1e plc;  // the module at 30H has 512 words
  EXPECT_EQ(plc.request("0e ff 0a 00 fe 03 00 02 03 00"), "8e 00 00 00");
  EXPECT_EQ(plc.request("0e ff 0a 00 fe 03 00 04 03 00"), "8e 57");
  EXPECT_EQ(plc.request("0e ff 0a 00 00 04 00 02 03 00"), "8e 58");
  EXPECT_EQ(plc.request("0e ff 0a 00 01 00 00 02 03 00"), "8e 58");
  EXPECT_EQ(plc.request("0e ff 0a 00 00 00 00 03 03 00"), "8e 57");
  EXPECT_EQ(plc.request("0f ff 0a 00 00 00 00 03 03 00 01 02 03"), "8f 57");
  EXPECT_TRUE(plc.other_module.writes.empty());
}

TEST(Melsec1e, LoopbackOfNothing_Is57H) { EXPECT_EQ(request("16 ff 0a 00 00"), "96 57"); }

// --- frames in a stream, and datagrams ---

TEST(Melsec1e, HalfARequest_WaitsForTheRest) {
  Plc1e plc;
  const std::string request = bytes("03 ff 0a 00 64 00 00 00 20 44 02 00 34 12 cd ab");
  for (std::size_t i = 0; i + 1 < request.size(); ++i) {
    EXPECT_EQ(plc.raw(request.substr(i, 1)), "");
    EXPECT_TRUE(plc.session->half_request());
  }
  EXPECT_EQ(shown(plc.raw(request.substr(request.size() - 1))), "83 00");
}

TEST(Melsec1e, RequestsOneBehindTheOther_AreAnsweredInOrder) {
  Plc1e plc;
  EXPECT_EQ(plc.request("03 ff 0a 00 64 00 00 00 20 44 01 00 34 12 | 01 ff 0a 00 64 00 00 00 20 44 01 00"),
            "83 00 81 00 34 12");
}

TEST(Melsec1e, PortForAnyFrame_TakesEachByItsSubheader) {
  Plc plc(r04cpu(), {.takes_1e = true});
  plc.word(Device::d, 100, 0x1234);
  EXPECT_EQ(plc.request("01 ff 0a 00 64 00 00 00 20 44 01 00"), "81 00 34 12");
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00"),
            "d0 00 00 ff ff 03 00 04 00 00 00 34 12");
}

TEST(Melsec1e, DataCodeOfThePort_IsNotTheFirstBytes) {
  Plc1e ascii(r04cpu(), {.takes_3e = false, .takes_1e = true, .code = melsec::DataCode::ascii});
  EXPECT_EQ(ascii.request("01 ff 0a 00 64 00 00 00 20 44 01 00"), "");
  EXPECT_TRUE(ascii.session->over());
  Plc1e binary(r04cpu(), {.takes_3e = false, .takes_1e = true, .code = melsec::DataCode::binary});
  EXPECT_EQ(shown(binary.raw("01FF000A4420000000640100")),
            "b0 50");  // 30H is a subheader, and none that is known
}

TEST(Melsec1e, Datagram_IsOneRequest) {
  Plc1e plc;
  plc.word(Device::d, 100, 0x1234);
  const std::string request = bytes("01 ff 0a 00 64 00 00 00 20 44 01 00");
  EXPECT_EQ(shown(plc.datagram(request)), "81 00 34 12");
  EXPECT_EQ(plc.datagram("01FF000A4420000000640100"), "81001234");  // each with its own data code
  EXPECT_EQ(shown(plc.datagram(request.substr(0, 11))), "81 57");
  EXPECT_EQ(shown(plc.datagram(request + '\0')), "81 57");
  EXPECT_EQ(shown(plc.datagram(bytes("0a ff 0a 00"))), "8a 50");
  EXPECT_EQ(plc.datagram("01FF"), "8157");
  EXPECT_EQ(plc.datagram(""), "");
  EXPECT_EQ(plc.datagram("GET / HTTP/1.1"), "");
  EXPECT_EQ(shown(plc.datagram(request)), "81 00 34 12");
}

// --- any bytes ---

RC_GTEST_PROP(Melsec1e, AnyWords_ComeBackAsTheyWereWritten, ()) {
  Plc1e plc;
  const auto first = *rc::gen::inRange<unsigned>(0, 18000);
  const auto words = *rc::gen::container<std::vector<std::uint16_t>>(*rc::gen::inRange<std::size_t>(1, 257),
                                                                     rc::gen::arbitrary<std::uint16_t>());
  const bool ascii = *rc::gen::arbitrary<bool>();
  std::string head = ascii ? "FF0000" : bytes("ff 00 00");
  std::string data;
  const auto hexadecimal = [](unsigned value, int digits) {
    std::string text;
    for (int i = digits; i-- > 0;) text += "0123456789ABCDEF"[value >> (4 * i) & 0xFU];
    return text;
  };
  const auto number = [&](unsigned value, int size) {
    std::string text;
    for (int i = 0; i < size; ++i) text += static_cast<char>(value >> (8 * i));
    return text;
  };
  const auto count = static_cast<unsigned>(words.size() % 256);
  std::string device;
  if (ascii) {
    device = "4420" + hexadecimal(first, 8) + hexadecimal(count, 2) + "00";
    for (const std::uint16_t word : words) data += hexadecimal(word, 4);
  } else {
    device = number(first, 4) + bytes("20 44") + number(count, 1) + '\0';
    for (const std::uint16_t word : words) data += number(word, 2);
  }
  const std::string write = ascii ? "03" : "\x03";
  const std::string read = ascii ? "01" : "\x01";
  RC_ASSERT(plc.raw(write + head + device + data) == (ascii ? "8300" : bytes("83 00")));
  RC_ASSERT(plc.raw(read + head + device) == (ascii ? "8100" : bytes("81 00")) + data);
}

// --- monitoring ---

TEST(Melsec1eMonitor, Words_AreReadAsTheyWereRegistered) {
  Plc1e plc;
  plc.word(Device::d, 100, 0x1234);
  plc.word(Device::w, 0x1F, 0xABCD);
  plc.word(Device::m, 32, 0x00FF);
  EXPECT_EQ(plc.request("07 ff 0a 00 | 03 00 | 64 00 00 00 20 44 | 1f 00 00 00 20 57 | 20 00 00 00 20 4d"),
            "87 00");
  EXPECT_EQ(plc.request("09 ff 0a 00"), "89 00 34 12 cd ab ff 00");
  plc.word(Device::d, 100, 0x4321);
  EXPECT_EQ(plc.request("09 ff 0a 00"), "89 00 21 43 cd ab ff 00") << "as often as one likes";
  EXPECT_EQ(plc.request("07 ff 0a 00 | 01 00 | 64 00 00 00 20 44"), "87 00");
  EXPECT_EQ(plc.request("09 ff 0a 00"), "89 00 21 43") << "another list takes its place";
}

TEST(Melsec1eMonitor, Bits_OfAnOddNumber_EndWithADummy) {
  Plc1e plc;
  plc.bit(Device::m, 7, true);
  plc.bit(Device::y, 0x25, true);
  EXPECT_EQ(plc.request("06 ff 0a 00 | 03 00 | 07 00 00 00 20 4d | 08 00 00 00 20 4d | 25 00 00 00 20 59"),
            "86 00");
  EXPECT_EQ(plc.request("08 ff 0a 00"), "88 00 10 10");
}

TEST(Melsec1eMonitor, InAscii) {
  Plc1e plc;
  plc.word(Device::d, 100, 0x1234);
  plc.bit(Device::m, 7, true);
  EXPECT_EQ(plc.raw("07FF000A0200442000000064442000000065"), "8700");
  EXPECT_EQ(plc.raw("06FF000A01004D2000000007"), "8600");
  EXPECT_EQ(plc.raw("09FF000A"), "890012340000");
  EXPECT_EQ(plc.raw("08FF000A"), "880010");
  EXPECT_EQ(plc.raw("09ff000a16FF000A02abcd"),
            "8900123400009600"
            "02abcd")
      << "small letters of a loopback behind it stay small";
}

TEST(Melsec1eMonitor, WhatIsRefused_LeavesTheListAsItWas) {
  Plc1e plc;
  EXPECT_EQ(plc.request("09 ff 0a 00"), "89 57") << "nothing is registered";
  EXPECT_EQ(plc.request("08 ff 0a 00"), "88 57");
  EXPECT_EQ(plc.request("07 ff 0a 00 | 01 00 | 64 00 00 00 20 44"), "87 00");
  EXPECT_EQ(plc.request("08 ff 0a 00"), "88 57") << "bits and words have a list each";
  EXPECT_EQ(plc.request("07 ff 0a 00 | 01 00 | ff ff 00 00 20 44"), "87 58");
  EXPECT_EQ(plc.request("07 ff 0a 00 | 01 00 | 00 00 00 00 20 51"), "87 56");
  EXPECT_EQ(plc.request("07 ff 0a 00 | 01 00 | 01 00 00 00 20 4d"), "87 58")
      << "words of M from a multiple of 16 on";
  EXPECT_EQ(plc.request("06 ff 0a 00 | 01 00 | 64 00 00 00 20 44"), "86 58") << "D has no bits";
  std::string points;
  for (int i = 0; i < 21; ++i) points += "64 00 00 00 20 44 ";
  EXPECT_EQ(plc.request("07 ff 0a 00 | 15 00 | " + points), "87 57");
  EXPECT_EQ(plc.request("09 ff 0a 00"), "89 00 00 00");
}

TEST(Melsec1eMonitor, OfAnFx3_IsUnknown) {
  Plc1e plc(fx3u());
  EXPECT_EQ(plc.request("07 ff 0a 00 | 01 00 | 64 00 00 00 20 44"), "87 50");
  EXPECT_EQ(plc.request("09 ff 0a 00"), "89 50");
}

// --- 32-bit counters of an FX3 ---

TEST(Melsec1eFx3, ValuesOfC200AndFurther_AreFourBytesAPoint) {
  Plc1e plc(fx3u());
  EXPECT_EQ(plc.request("03 ff 0a 00 | c8 00 00 00 4e 43 | 02 00 | 78 56 34 12 ff ff ff ff"), "83 00");
  EXPECT_EQ(plc.request("01 ff 0a 00 | c8 00 00 00 4e 43 | 02 00"), "81 00 78 56 34 12 ff ff ff ff");
  EXPECT_EQ(plc.word(Device::cn, 200), 0x5678) << "where there is room for one word, the low one";
  EXPECT_EQ(plc.request("01 ff 0a 00 | ff 00 00 00 4e 43 | 01 00"), "81 00 00 00 00 00") << "C255";
  EXPECT_EQ(plc.request("01 ff 0a 00 | c7 00 00 00 4e 43 | 01 00"), "81 00 00 00") << "C199 has 16 bits";
  Plc1e ascii(fx3u());
  EXPECT_EQ(ascii.raw("03FF000A434E000000C8010012345678"), "8300");
  EXPECT_EQ(ascii.raw("01FF000A434E000000C80100"), "810012345678");
}

TEST(Melsec1eFx3, ValuesOfTwoSizes_AreNotInOneRequest) {
  Plc1e plc(fx3u());
  EXPECT_EQ(plc.request("01 ff 0a 00 | c7 00 00 00 4e 43 | 02 00"), "81 57");
  EXPECT_EQ(plc.request("03 ff 0a 00 | c7 00 00 00 4e 43 | 02 00 | 01 00 02 00"), "83 57");
  EXPECT_EQ(plc.request("01 ff 0a 00 | c8 00 00 00 4e 43 | 39 00"), "81 57") << "C256 is not there";
  EXPECT_EQ(plc.request("05 ff 0a 00 | 01 00 | c8 00 00 00 4e 43 01 00"), "85 56")
      << "two bytes cannot hold it";
  EXPECT_EQ(plc.request("00 ff 0a 00 | c7 00 00 00 53 43 | 02 00"), "80 00 00")
      << "contacts are bits all the same";
  EXPECT_EQ(Plc1e{}.request("01 ff 0a 00 | c7 00 00 00 4e 43 | 02 00"), "81 00 00 00 00 00")
      << "16 bits in a Q CPU";
}

RC_GTEST_PROP(Melsec1e, AnyBytes_LeaveASessionThatAnswersOrIsOver,
              (const std::string& stream, bool any_frame)) {
  Plc plc(r04cpu(), {.takes_3e = any_frame, .takes_1e = true});
  (void)plc.raw(stream);
  RC_ASSERT(plc.session->over() || !plc.session->space().empty());
  (void)plc.datagram(stream);
}

}  // namespace
}  // namespace canopus::plc::melsec_1e_refusals_test
