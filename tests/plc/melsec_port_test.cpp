// What a port is set to: remote password, who may write, data code, datagrams in 3E and 4E.

#include <string>

#include <gtest/gtest.h>

#include "plc/conversation.hpp"

namespace canopus::plc::melsec_port_test {
namespace {

using testing::bytes;
using testing::Plc;
using testing::shown;

const std::string read_d100 = "50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00";
const std::string d100 = "d0 00 00 ff ff 03 00 04 00 00 00 34 12";
const std::string done = "d0 00 00 ff ff 03 00 02 00 00 00";

struct PlcWithPassword : Plc {
  explicit PlcWithPassword(const CpuModel& model = r04cpu(), std::string password = "secret")
      : Plc(model, {.remote_password = std::move(password)}) {
    word(Device::d, 100, 0x1234);
  }
  std::string unlock(const std::string& password, std::uint8_t command = 0x30) {
    std::string request = bytes("50 00 00 ff ff 03 00 00 00 10 00 00 16 00 00 00 00") + password;
    request[7] = static_cast<char>(8 + password.size());
    request[11] = static_cast<char>(command);
    request[15] = static_cast<char>(password.size());
    return shown(raw(request));
  }
};
std::string refused(const std::string& end_code, const std::string& command) {
  return "d0 00 00 ff ff 03 00 0b 00 " + end_code + " 00 ff ff 03 00 " + command + " 00 00";
}

TEST(MelsecPort, WithAPassword_EverythingIsC201UntilItCame) {
  PlcWithPassword plc;
  EXPECT_EQ(plc.request(read_d100), refused("01 c2", "01 04"));
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 06 00 10 00 99 99 00 00"), refused("01 c2", "99 99"));
  EXPECT_EQ(plc.unlock("secret"), done);
  EXPECT_EQ(plc.request(read_d100), d100);
}

TEST(MelsecPort, AWrongPassword_IsC810_OfAQCpuC200) {
  PlcWithPassword plc;
  EXPECT_EQ(plc.unlock("Secret"), refused("10 c8", "30 16"));
  EXPECT_EQ(plc.unlock("secre"), refused("10 c8", "30 16"));
  EXPECT_EQ(plc.request(read_d100), refused("01 c2", "01 04"));
  PlcWithPassword q(q03udvcpu(), "ABCD");
  EXPECT_EQ(q.unlock("abcd"), refused("00 c2", "30 16"));
  EXPECT_EQ(q.unlock("ABCD"), done);
}

TEST(MelsecPort, AnUnlockedPort_DoesNotLookAtThePassword) {
  PlcWithPassword plc;
  EXPECT_EQ(plc.unlock("secret"), done);
  EXPECT_EQ(plc.unlock("anything"), done);
  EXPECT_EQ(plc.request(read_d100), d100);
  Plc without;
  EXPECT_EQ(without.request("50 00 00 ff ff 03 00 0c 00 10 00 30 16 00 00 04 00 41 42 43 44"), done);
  EXPECT_EQ(without.request("50 00 00 ff ff 03 00 0c 00 10 00 31 16 00 00 04 00 41 42 43 44"), done);
  EXPECT_EQ(without.request(read_d100), "d0 00 00 ff ff 03 00 04 00 00 00 00 00");
}

TEST(MelsecPort, Lock_LocksAgain) {
  PlcWithPassword plc;
  EXPECT_EQ(plc.unlock("secret"), done);
  EXPECT_EQ(plc.unlock("wrong!", 0x31), refused("10 c8", "31 16"));
  EXPECT_EQ(plc.request(read_d100), d100);
  EXPECT_EQ(plc.unlock("secret", 0x31), done);
  EXPECT_EQ(plc.request(read_d100), refused("01 c2", "01 04"));
  EXPECT_EQ(plc.unlock("anything", 0x31), done);  // it is locked already
}

TEST(MelsecPort, PasswordInAscii_IsTextBothWays) {
  PlcWithPassword plc;
  EXPECT_EQ(plc.raw("500000FF03FF0000160010163000000006secret"), "D00000FF03FF0000040000");
}

TEST(MelsecPort, PasswordThatIsShorterThanItsLength_IsC061) {
  PlcWithPassword plc;
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0c 00 10 00 30 16 00 00 06 00 41 42 43 44"),
            refused("61 c0", "30 16"));
}

TEST(MelsecPort, FiveWrongPasswords_LockEverybodyOutForAMinute) {
  PlcWithPassword plc;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(plc.unlock("guess!"), refused("10 c8", "30 16"));
  EXPECT_EQ(plc.unlock("secret"), refused("16 c8", "30 16"));
  // Another connection to the same port has no tries of its own.
  plc.session = std::make_unique<melsec::Session>(plc.rack, melsec::PortSettings{.remote_password = "secret"},
                                                  &plc.guard);
  EXPECT_EQ(plc.unlock("secret"), refused("16 c8", "30 16"));
  plc.now += std::chrono::seconds(61);
  EXPECT_EQ(plc.unlock("secret"), done);
}

TEST(MelsecPort, OnlineChange_WhereItIsNotEnabled_Is0055InRunOnly) {
  Plc plc(r04cpu(), {.write = WritePermission::in_stop});
  const std::string writes[] = {"50 00 00 ff ff 03 00 0e 00 10 00 01 14 00 00 64 00 00 a8 01 00 34 12",
                                "50 00 00 ff ff 03 00 0d 00 10 00 01 14 01 00 32 00 00 90 01 00 10",
                                "50 00 00 ff ff 03 00 0e 00 10 00 02 14 00 00 01 00 64 00 00 a8 34 12",
                                "50 00 00 ff ff 03 00 10 00 10 00 06 14 00 00 01 00 64 00 00 a8 01 00 34 12",
                                "50 00 00 ff ff 03 00 10 00 10 00 01 16 00 00 00 00 00 00 02 00 00 00 34 12",
                                "50 00 00 ff ff 03 00 0e 00 10 00 13 16 00 00 00 00 00 00 01 00 34 12"};
  for (const std::string& request : writes) EXPECT_EQ(plc.request(request).substr(27, 5), "55 00") << request;
  EXPECT_EQ(plc.word(Device::d, 100), 0);
  EXPECT_TRUE(plc.module.writes.empty());
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 08 00 10 00 02 10 00 00 01 00"), done);  // remote STOP
  for (const std::string& request : writes) EXPECT_EQ(plc.request(request), done) << request;
}

TEST(MelsecPort, ClientThatMayOnlyLook_DoesNotChangeTheCpuEither) {
  Plc plc(r04cpu(), {.write = WritePermission::never});
  plc.word(Device::d, 100, 0x1234);
  EXPECT_EQ(plc.request(read_d100), d100);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 08 00 10 00 02 10 00 00 01 00"), refused("8b 40", "02 10"));
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::run);
  EXPECT_EQ(plc.request("50 00 00 ff ff 03 00 0e 00 10 00 01 14 00 00 64 00 00 a8 01 00 00 00"),
            refused("55 00", "01 14"));
}

