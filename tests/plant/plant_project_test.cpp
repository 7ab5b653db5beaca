// Buses whose nodes are those of a CiA 306 project.

#include "canopus/plant/file/plant_file.hpp"

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
