// What the program says to somebody who mistyped something.

#include "canopus/cli/app/command_line.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::cli::command_line_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Said {
  int code;
  std::string out, error;
};

Said said(std::vector<std::string> words) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(words);
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

std::string complaint(std::vector<std::string> words) {
  const Said all = said(std::move(words));
  EXPECT_EQ(all.code, 2);
  EXPECT_EQ(all.out, "");
  return all.error;
}

TEST(CommandLine, AMisspeltCommandIsNamedWithTheNearest) {
  EXPECT_EQ(complaint({"rnu", "plant.toml"}),
            "canopus: unknown command \"rnu\"; did you mean \"run\"?\n`canopus --help` says more.\n");
  EXPECT_THAT(complaint({"plc", "raed", "D0"}),
              StartsWith("canopus plc: unknown command \"raed\"; did you mean \"read\"?\n"));
  EXPECT_THAT(complaint({"nmt", "strat", "5"}), HasSubstr("did you mean \"start\"?"));
  EXPECT_THAT(complaint({"lss", "scna"}), HasSubstr("did you mean \"scan\"?"));
  EXPECT_THAT(complaint({"eds", "chekc", "x.eds"}), HasSubstr("did you mean \"check\"?"));
}

TEST(CommandLine, ACommandThatIsNearNothingGetsTheListOfAll) {
  EXPECT_THAT(
      complaint({"plc", "frobnicate"}),
      StartsWith("canopus plc: unknown command \"frobnicate\"; expected read, write, set, reset, watch, "
                 "dump, load, names, run, stop, pause, reset-cpu or type\n"));
  EXPECT_THAT(
      complaint({"nmt"}),
      StartsWith("canopus nmt: a command is missing; expected start, stop, preop, reset or reset-comm\n"));
}

TEST(CommandLine, AMisspeltOptionIsNamedWithTheNearest) {
  EXPECT_THAT(complaint({"run", "--vrtual", "plant.toml"}),
              StartsWith("canopus run: unknown option \"--vrtual\"; did you mean \"--virtual\"?\n"));
  EXPECT_THAT(complaint({"run", "--vrtual"}), HasSubstr("\"--virtual\"?")) << "before the missing PLANT";
  EXPECT_THAT(complaint({"run", "plant.toml", "--tracee=x.pcap"}),
              StartsWith("canopus run: unknown option \"--tracee\"; did you mean \"--trace\"?\n"));
  EXPECT_THAT(complaint({"scan", "-json"}), HasSubstr("did you mean \"--json\"?"));
  EXPECT_THAT(complaint({"check", "--frobnicate", "plant.toml"}),
              StartsWith("canopus check: unknown option \"--frobnicate\"\n"));
  EXPECT_THAT(complaint({"--verison"}), HasSubstr("did you mean \"--version\"?"));
}

TEST(CommandLine, AnOptionBeforeItsCommandIsToldItsPlace) {
  EXPECT_THAT(complaint({"--json", "run", "plant.toml"}),
              StartsWith("canopus run: --json comes behind the command: canopus run --json\n"));
}

TEST(CommandLine, AWordTooManyIsNamed) {
  EXPECT_THAT(complaint({"run", "plant.toml", "extra"}),
              StartsWith("canopus run: \"extra\" is one word too many\n"));
}

TEST(CommandLine, AMissingWordIsNamed) {
  EXPECT_THAT(complaint({"run"}), StartsWith("canopus run: PLANT is required\n"));
  EXPECT_THAT(complaint({"plc", "read"}), StartsWith("canopus plc read: ADDRESS is required\n"));
}

TEST(CommandLine, AMisspeltValueIsNamedWithTheNearest) {
  EXPECT_THAT(complaint({"plc", "read", "D0", "--format", "hxe"}),
              StartsWith("canopus plc read: --format: \"hxe\" is unknown; did you mean \"hex\"?\n"));
  EXPECT_THAT(complaint({"plc", "read", "D0", "--format", "octal"}),
              HasSubstr("\"octal\" is unknown; expected dec, hex or both\n"));
  EXPECT_THAT(complaint({"lss", "switch", "waitng"}), HasSubstr("did you mean \"waiting\"?"));
  EXPECT_THAT(complaint({"sdo", "read", "5", "1000", "--type", "f33"}),
              HasSubstr("--type: \"f33\" is not a type; did you mean \"f32\"?"));
  EXPECT_THAT(complaint({"module", "info", "me3can1"}),
              HasSubstr("me3can1: no such module; did you mean \"ME3CAN1-Q\"?"));
}

TEST(CommandLine, ANumberOutOfItsRangeIsToldTheRange) {
  EXPECT_THAT(complaint({"plc", "read", "D0", "--port", "99999"}),
              StartsWith("canopus plc read: --port: \"99999\" is not a number from 1 to 65535\n"));
  EXPECT_THAT(complaint({"plc", "read", "D0", "--count", "0"}), HasSubstr("a number from 1 to 65536"));
  EXPECT_THAT(complaint({"run", "plant.toml", "--seed", "abc"}),
              HasSubstr("--seed: \"abc\" is not a number from 0 to 18446744073709551615"));
}

TEST(CommandLine, WhatCannotBePrintedIsEscaped) {
  EXPECT_THAT(complaint({"\x1b[2Jrun"}), Not(HasSubstr("\x1b")));
}

TEST(CommandLine, HelpIsWhereAUserLooks) {
  const Said all = said({"--help"});
  EXPECT_EQ(all.code, 0);
  EXPECT_THAT(all.out, HasSubstr("Usage: canopus"));
  EXPECT_EQ(said({"help"}).out, all.out);
  EXPECT_EQ(said({"help", "plc", "read"}).out, said({"plc", "read", "--help"}).out);
  EXPECT_EQ(complaint({}), all.out) << "the commands there are, as an error";
}

}  // namespace
}  // namespace canopus::cli::command_line_test
