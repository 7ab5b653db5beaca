// Buses whose nodes are those of a CiA 306 project.

#include <expected>
#include <fstream>
#include <iterator>
#include <optional>

#include "canopus/cli/network_project/network_check.hpp"
#include "canopus/plant/file/plant_file.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant_project_test {
namespace {

using support::device_file;
using support::PlantFolder;
using testing::HasSubstr;

class PlantProject : public PlantFolder {
 protected:
  PlantProject() {
    std::filesystem::create_directory(folder_ / "line1");
    write("line1/nodelist.cpj",
          "[Topology]\nNetName=Line 1\nNodes=4\n"
          "Node2Present=1\nNode2Name=Encoder\nNode2DCFName=encoder.dcf\n"
          "Node5Present=1\nNode5Name=Drive\nNode5DCFName=drive.dcf\n"
          "Node9Present=0\nNode9Name=Absent\nNode9DCFName=gone.dcf\n"
          "Node1Present=1\nNode1Name=PLC\nNode1DCFName=plc.dcf\n"
          "[Topology2]\nNetName=Line 2\nNodes=1\nNode7Present=1\nNode7Name=Other\nNode7DCFName=drive.dcf\n");
    write("line1/encoder.dcf", dcf(2));
    write("line1/drive.dcf", dcf(5));
    write("line1/plc.dcf", dcf(1) + "CANopenManager=1\n");
  }
  static std::string dcf(int node, int rate = 250) {
    return device_file("") + "[DeviceComissioning]\nNodeID=" + std::to_string(node) +
           "\nBaudrate=" + std::to_string(rate) + "\n";
  }
  /// "2 Encoder line1/encoder.dcf"
  static std::string devices(const std::string& text, const std::filesystem::path& folder) {
    std::string lines;
    const auto reading = plant::read_plant(text, (folder / "plant.toml").string());
    for (const auto& error : reading.errors) lines += describe(error, "plant.toml") + "\n";
    for (const auto& device : reading.plant.devices) {
      lines += std::to_string(device.node) + " " + device.name + " " + device.eds + " " + device.bus + "\n";
    }
    for (std::size_t at = 0; (at = lines.find(folder.string() + "/", at)) != std::string::npos;) {
      lines.erase(at, folder.string().size() + 1);
    }
    return lines;
  }
  [[nodiscard]] std::string devices(const std::string& text) const { return devices(text, folder_); }
};

const std::string bus = "[[bus]]\nname = \"a\"\nbit_rate = 250_000\nproject = \"line1/nodelist.cpj\"\n";

TEST_F(PlantProject, NodesThatArePresent_AreDevices_ButForTheManager) {
  EXPECT_EQ(devices(bus), "2 Encoder line1/encoder.dcf a\n5 Drive line1/drive.dcf a\n");
  EXPECT_THAT(check(bus), testing::IsEmpty());
}

TEST_F(PlantProject, ADeviceOfThePlant_GetsTheDcf_AndHasWhatItHas) {
  EXPECT_EQ(devices(bus + "[[device]]\nnode = 5\nstart = \"1s\"\n"),
            "5 Drive line1/drive.dcf a\n2 Encoder line1/encoder.dcf a\n");
  EXPECT_EQ(devices(bus + "[[device]]\nnode = 5\nname = \"own\"\neds = \"own.eds\"\n"),
            "5 own own.eds a\n2 Encoder line1/encoder.dcf a\n");
}

TEST_F(PlantProject, AModuleOfThePlant_TakesTheNodesPlace) {
  const std::string module =
      "[[plc]]\nfamily = \"Q\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nnode = 2\n";
  EXPECT_EQ(devices(bus + module), "5 Drive line1/drive.dcf a\n");
}

TEST_F(PlantProject, PdosOfAModule_AreKnownToTheChecksOfTheProject) {
  const auto text_of = [](const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  write("line1/encoder.dcf", text_of(CANOPUS_SOURCE_DIR "/examples/devices/encoder.eds") +
                                 "\n[DeviceComissioning]\nNodeID=2\nBaudrate=250\n");
  const std::string rack =
      "[[plc]]\nlisten = \"off\"\nfamily = \"Q\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\n"
      "node = 10\nmaster = true\nslaves = \"all\"\n";
  write("plant.toml", bus + rack);
  const auto project = network_project::NetworkProject::open(
      (folder_ / "line1/nodelist.cpj").string(),
      [&](const std::string& path) -> std::expected<std::optional<std::string>, std::string> {
        return std::filesystem::exists(path) ? std::optional(text_of(path)) : std::nullopt;
      });
  ASSERT_TRUE(project.has_value());
  text::TextOutput err;
  const auto external = cli::external_pdos(*project, (folder_ / "plant.toml").string(), err);
  ASSERT_TRUE(external.has_value()) << err.text();
  EXPECT_TRUE(external->received.contains(0x182)) << "TPDO1 of the encoder, into G10000";
  EXPECT_FALSE(external->received.contains(0x282)) << "its TPDO2 is not connected";
  write("plant.toml", "[[bus]]\n");
  EXPECT_EQ(cli::external_pdos(*project, (folder_ / "plant.toml").string(), err), std::nullopt);
  EXPECT_THAT(err.text(), HasSubstr("plant.toml:1:1: bus: name is missing"));
}

TEST_F(PlantProject, TwoBuses_HaveTheirNetworks) {
  EXPECT_EQ(devices(bus + "[[bus]]\nname = \"b\"\nbit_rate = 250_000\nproject = "
                          "\"line1/nodelist.cpj\"\nproject_network = 2\n"),
            "2 Encoder line1/encoder.dcf a\n5 Drive line1/drive.dcf a\n7 Other line1/drive.dcf b\n");
}

TEST_F(PlantProject, WhatIsWrong_NamesBothFiles) {
  write("line1/gone.cpj",
        "[Topology]\nNodes=2\nNode3Present=1\nNode3DCFName=gone.dcf\nNode4Present=1\nNode4DCFName=../x\n");
  const std::string gone = "[[bus]]\nname = \"a\"\nbit_rate = 250_000\nproject = \"line1/gone.cpj\"\n";
  EXPECT_EQ(devices(gone),
            "plant.toml:4:11: project = \"line1/gone.cpj\": line1/gone.cpj:3: node 3: cannot read "
            "line1/gone.dcf: No such "
            "file or directory\n"
            "plant.toml:4:11: project = \"line1/gone.cpj\": line1/gone.cpj:5: node 4: \"../x\" leads out of "
            "the project's "
            "folder\n");
  EXPECT_EQ(devices("[[bus]]\nname = \"a\"\nbit_rate = 250_000\nproject = \"none.cpj\"\n"),
            "plant.toml:4:11: project = \"none.cpj\": cannot read none.cpj: No such file or directory\n");
  EXPECT_EQ(devices(bus + "project_network = 3\n"),
            "plant.toml:4:11: project = \"line1/nodelist.cpj\": line1/nodelist.cpj: has 2 networks, not 3\n");
  EXPECT_THAT(devices(bus + "project_network = 0\n"), HasSubstr("networks of a project are counted from 1"));
}

TEST_F(PlantProject, ABitRateThatDiffers_IsAMistake) {
  const std::string fast = "[[bus]]\nname = \"a\"\nbit_rate = 500_000\nproject = \"line1/nodelist.cpj\"\n";
  EXPECT_THAT(
      devices(fast),
      testing::StartsWith("plant.toml:4:11: project = \"line1/nodelist.cpj\": its DCFs say 250 kbit/s, "
                          "bit_rate 500 kbit/s\n"));
  // When they differ among themselves, canopus project check says so.
  write("line1/drive.dcf", dcf(5, 500));
  EXPECT_EQ(devices(fast).find("kbit/s"), std::string::npos);
}

TEST_F(PlantProject, ADeviceWithoutAnyFile_IsAMistake) {
  EXPECT_THAT(
      devices(bus + "[[device]]\nnode = 3\n"),
      HasSubstr("plant.toml:5:1: device: eds is missing: the device file, or a node of the bus's project\n"));
}

}  // namespace
}  // namespace canopus::plant_project_test
