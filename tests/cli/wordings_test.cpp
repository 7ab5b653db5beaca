// What newcomers stumbled over, as one table: a command line, and the whole message for it. Mistakes of plant files have theirs in
// plant/plant_mistakes_test.cpp.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/app/command_line.hpp"

namespace canopus::cli::wordings_test {
namespace {

struct Wording {
  std::vector<std::string> words;  // of the command line
  std::string message;             // what the standard error begins with
};

const std::string first_plant = CANOPUS_SOURCE_DIR "/examples/first-plant/plant.toml";
const std::string network = CANOPUS_SOURCE_DIR "/examples/network-without-plc/network.toml";
const std::string drive = CANOPUS_SOURCE_DIR "/examples/devices/drive.eds";

const std::vector<Wording> wordings{
    // A word too many, or missing.
    {{"scan", "network.toml"},
     "canopus scan: unexpected argument \"network.toml\"\n`canopus scan --help` says more.\n"},
    {{"master"}, "canopus master: FILE is required\n`canopus master --help` says more.\n"},
    {{"plc", "read"}, "canopus plc read: ADDRESS is required\n"},
    // A file of another kind.
    {{"run", drive},
     "canopus run: " + drive + " is a device file; `canopus eds show " + drive +
         "` shows it, `canopus new FOLDER --device " + drive + "` writes a plant with it\n"},
    {{"check", network},
     "canopus check: " + network + " is a network file for a master without a PLC; `canopus master " +
         network + "` boots it\n"},
    {{"web", network},
     "canopus web: " + network + " is a network file for a master without a PLC; `canopus master " + network +
         "` boots it\n"},
    // Options.
    {{"run", first_plant, "--virtual", "--web"}, "canopus run: --virtual cannot be combined with --web\n"},
    {{"sdo", "write", "5", "6040", "1", "--bus", "socketcan:none"},
     "canopus: type missing: use --type u16 (or another of bool, u8, u16, "},
    {{"sdo", "write", "5", "6040", "1", "--type", "u61", "--bus", "socketcan:none"},
     "canopus: --type: \"u61\" is not a type; did you mean \"u16\"?\n"},
    {{"lss", "set-rate", "300k", "--bus", "socketcan:none"},
     "canopus: \"300k\" is not a bit rate of LSS; expected 1M, 800k, 500k, 250k, 125k, 50k, 20k or 10k\n"},
    {{"project", "set", "none", "--bit-rate", "300k"},
     "canopus project: --bit-rate 300k: expected 10k, 20k, 50k, 100k, 125k, 250k, 500k, 800k or 1M\n"},
    // Names.
    {{"sdo", "read", "servo", "6041", "--network", network},
     "canopus: there is no node \"servo\"; expected master, io-block, encoder, drive or second drive\n"},
    {{"sdo", "read", "drvie", "6041", "--network", network},
     "canopus: there is no node \"drvie\"; did you mean \"drive\"?\n"},
    {{"plc", "read", "drvie.6041", "--plant", first_plant},
     "canopus plc: there is no node \"drvie\"; did you mean \"drive\"?\n"},
    {{"plc", "write", "encoder.6004", "1", "--plant", first_plant},
     "canopus plc: encoder.6004:00 Position value comes from the node, in its TPDO1: the PLC cannot write "
     "it\n"},
    {{"configure", "sdo-read", "300", "1018:02"},
     "canopus configure: \"300\" is not a node; expected a node-ID 1 to 127, or a name\n"},
};

TEST(Wordings, EachMistake_HasItsMessage) {
  for (const Wording& wording : wordings) {
    std::string line;
    for (const std::string& word : wording.words) line += " " + word;
    SCOPED_TRACE("canopus" + line);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = run_command_line(wording.words);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::StartsWith(wording.message));
    EXPECT_EQ(code, 2);
  }
}

}  // namespace
}  // namespace canopus::cli::wordings_test
