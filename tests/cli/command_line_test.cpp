// What the program says to somebody who mistyped something.

#include "canopus/cli/app/command_line.hpp"

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/options/command.hpp"

namespace canopus::cli::command_line_test {
namespace {

using testing::HasSubstr;
using testing::Not;
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
                 "dump, load, names, signals, run, stop, pause, reset-cpu, type, program, force, unforce, "
                 "halt, scan, "
                 "continue, "
                 "break, clear-break or change\n"));
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
              StartsWith("canopus run: unexpected argument \"extra\"\n"));
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
  EXPECT_THAT(complaint({"plc", "read", "D0", "--plc", "99999"}),
              StartsWith("canopus plc read: --plc: \"99999\" has no port from 1 to 65535; expected for "
                         "example 192.168.3.39, 192.168.3.39:5007 or 5007\n"));
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

/// Every option that was renamed, as it was written before, with what stands for it now.
TEST(CommandLine, OldSpellings_AreUnderstoodWithAHint) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"master", "--dcf", "none.toml"},
       "canopus master: --dcf is an old spelling, which the next release does not "
       "know; expected \"none.toml\"\n"},
      {{"monitor", "socketcan:"}, "expected \"--bus=socketcan:\""},
      {{"monitor", "--id", "zz", "--bus", "socketcan:none"}, "expected \"--can-id=zz\""},
      {{"monitor", "--only-node", "x", "--write", "none/a.log", "--bus", "socketcan:none"},
       "expected \"--trace=none/a.log\""},
      {{"trace", "show", "none.log", "--only-node", "0"}, "expected \"--node=0\""},
      {{"trace", "show", "none.log", "--node", "3=none.eds"}, "expected \"--eds=3=none.eds\""},
      {{"trace", "plot", "none.log", "--out", "none.log"}, "expected \"--output=none.log\""},
      {{"trace", "info", "none.log", "--from", "csv"}, "expected \"--in-format=csv\""},
      {{"trace", "convert", "none.log", "none.csv", "--from", "candump"}, "expected \"--in-format=candump\""},
      {{"trace", "convert", "none.log", "none.csv", "--to", "csv"}, "expected \"--out-format=csv\""},
      {{"trace", "convert", "none.log", "none.csv", "--start", "1s"}, "expected \"--from=1s\""},
      {{"trace", "convert", "none.log", "none.csv", "--end", "1s"}, "expected \"--to=1s\""},
      {{"replay", "none.log", "--id", "5-1"}, "expected \"--can-id=5-1\""},
      {{"eds", "convert", "none.eds", "-", "--to", "xdd"}, "expected \"--out-format=xdd\""},
      {{"gateway", "--node", "128"}, "expected \"--node-id=128\""},
      {{"run", "none.toml", "--link", "sim"}, "expected \"--bus=sim\""},
      {{"plc", "read", "?", "--host", "10.0.0.1"}, "expected \"--plc=10.0.0.1\""},
      {{"plc", "read", "?", "--port", "5010"}, "expected \"--plc=:5010\""},
      {{"configure", "describe", "--model", "x"}, "expected \"--module=x\""},
      {{"configure", "identify", "none.xml", "300", "--from", "master"}, "expected \"--source=master\""},
  };
  for (const auto& [words, hint] : cases) {
    const Said all = said(words);
    EXPECT_NE(all.code, 0) << words.front();  // 1: such a bus is not there
    EXPECT_THAT(all.error, HasSubstr(hint));
  }
}

/// Each option and argument of a command and of those in it: its command's name, and itself.
void collect(Command& command, std::vector<std::pair<std::string, const Option*>>& all) {
  for (const Option& option : command.all_options()) all.emplace_back(command.full_name(), &option);
  for (Command& inner : command.commands()) collect(inner, all);
}