TEST(MelsecPort, DataCodeOfThePort_RefusesTheOther) {
  Plc plc(r04cpu(), {.code = melsec::DataCode::ascii});
  EXPECT_EQ(plc.request(read_d100), "");
  EXPECT_TRUE(plc.session->over());
}

TEST(MelsecPort, Datagram_IsOneRequest) {
  Plc plc;
  plc.word(Device::d, 100, 0x1234);
  const std::string request = bytes(read_d100);
  EXPECT_EQ(shown(plc.datagram(request)), d100);
  EXPECT_EQ(plc.datagram("500000FF03FF000018001004010000D*0001000001"), "D00000FF03FF00000800001234");
  EXPECT_EQ(shown(plc.datagram(
                bytes("54 00 07 00 00 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 01 00"))),
            "d4 00 07 00 00 00 00 ff ff 03 00 04 00 00 00 34 12");
  EXPECT_EQ(shown(plc.datagram(request)), d100);
}

TEST(MelsecPort, DatagramOfAnotherLengthThanItSays_IsC061_InAsciiC058) {
  Plc plc;
  const std::string request = bytes(read_d100);
  EXPECT_EQ(shown(plc.datagram(request + '\0')).substr(27, 5), "61 c0");
  EXPECT_EQ(shown(plc.datagram(request.substr(0, 20))).substr(27, 5), "61 c0");
  EXPECT_EQ(shown(plc.datagram(request + request)).substr(27, 5), "61 c0");
  EXPECT_EQ(plc.datagram("500000FF03FF000018001004010000D*000100000").substr(18, 4), "C058");
}

