// `canopus new`: what it writes boots at the first run.

#include "canopus/cli/new/new_command.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "canopus/cli/run/operational_check.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plc/execution/program_execution.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::cli::new_command_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

const std::string devices = CANOPUS_SOURCE_DIR "/examples/devices/";

class NewPlantFolder : public support::PlantFolder, public plant::PlantObserver {
 protected:
  int make(NewPlantOptions options) {
    if (options.folder.empty()) options.folder = line();
    return new_plant(options, out_, err_);
  }
  [[nodiscard]] std::string line() const { return (folder_ / "line").string(); }
  [[nodiscard]] std::string file(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(std::filesystem::path(line()) / name).rdbuf();
    return text.str();
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    if (!std::filesystem::exists(line())) return all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(line())) {
      if (entry.is_regular_file()) all.push_back(entry.path().lexically_relative(line()).string());
    }
    return all;
  }

  text::TextOutput out_;
  text::TextOutput err_;
};

class NewPlantOfModule : public NewPlantFolder, public testing::WithParamInterface<std::string> {};

TEST_P(NewPlantOfModule, BootsEveryDevice_WithoutAWarning) {
  ASSERT_EQ(
      make({.module = GetParam(),
            .devices = {devices + "io-block.eds", "7=" + devices + "drive.eds", devices + "encoder.eds"}}),
      0)
      << err_.text();
  text::TextOutput err;
  const auto plant = plant::load_plant(line() + "/plant.toml", *this, err);
  ASSERT_NE(plant, nullptr) << err.text();
  EXPECT_THAT(plant->warnings(), IsEmpty());
  plant->power_on();
  plant->timeline().run_until(can::Time(std::chrono::seconds(20)));
  std::vector<unsigned> nodes;
  for (const plant::NodeStatus& node : plant->nodes()) nodes.push_back(node.label.node_id);
  EXPECT_THAT(nodes, UnorderedElementsAre(1, 2, 3, 7));
  EXPECT_TRUE(all_operational(plant->nodes()));
  for (const std::string& words : plant->connections()) {
    EXPECT_THAT(file("plant.toml"), HasSubstr("# " + words));
    const std::string first_word = words.substr(0, words.find_first_of("- "));
    EXPECT_THAT(file("main.st"), HasSubstr(" AT " + first_word + " : WORD;"));
  }
  EXPECT_NE(plant->program(0)->machine().read("Main.scans").value_or("0"), "0");
}

TEST_F(NewPlantFolder, TheProgramReadsAndWritesTheWordsOfEachPdo) {
  ASSERT_EQ(make({.module = "ME3CAN1-Q", .devices = {devices + "io-block.eds", devices + "encoder.eds"}}), 0);
  EXPECT_THAT(file("main.st"), HasSubstr("  // TPDO1 of node 2 (io-block), 182H, 2 bytes\n"
                                         "  node2_TPDO1 AT U0\\G10000 : WORD;\n"));
  EXPECT_THAT(file("main.st"), HasSubstr("  node3_TPDO1_1 AT U0\\G10004 : WORD;\n"
                                         "  node3_TPDO1_2 AT U0\\G10005 : WORD;\n"));
}

INSTANTIATE_TEST_SUITE_P(EachModule, NewPlantOfModule,
                         testing::Values("ME3CAN1-Q", "rj71cn91", "FX3U-CAN", "FX2N-32CAN", "AS-FCOPM"),
                         [](const auto& one) {
                           std::string name = one.param;
                           std::erase_if(name, [](char c) { return c == '-'; });
                           return name;
                         });

TEST_F(NewPlantFolder, ADeviceFileOfTwoDevices_IsThereOnce_AndTheyHaveNamesOfTheirOwn) {
  ASSERT_EQ(make({.module = "ME3CAN1-Q",
                  .devices = {devices + "encoder.eds", devices + "encoder.eds"},
                  .test = true}),
            0)
      << err_.text();
  EXPECT_EQ(names().size(), 5U);
  EXPECT_THAT(names(), testing::IsSupersetOf({"plant.toml", "main.st", "test_plant.py", "conftest.py"}));
  for (const std::string& name : names()) EXPECT_FALSE(file(name).empty()) << name;
}

TEST_F(NewPlantFolder, HostileNames_StayTextInTheirPlace) {
  const std::string eds = support::device_file("");
  write("x.eds", eds);
  ASSERT_EQ(make({.module = "ME3CAN1-Q",
                  .devices = {(folder_ / "x.eds").string()},
                  .name = "a\"\n[[plc]]\nname = \"../..\\"}),
            0)
      << err_.text();
  text::TextOutput err;
  const auto plant = plant::load_plant(line() + "/plant.toml", *this, err);
  ASSERT_NE(plant, nullptr) << err.text();
  EXPECT_EQ(plant->file().name, "a\"\n[[plc]]\nname = \"../..\\");
  EXPECT_THAT(names(), testing::Each(Not(HasSubstr(".."))));
}

struct Mistake {
  const char* name;
  NewPlantOptions options;
  const char* message;
};

class NewPlantMistake : public NewPlantFolder, public testing::WithParamInterface<Mistake> {};

TEST_P(NewPlantMistake, IsSaid_AndNothingIsWritten) {
  EXPECT_EQ(make(GetParam().options), 2);
  EXPECT_THAT(err_.text(), HasSubstr(GetParam().message));
  EXPECT_FALSE(std::filesystem::exists(line()));
}

INSTANTIATE_TEST_SUITE_P(
    Each, NewPlantMistake,
    testing::Values(
        Mistake{"NoSuchModule",
                {.module = "ME3CAN1-Z"},
                "there is no module \"ME3CAN1-Z\"; did you mean \"ME3CAN1-Q\"?"},
        Mistake{"NoDevice", {.module = "ME3CAN1-Q"}, "--device is missing"},
        Mistake{"NoSuchFile", {.module = "ME3CAN1-Q", .devices = {"/nowhere/x.eds"}}, "/nowhere/x.eds"},
        Mistake{"NodeIdOutOfRange",
                {.module = "ME3CAN1-Q", .devices = {"128=" + devices + "drive.eds"}},
                "a node-ID from 1 to 127"},
        Mistake{"NodeIdTwice",
                {.module = "ME3CAN1-Q",
                 .devices = {"5=" + devices + "drive.eds", "5=" + devices + "encoder.eds"}},
                "another device has node-ID 5 already"},
        Mistake{"BitRate",
                {.module = "ME3CAN1-Q", .devices = {devices + "drive.eds"}, .bit_rate = "fast"},
                "bit"},
        Mistake{"BitRateOfNoModule",
                {.module = "FX2N-32CAN", .devices = {devices + "drive.eds"}, .bit_rate = "100k"},
                "plant.toml:"},
        Mistake{"DevicesAndBus",
                {.module = "ME3CAN1-Q", .devices = {devices + "drive.eds"}, .from_bus = true},
                "--from-bus and --device: one of them"}),
    [](const auto& one) { return one.param.name; });

TEST_F(NewPlantFolder, AFolderThatIsNotEmpty_StaysAsItIs) {
  std::filesystem::create_directories(line());
  std::ofstream(line() + "/notes") << "mine";
  EXPECT_EQ(make({.module = "ME3CAN1-Q", .devices = {devices + "drive.eds"}}), 2);
  EXPECT_THAT(err_.text(), HasSubstr("the folder is not empty"));
  EXPECT_THAT(names(), ElementsAre("notes"));
}

}  // namespace
}  // namespace canopus::cli::new_command_test
