// `canopus plc` against the server in a thread of its own, and how addresses and values are written.

#include <string>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/options/parser.hpp"
#include "canopus/client/plc_point.hpp"
#include "canopus/serve/melsec_server.hpp"

#include "plc/conversation.hpp"

namespace canopus::cli::plc_command_test {
namespace {

using ::testing::HasSubstr;
using ::testing::internal::CaptureStderr;
using ::testing::internal::CaptureStdout;
using ::testing::internal::GetCapturedStderr;
using ::testing::internal::GetCapturedStdout;

class StandingClock final : public link::LoopClock {
 public:
  can::Time now() override { return can::Time(std::chrono::seconds(10)); }
  void touched() override {}
};

class PlcCommandTest : public ::testing::Test {
 protected:
  PlcCommandTest() : server_(context_, plc_.rack, clock_) {
    plc_.module.words[25] = 0x0280;
    EXPECT_TRUE(server_.listen("127.0.0.1", 0));
    port_ = std::to_string(server_.port());
    thread_ = std::thread([this] { context_.run(); });
  }
  ~PlcCommandTest() override {
    boost::asio::post(context_, [this] { server_.stop(); });
    thread_.join();
  }

  struct Outcome {
    int exit_code = -1;
    std::string out;
    std::string err;
  };
  Outcome run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "plc");
    arguments.insert(arguments.end(), {"--plc", port_});
    Command app;
    Outcome outcome;
    add_plc_command(app, outcome.exit_code);
    CaptureStdout();
    CaptureStderr();
    if (parse_words(app, arguments).result != Parsing::Result::ran) outcome.exit_code = 100;
    outcome.out = GetCapturedStdout();
    outcome.err = GetCapturedStderr();
    return outcome;
  }

  StandingClock clock_;
  plc::testing::Plc plc_;
  boost::asio::io_context context_;
  serve::MelsecServer server_;
  std::string port_;
  std::thread thread_;
};

TEST_F(PlcCommandTest, Read_ShowsDecimalAndHexadecimal) {
  const Outcome outcome = run({"read", "U0\\G25"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, "U0\\G25     640  0280H\n");
}

TEST_F(PlcCommandTest, WriteAndRead_InEveryFrameAndCode) {
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{}, {"--4e"}, {"--ascii"}, {"--4e", "--ascii"}}) {
    std::vector<std::string> write = {"write", "D100", "1234", "-5", "0x4D2", "0FFFFH"};
    write.insert(write.end(), options.begin(), options.end());
    EXPECT_EQ(run(write).exit_code, 0);
    std::vector<std::string> read = {"read", "D100", "--count", "4", "--format", "dec", "--signed"};
    read.insert(read.end(), options.begin(), options.end());
    EXPECT_EQ(run(read).out, "D100  1234\nD101  -5\nD102  1234\nD103  -1\n");
    EXPECT_EQ(run({"write", "D100", "0", "0", "0", "0"}).exit_code, 0);
  }
}

TEST_F(PlcCommandTest, Write_ReachesBufferMemoryInAscii) {
  EXPECT_EQ(run({"write", "U0\\G13000", "1234", "--ascii"}).exit_code, 0);
  EXPECT_EQ(run({"read", "U0\\G13000", "--format", "hex"}).out, "U0\\G13000  04D2H\n");
}

TEST_F(PlcCommandTest, SetAndReset_TurnABitOnAndOff) {
  EXPECT_EQ(run({"set", "Y1F"}).exit_code, 0);
  EXPECT_EQ(run({"read", "Y1E", "--count", "2"}).out, "Y1E  OFF\nY1F  ON\n");
  EXPECT_EQ(run({"reset", "Y1F", "--ascii"}).exit_code, 0);
  EXPECT_EQ(run({"read", "Y1F"}).out, "Y1F  OFF\n");
}

TEST_F(PlcCommandTest, Read_OfMoreThanOneRequestHolds_IsWhole) {
  EXPECT_EQ(run({"write", "D1999", "7"}).exit_code, 0);
  const Outcome outcome = run({"read", "D0", "--count", "2000", "--format", "dec"});
  EXPECT_THAT(outcome.out, HasSubstr("D1998  0\nD1999  7\n"));
}