TEST(MelsecPort, DatagramWithoutAHeader_GetsNoAnswer) {
  Plc plc;
  for (const char* request :
       {"", "5", "50", "hello", "GET / HTTP/1.1\r\n\r\n", "500000FF03FF0x", "\x50", "\x01\xFF"})
    EXPECT_EQ(plc.datagram(request), "") << request;
  EXPECT_EQ(plc.datagram(bytes("50 00 00 ff ff 03 00 0c")), "");
}

TEST(MelsecPort, DatagramsRemember_WhatTheyRegistered) {
  PlcWithPassword plc;
  const auto datagram = [&](const std::string& request) { return shown(plc.datagram(bytes(request))); };
  EXPECT_EQ(datagram(read_d100).substr(27, 5), "01 c2");
  EXPECT_EQ(datagram("50 00 00 ff ff 03 00 0e 00 10 00 30 16 00 00 06 00 73 65 63 72 65 74"), done);
  EXPECT_EQ(datagram("50 00 00 ff ff 03 00 0c 00 10 00 01 08 00 00 01 00 64 00 00 a8"), done);
  EXPECT_EQ(datagram("50 00 00 ff ff 03 00 06 00 10 00 02 08 00 00"), d100);
}

TEST(MelsecRemoteReset, InStop_ClearsTheDevicesAndEndsTheConversation) {
  Plc plc(r04cpu(), {.remote_reset = true});
  const std::string reset = "50 00 00 ff ff 03 00 08 00 10 00 06 10 00 00 01 00";
  const auto refusal = [&](const std::string& code) {
    return "d0 00 00 ff ff 03 00 0b 00 " + code + " 00 ff ff 03 00 06 10 00 00";
  };
  plc.word(Device::d, 100, 7);
  EXPECT_EQ(plc.request(reset), refusal("13 40")) << "in RUN";
  plc.rack.pause(plc.now);
  EXPECT_EQ(plc.request(reset), refusal("13 40")) << "in PAUSE";
  plc.rack.set_cpu_state(module::CpuState::stop, plc.now);
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0022);
  EXPECT_EQ(plc.request(reset + " 50 00 00 ff ff 03 00 06 00 10 00 01 01 00 00"), "")
      << "nobody is left to answer";
  EXPECT_TRUE(plc.session->over());
  EXPECT_EQ(plc.word(Device::d, 100), 0);
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::run) << "where its switch is";
  EXPECT_EQ(Plc{}.request(reset), refusal("8b 40")) << "a new project does not allow it";
}

TEST(MelsecRemoteReset, WithTheSwitchAtStop_ComesUpInStop) {
  Plc plc(r04cpu(), {.remote_reset = true});
  plc.rack.power_off(plc.now);
  plc.rack.power_on(plc.now, module::CpuState::stop);
  EXPECT_EQ(plc.datagram(bytes("50 00 00 ff ff 03 00 08 00 10 00 06 10 00 00 01 00")), "");
  EXPECT_FALSE(plc.session->over()) << "a datagram has no connection to end";
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::stop);
  EXPECT_EQ(plc.word(Device::sd, 203), 0x0002);
}

}  // namespace
}  // namespace canopus::plc::melsec_port_test
