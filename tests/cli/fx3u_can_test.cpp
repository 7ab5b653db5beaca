// What `canopus` says of the FX3U-CAN, and its examples.

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/cli/app/command_line.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/module_command.hpp"

#include "paths.hpp"

namespace canopus::cli::fx3u_can_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

Json fx_sheet() {
  TextOutput out, err;
  EXPECT_EQ(module_info("fx3u-can", std::nullopt, true, out, err), 0) << err.text();
  return Json::parse(out.text());
}

TEST(Fx3uCanInfo, StandardsPlacesVersionsAndBusLengths) {
  RecordProperty(
      "spec",
      "FX3U-SPEC-003 FX3U-SPEC-004 FX3U-SPEC-005 FX3U-SPEC-007 FX3U-SPEC-008 FX3U-SPEC-009 FX3U-SPEC-013 "
      "FX3U-SPEC-014 FX3U-SPEC-015 FX3U-L2STOP-007");
  const Json sheet = fx_sheet();
  EXPECT_EQ(sheet["model"], "FX3U-CAN");
  EXPECT_EQ(sheet["points"], 8);
  EXPECT_EQ(sheet["flash_endurance"], 10'000);
  const std::vector<std::pair<std::string, std::string>> standards{
      {"CiA 301", "4.2"}, {"CiA 302", "4.1"}, {"CiA 305", "2.2"}, {"CiA 405", "2.0"}, {"CiA 417", "2.1"}};
  ASSERT_EQ(sheet["standards"].size(), standards.size());
  for (std::size_t i = 0; i < standards.size(); ++i) {
    EXPECT_EQ(sheet["standards"][i]["name"], standards[i].first);
    EXPECT_EQ(sheet["standards"][i]["version"], standards[i].second);
  }
  const std::vector<std::tuple<std::string, std::string, int>> cpus{{"FX3G", "1.00 or later", 8},
                                                                    {"FX3GC", "1.40 or later", 8},
                                                                    {"FX3U, FX3UC", "2.20 or later", 8},
                                                                    {"FX3UC-32MT-LT", "2.20 or later", 7},
                                                                    {"FX5U, FX5UC", "1.031 or later", 8}};
  ASSERT_EQ(sheet["modules_per_cpu"].size(), cpus.size());
  for (std::size_t i = 0; i < cpus.size(); ++i) {
    const Json& row = sheet["modules_per_cpu"][i];
    EXPECT_EQ(std::tuple(row["kind"].get<std::string>(), row["models"].get<std::string>(),
                         row["modules"].get<int>()),
              cpus[i]);
  }
  const std::vector<std::pair<int, int>> lengths{{1000, 25}, {800, 50},  {500, 100}, {250, 250}, {125, 500},
                                                 {100, 600}, {50, 1000}, {20, 2500}, {10, 5000}};
  ASSERT_EQ(sheet["bus_lengths"].size(), lengths.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_EQ(sheet["bus_lengths"][i]["kbps"], lengths[i].first);
    EXPECT_EQ(sheet["bus_lengths"][i]["metres"], lengths[i].second);
  }
  const Json& properties = sheet["properties"];
  const auto says = [&](const char* name, const char* what) {
    EXPECT_THAT(properties.value(name, ""), HasSubstr(what)) << name;
  };
  says("Place",
       "special function block No. 0 to 7, 1 to 7 behind an FX3UC-32MT-LT, 2 to 16 behind an FX5U or FX5UC");
  says("Place", "1 to 16 in the configuration tool");
  says("Firmware", "as 1.12");
  says("Since firmware 1.10", "100CH, 100DH, 1020H, 102AH; #70, #71, #10000 to #13539; #20 bits 8, 9, 12");
  says("Since firmware 1.10", "EMCY 3111H, 3121H, 8F01H to 8F7FH");
  says("Since firmware 1.12", "FX5U, FX5UC");
  says("Version of the PLC", "last three digits of D8001 or D8101");
  says("Values of 32 bits", "old and new may mix; no error shows it");
  says("RUN>STOP messages", "depends on the PLC and its extension blocks");
  says("Nodes per segment", "30 without repeaters, 127 in the network");
}

TEST(Fx3uCanInfo, Text_SaysTheSame) {
  TextOutput out, err;
  EXPECT_EQ(module_info("FX3U-CAN", std::nullopt, false, out, err), 0);
  for (const char* line : {"Model                     FX3U-CAN, Mitsubishi Electric\n", "  CAN_H ",
                           "  1000 kbps    25 m\n", "Flash memory              10000 writes\n"}) {
    EXPECT_THAT(out.text(), HasSubstr(line));
  }
}

struct Said {
  int code;
  std::string out, error;
};

/// Of an example's plant: `canopus check`, or `canopus run` in virtual time.
Said said_of(const std::string& example, bool runs) {
  std::vector<std::string> words{runs ? "run" : "check", CANOPUS_SOURCE_DIR "/examples/fx3u-can/" + example};
  if (runs) words.insert(words.end(), {"--virtual", "--for", "10s", "--expect-operational"});
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(words);
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

struct Example {
  const char* file;
  std::vector<const char*> lines;  ///< of the run
};

// Every example is accepted without a warning, comes up, and carries its data.
TEST(Fx3uCanExamples, AreAccepted_ComeUp_AndCarryTheirData) {
  RecordProperty("spec", "FX3U-MA-002 FX3U-MB-002 FX3U-MB-005 FX3U-M0-001 FX3U-L2-016 FX3U-L2RX-016");
  const std::vector<Example> examples{
      {"mode-a.toml",
       {"plc1 U0\\G10016 = 2000 ", "plc1 U0\\G10112 = 8000 ", "plc8 U0\\G10000 = 1000 ",
        "plc8 U0\\G10096 = 7000 ", "all 8 nodes operational"}},
      {"mode-b.toml",
       {"plc1 U0\\G10000 = 3000 ", "plc1 U0\\G10004 = 3016 ", "plc2 U0\\G10000 = 1000 ",
        "plc3 U0\\G10000 = 2000 ", "all 4 nodes operational"}},
      {"mode-0.toml",
       {"line U0\\G10000 = 22136 (5678H)", "press U0\\G10000 = 4660 (1234H)", "all 2 nodes operational"}},
      {"master.toml",
       {"press U0\\G10000 = 23040 (5A00H)", "press U0\\G10008 = 17185 (4321H)",
        "line U0\\G10000 = 4660 (1234H)", "all 4 nodes operational"}},
      {"layer2.toml",
       {"plc1 U0\\G103 = 45730 (B2A2H)", "plc1 U0\\G124 = 45987 (B3A3H)", "plc2 U0\\G103 = 45473 (B1A1H)",
        "(one): layer 2 online", "(two): layer 2 online"}}};
  for (const Example& example : examples) {
    SCOPED_TRACE(example.file);
    const Said checked = said_of(example.file, false);
    EXPECT_EQ(checked.code, 0) << checked.error;
    EXPECT_THAT(checked.out, HasSubstr(": good: "));
    EXPECT_EQ(checked.error, "");
    const Said ran = said_of(example.file, true);
    EXPECT_EQ(ran.code, 0) << ran.error;
    for (const char* line : example.lines) EXPECT_THAT(ran.out, HasSubstr(line));
    EXPECT_THAT(ran.out, HasSubstr(" 0 error frames"));
    EXPECT_THAT(ran.error, Not(HasSubstr("the program has not used the data words")));
  }
  // Each file of the folder is one of them; program.toml and program-fx5.toml wait for program.py, which tests/interop runs.
  EXPECT_EQ(said_of("program.toml", false).code, 0);
  EXPECT_EQ(said_of("program-fx5.toml", false).code, 0);
  for (const auto& entry : std::filesystem::directory_iterator(CANOPUS_SOURCE_DIR "/examples/fx3u-can")) {
    if (entry.path().extension() != ".toml" || entry.path().stem().string().starts_with("program")) continue;
    EXPECT_TRUE(std::ranges::any_of(examples, [&](const Example& example) {
      return entry.path().filename() == example.file;
    })) << entry.path();
  }
}

}  // namespace
}  // namespace canopus::cli::fx3u_can_test