TEST_F(PlcCommandTest, EndCode_IsShownWithItsMeaning) {
  const Outcome outcome = run({"read", "D99999"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err, "canopus plc: the PLC answers 4031H: device number beyond the CPU's last one\n");
}

TEST_F(PlcCommandTest, NobodyThere_IsSaidWithTheAddress) {
  port_ = "1";
  const Outcome outcome = run({"read", "D0"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(
      outcome.err,
      "canopus plc: 127.0.0.1:1: Connection refused. Is `canopus run` running, without --virtual? Its plant "
      "file "
      "says where the PLC listens: listen = \"127.0.0.1:5007\". A real CPU needs an open setting for the MC "
      "protocol, TCP\n");
}

TEST_F(PlcCommandTest, WriteToAnInput_IsSaid) {
  Outcome outcome = run({"set", "X3"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err,
            "canopus plc: X3 was written with ON and shows OFF: an input shows what its module says\n");
  outcome = run({"write", "X2", "OFF", "ON"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("X3 was written with ON"));
  EXPECT_EQ(run({"set", "X3", "--no-verify"}).exit_code, 0);
  EXPECT_EQ(run({"set", "X100"}).exit_code, 0) << "without a module it is memory";
}

TEST_F(PlcCommandTest, WriteToAWordThatCannotBeWritten_IsSaid) {
  plc_.module.read_only = {25};
  const Outcome outcome = run({"write", "U0\\G24", "7", "5"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(
      outcome.err,
      "canopus plc: U0\\G25 was written with 5 (0005H) and shows 640 (0280H): the module does not let it be "
      "written, or changes it as well\n");
  EXPECT_EQ(run({"write", "U0\\G25", "5", "--no-verify"}).exit_code, 0);
  EXPECT_EQ(run({"write", "U0\\G25", "640"}).exit_code, 0) << "it is what was wanted";
}

TEST_F(PlcCommandTest, WriteToWhatTheCpuWritesItself_IsSaid) {
  const Outcome outcome = run({"reset", "SM400", "--ascii"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err,
              HasSubstr("SM400 was written with OFF and shows ON: the PLC does not let it be written"));
}

TEST_F(PlcCommandTest, WhatMakesNoSense_IsUsageWithoutConnecting) {
  port_ = "1";
  EXPECT_EQ(run({"read", "Q5"}).exit_code, 2);
  EXPECT_EQ(run({"write", "D0", "70000"}).exit_code, 2);
  EXPECT_EQ(run({"write", "M0", "5"}).exit_code, 2);
  EXPECT_EQ(run({"set", "D0"}).exit_code, 2);
  EXPECT_EQ(run({"watch", "D0", "--interval", "5"}).exit_code, 2);
  EXPECT_EQ(run({"read", "D0", "--timeout", "0s"}).exit_code, 2);
}

TEST_F(PlcCommandTest, Watch_ShowsTheFirstValues) {
  const Outcome outcome = run({"watch", "U0\\G25", "--interval", "5ms", "--for", "20ms", "--format", "hex"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr(" s  U0\\G25  0280H\n"));
  EXPECT_EQ(std::ranges::count(outcome.out, '\n'), 1);
}

TEST_F(PlcCommandTest, StopAndRun_ChangeTheCpu) {
  EXPECT_EQ(run({"stop"}).exit_code, 0);
  EXPECT_EQ(run({"read", "SM203"}).out, "SM203  ON\n");
  EXPECT_EQ(run({"run"}).exit_code, 0);
  EXPECT_EQ(run({"read", "SM203"}).out, "SM203  OFF\n");
}

TEST_F(PlcCommandTest, Pause_KeepsTheOutputsUntilRun) {
  EXPECT_EQ(run({"set", "Y1F"}).exit_code, 0);
  EXPECT_EQ(run({"pause"}).exit_code, 0);
  EXPECT_EQ(run({"read", "SM203", "--count", "2"}).out, "SM203  OFF\nSM204  ON\n");
  EXPECT_EQ(run({"read", "SD203", "--format", "hex"}).out, "SD203  0023H\n");
  EXPECT_EQ(run({"read", "Y1F"}).out, "Y1F  ON\n");
  EXPECT_EQ(run({"run"}).exit_code, 0);
  EXPECT_EQ(run({"read", "SM204"}).out, "SM204  OFF\n");
}

TEST_F(PlcCommandTest, PauseInStop_IsSaidToHaveNoEffect) {
  EXPECT_EQ(run({"stop"}).exit_code, 0);
  const Outcome outcome = run({"pause"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err,
            "canopus plc: the CPU is in STOP and stays there: PAUSE is reached from RUN alone\n");
}

TEST_F(PlcCommandTest, DevicesOfTheIqrSeries_AreReadAndWritten) {
  EXPECT_EQ(run({"write", "RD524286", "1", "2"}).exit_code, 0);
  EXPECT_EQ(plc_.word(plc::Device::rd, 524287), 2);
  EXPECT_EQ(run({"write", "u3e0/hg10", "3", "4"}).exit_code, 0);
  EXPECT_EQ(plc_.word(plc::Device::hg, 11), 4);
  EXPECT_THAT(run({"read", "U3E0\\HG11", "--ascii"}).out, HasSubstr("U3E0\\HG11"));
  EXPECT_THAT(run({"read", "U3E0\\HG11", "--ascii"}).out, HasSubstr("0004H"));
  EXPECT_THAT(run({"read", "U3E0\\HG12288"}).err, HasSubstr("4031H"));
}

TEST_F(PlcCommandTest, Type_ShowsNameAndCode) { EXPECT_EQ(run({"type"}).out, "R04CPU  4800H\n"); }

TEST(PlcAddress, Devices_HaveTheirOwnBase) {
  EXPECT_EQ(client::parse_plc_address("x1f")->number, 0x1FU);
  EXPECT_EQ(client::parse_plc_address("B10")->device, plc::Device::b);
  EXPECT_EQ(client::parse_plc_address("B10")->number, 0x10U);
  EXPECT_EQ(client::parse_plc_address("D10")->number, 10U);
  EXPECT_EQ(client::parse_plc_address("SB1A")->device, plc::Device::sb);
  EXPECT_EQ(client::parse_plc_address("ZR7")->device, plc::Device::zr);
  EXPECT_EQ(client::parse_plc_address("RD524287")->device, plc::Device::rd);
  EXPECT_EQ(client::parse_plc_address("RD524287")->number, 524287U);
  EXPECT_EQ(client::parse_plc_address("rd7")->device, plc::Device::rd);
  EXPECT_EQ(client::parse_plc_address("U3E0\\HG12")->device, plc::Device::hg);
  EXPECT_EQ(client::parse_plc_address("U3E0\\HG12")->number, 12U);
  EXPECT_FALSE(client::parse_plc_address("U3E0\\HG12")->is_buffer);
  EXPECT_EQ(client::parse_plc_address("U3/G256")->head_address, 0x30);
  EXPECT_EQ(client::parse_plc_address("UFF\\G0")->head_address, 0xFF0);
}

TEST(PlcAddress, WhatIsNone_SaysWhatWasExpected) {
  EXPECT_THAT(client::parse_plc_address("U0G25").error(), HasSubstr("lacks the backslash"));
  EXPECT_THAT(client::parse_plc_address("D1F").error(), HasSubstr("'D1F' has no decimal number"));
  EXPECT_THAT(client::parse_plc_address("XG").error(), HasSubstr("has no hexadecimal number"));
  EXPECT_THAT(client::parse_plc_address("U100\\G0").error(), HasSubstr("unit number 0 to FF"));
  EXPECT_THAT(client::parse_plc_address("U3E0\\G0").error(), HasSubstr("unit number 0 to FF"));
  EXPECT_THAT(client::parse_plc_address("U3E1\\HG0").error(), HasSubstr("(U3E0\\HG0)"));
  EXPECT_THAT(client::parse_plc_address("U0\\HG0").error(), HasSubstr("(U3E0\\HG0)"));
  EXPECT_THAT(client::parse_plc_address("U3E0\\HG").error(), HasSubstr("behind the HG"));
  EXPECT_THAT(client::parse_plc_address("HG0").error(), HasSubstr("is no device"));
  EXPECT_FALSE(client::parse_plc_address(""));
  EXPECT_FALSE(client::parse_plc_address("D"));
  EXPECT_FALSE(client::parse_plc_address("D-1"));
  EXPECT_FALSE(client::parse_plc_address("U0\\G-1"));
}

TEST(PlcAddress, IsWrittenAsItIsRead) {
  EXPECT_EQ(client::plc_address(*client::parse_plc_address("u0\\g25"), 1), "U0\\G26");
  EXPECT_EQ(client::plc_address(*client::parse_plc_address("u3e0/hg9"), 1), "U3E0\\HG10");
  EXPECT_EQ(client::plc_address(*client::parse_plc_address("X1F"), 1), "X20");
  EXPECT_EQ(client::plc_address(*client::parse_plc_address("D9"), 1), "D10");
}

TEST(PlcWord, InEveryWriting) {
  EXPECT_EQ(client::parse_plc_word("65535"), 0xFFFF);
  EXPECT_EQ(client::parse_plc_word("-32768"), 0x8000);
  EXPECT_EQ(client::parse_plc_word("0xff"), 0xFF);
  EXPECT_EQ(client::parse_plc_word("0ffh"), 0xFF);
  EXPECT_EQ(client::parse_plc_word("H10"), 0x10);
  EXPECT_EQ(client::parse_plc_word("K10"), 10);
  for (const char* text : {"", "65536", "-32769", "1F", "0x10000", "0x-1", "h", "1.5"})
    EXPECT_FALSE(client::parse_plc_word(text)) << text;
}

}  // namespace
}  // namespace canopus::cli::plc_command_test