TEST(CommandLine, ANode_IsNamedByNumberOrName) {
  Command app("Does things", "canopus");
  int code = 0;
  add_commands(app, code);
  app.build_all();
  std::vector<std::pair<std::string, const Option*>> all;
  collect(app, all);
  std::size_t nodes = 0;
  for (const auto& [command, option] : all) {
    const std::string& name = option->names().back();
    SCOPED_TRACE(command + " " + name);
    if (option->value() == "1-127") {
      EXPECT_THAT(name, testing::AnyOf("--node-id", "--assign"));
    }
    if (name != "--node" && name != "NODE") continue;
    ++nodes;
    EXPECT_EQ(option->is_argument() ? name : option->value(), "NODE");
    EXPECT_FALSE(std::holds_alternative<unsigned*>(option->data().target));
    EXPECT_FALSE(std::holds_alternative<int*>(option->data().target));
    EXPECT_THAT(option->data().choices, testing::IsEmpty());
    for (const OptionCheck& check : option->data().checks) {
      EXPECT_EQ(check("drive"), "");
      EXPECT_EQ(check("5"), "");
    }
  }
  EXPECT_GE(nodes, 20U);
}

TEST(CommandLine, AFileOfAnotherKind_NamesTheCommandForIt) {
  const std::string examples = CANOPUS_SOURCE_DIR "/examples/";
  const std::string eds = examples + "devices/drive.eds";
  const std::string plant = examples + "first-plant/plant.toml";
  const std::string network = examples + "network-without-plc/network.toml";
  EXPECT_THAT(complaint({"run", eds}),
              HasSubstr("drive.eds is a device file; `canopus eds show " + eds + "`"));
  EXPECT_THAT(complaint({"run", network}), HasSubstr("`canopus master " + network + "` boots it"));
  EXPECT_THAT(complaint({"run", "nodelist.cpj"}),
              HasSubstr("`canopus web nodelist.cpj` simulates its nodes"));
  EXPECT_THAT(complaint({"run", "a.pcap"}), HasSubstr("`canopus trace show a.pcap` shows it"));
  EXPECT_THAT(complaint({"run", examples + "devices"}),
              HasSubstr("is a folder with neither a plant.toml nor"));
  EXPECT_THAT(complaint({"web", eds}), HasSubstr("drive.eds is a device file"));
  EXPECT_THAT(complaint({"master", plant}), HasSubstr("`canopus run " + plant + "` runs it"));
  EXPECT_THAT(complaint({"check", network}), HasSubstr("`canopus master " + network + "` boots it"));
  EXPECT_THAT(complaint({"eds", "check", plant}), HasSubstr("`canopus check " + plant + "` checks it"));
}

TEST(CommandLine, CheckOfADeviceFile_IsThatOfEdsCheck) {
  const std::string eds = CANOPUS_SOURCE_DIR "/examples/devices/drive.eds";
  const Said check = said({"check", eds});
  EXPECT_EQ(check.code, 0) << check.error;
  EXPECT_EQ(check.out, said({"eds", "check", eds}).out);
  EXPECT_THAT(check.out, HasSubstr("accepted"));
}

TEST(CommandLine, AFolderWithAPlant_IsThePlant) {
  const std::string folder = CANOPUS_SOURCE_DIR "/examples/first-plant";
  EXPECT_EQ(said({"check", folder}).code, 0);
  EXPECT_EQ(said({"run", folder, "--virtual", "--for", "10ms", "--quiet"}).code, 0);
}

/// The notations of --plc: an address, a port of this machine, or both.
TEST(CommandLine, ThePlaceOfAPlc_HasAnAddressOrAPort) {
  const auto refusal = [](const std::string& place) {
    return complaint({"plc", "read", "D0", "--plc", place});
  };
  for (const char* place : {"", "0", "65536", "a:", "a:b", "[::1", "[::1]x", "[::1]:"})
    EXPECT_THAT(refusal(place), HasSubstr("expected for example 192.168.3.39, 192.168.3.39:5007 or 5007"))
        << place;
  for (const char* place : {"10.0.0.1", "10.0.0.1:1", "1", ":1", "::1", "[::1]", "[::1]:1"})
    EXPECT_THAT(complaint({"plc", "read", "?", "--plc", place}), Not(HasSubstr("--plc"))) << place;
}

}  // namespace
}  // namespace canopus::cli::command_line_test
