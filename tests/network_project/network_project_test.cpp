// Projects of networks: nodes and values put in, moved and taken out, in the lines that say so.

#include "canopus/network_project/network_project.hpp"

#include <gtest/gtest.h>

#include "canopus/ascii/words.hpp"

#include "network_project/project_folder.hpp"
#include "paths.hpp"

namespace canopus::network_project::network_project_test {
namespace {

using namespace canopus;
using network_project::NetworkProject;
using test::ProjectFolder;

/// Lines of one text that the other has not.
std::string difference(const std::string& before, const std::string& after) {
  std::string lines;
  std::istringstream text(after);
  for (std::string line; std::getline(text, line);) {
    if (line.ends_with('\r')) line.pop_back();
    if (before.find(line + "\n") == std::string::npos && before.find(line + "\r\n") == std::string::npos) {
      lines += line + '\n';
    }
  }
  return lines;
}

TEST(NetworkProject, ANewProject_GetsNodesFromDeviceFiles) {
  ProjectFolder folder;
  NetworkProject project = folder.make("Line 1");
  EXPECT_EQ(
      project.add_node(
          {.name = "Pump", .eds = test::device_file("drive"), .eds_name = "drive.eds", .bit_rate = 500'000}),
      1);
  EXPECT_EQ(
      project.add_node({.node_id = 7, .eds = test::device_file("io-block"), .eds_name = "io-block.eds"}), 7);
  EXPECT_EQ(project.add_node({.eds = test::device_file("io-block"), .eds_name = "io-block.eds"}), 2);
  folder.use(project);
  EXPECT_EQ(folder.files.at("nodelist.cpj"),
            "[Topology]\r\nNetName=Line 1\r\nNodes=0x03\r\n"
            "Node1Present=0x01\r\nNode1Name=Pump\r\nNode1DCFName=pump.dcf\r\n"
            "Node7Present=0x01\r\nNode7Name=Canopus I/O block\r\nNode7DCFName=canopus-i-o-block.dcf\r\n"
            "Node2Present=0x01\r\nNode2Name=Canopus I/O block\r\nNode2DCFName=canopus-i-o-block-2.dcf\r\n");
  EXPECT_EQ(
      difference(test::device_file("drive"), folder.files.at("pump.dcf")),
      "FileName=pump.dcf\nLastEDS=drive.eds\n[DeviceComissioning]\nNodeID=1\nNodeName=Pump\nBaudrate=500\n"
      "NetworkName=Line 1\n");
  const NetworkProject again = folder.open();
  ASSERT_EQ(again.nodes().size(), 3U);
  EXPECT_EQ(again.nodes()[2].shown_name(), "node 7 (Canopus I/O block)");
  EXPECT_EQ(again.bit_rate(), 500'000U);  // the first one's, taken over by the others
  EXPECT_EQ(again.free_node_id(), 3);
  EXPECT_TRUE(again.changes().empty());
}

TEST(NetworkProject, ANodeThatCannotBeAdded_ChangesNothing) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{1, "drive"}, {2, "io-block"}});
  EXPECT_EQ(project.add_node({.node_id = 2, .eds = test::device_file("drive")}).error(),
            "node 2 (io-block) has this node-ID; 3 is free");
  EXPECT_EQ(project.add_node({.node_id = 128, .eds = test::device_file("drive")}).error(),
            "node-ID 128: expected 1 to 127");
  EXPECT_EQ(project.add_node({.eds = "no device"}).error(),
            "line 1: this is not an EDS or DCF: there is not one [section]");
  EXPECT_TRUE(project.changes().empty());
}

TEST(NetworkProject, AFileThatIsThere_IsNotOverwritten) {
  ProjectFolder folder;
  folder.files["pump.dcf"] = "somebody's";
  NetworkProject project = folder.make("");
  ASSERT_TRUE(project.add_node({.node_id = 5, .name = "Pump", .eds = test::device_file("drive")}));
  EXPECT_EQ(project.nodes()[0].path, "pump-5.dcf");
}

TEST(NetworkProject, Names_AreMadeFileNames) {
  ProjectFolder folder;
  NetworkProject project = folder.make("");
  const auto path_of = [&](std::uint8_t id, const std::string& name) {
    EXPECT_TRUE(project.add_node({.node_id = id, .name = name, .eds = test::device_file("drive")}));
    return project.find(id)->path;
  };
  EXPECT_EQ(path_of(1, "../../etc/passwd"), "etc-passwd.dcf");
  EXPECT_EQ(path_of(2, "Ventil (2)"), "ventil-2.dcf");
  EXPECT_EQ(path_of(3, "\xC3\xBC"), "node3.dcf");
  EXPECT_EQ(path_of(4, std::string(200, 'x')), std::string(60, 'x') + ".dcf");
  EXPECT_EQ(path_of(5, "ETC passwd"), "etc-passwd-5.dcf");
}

TEST(NetworkProject, AValue_IsOneLine) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  const std::string before = folder.files.at("drive.dcf");
  ASSERT_TRUE(project.set_value(5, 0x1017, 0, "500"));
  EXPECT_EQ(project.find(5)->value(0x1017), 500U);
  folder.use(project);
  EXPECT_EQ(difference(before, folder.files.at("drive.dcf")), "ParameterValue=500\n");
  project = folder.open();
  ASSERT_TRUE(project.remove_value(5, 0x1017, 0));
  EXPECT_EQ(project.find(5)->value(0x1017), 0U);
  folder.use(project);
  EXPECT_TRUE(folder.files.at("drive.dcf") == before);
}

TEST(NetworkProject, AValueThatDoesNotFit_IsRefused) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  EXPECT_EQ(project.set_value(5, 0x1017, 0, "70000").error(),
            "ParameterValue=70000 of 1017:00 does not fit UNSIGNED16; expected 0 to 65535");
  EXPECT_EQ(project.set_value(5, 0x3000, 0, "1").error(), "the file has no object 3000H");
  EXPECT_EQ(project.set_value(6, 0x1017, 0, "1").error(), "the project has no node 6");
  EXPECT_TRUE(project.changes().empty());
}

TEST(NetworkProject, ANodeThatMoves_TakesItsCobIdsAlong) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}, {6, "io-block"}});
  network_project::ListedNode node = project.find(5)->listed;
  node.node_id = 6;
  EXPECT_EQ(project.change_node(5, node).error(), "node 6 (io-block) has node-ID 6");
  node.node_id = 20;
  node.name = "Conveyor";
  node.reference = "-M1";
  ASSERT_TRUE(project.change_node(5, node));
  EXPECT_EQ(project.nodes()[1].shown_name(), "node 20 (Conveyor)");
  EXPECT_EQ(project.find(20)->pdos.back().cob_id.identifier(), 0x494U);
  const std::string before = folder.files.at("drive.dcf");
  folder.use(project);
  EXPECT_EQ(difference(before, folder.files.at("drive.dcf")), "NodeID=20\nNodeName=Conveyor\n");
  EXPECT_NE(folder.files.at("nodelist.cpj").find("Node20Refd=-M1\r\n"), std::string::npos);
  EXPECT_EQ(folder.files.at("nodelist.cpj").find("Node5"), std::string::npos);
}

TEST(NetworkProject, ANodeThatIsRemoved_TakesItsFileAlong_UnlessAnotherNetworkHasIt) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}, {6, "io-block"}});
  ASSERT_TRUE(project.remove_node(5));
  EXPECT_EQ(project.changes().at("drive.dcf"), std::nullopt);
  EXPECT_FALSE(project.changes().contains("io-block.dcf"));
  folder.files["nodelist.cpj"] +=
      "[Topology2]\r\nNodes=0x01\r\nNode9Present=0x01\r\nNode9DCFName=DRIVE.dcf\r\n";
  folder.files["nodelist.cpj"].replace(folder.files["nodelist.cpj"].find("DRIVE"), 5, "drive");
  NetworkProject with_two = folder.open();
  ASSERT_TRUE(with_two.remove_node(5));
  EXPECT_FALSE(with_two.changes().contains("drive.dcf"));
  EXPECT_EQ(with_two.remove_node(5).error(), "the project has no node 5");
}

TEST(NetworkProject, BitRates_AreThoseThatAllDevicesHave) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}, {6, "io-block"}});
  ASSERT_TRUE(project.set_bit_rate(250'000));
  EXPECT_EQ(project.bit_rate(), 250'000U);
  EXPECT_EQ(project.set_bit_rate(100'000).error(),
            "node 5 (drive) does not have 100 kbit/s: its file says 10, 20, 50, 125, 250, 500, 800, 1000");
  EXPECT_EQ(project.bit_rate(), 250'000U);
  folder.use(project);
  std::string& dcf = folder.files.at("drive.dcf");
  dcf.replace(dcf.find("Baudrate=250"), 12, "Baudrate=125");
  EXPECT_EQ(folder.open().bit_rate(), 0U) << "they differ";
}

TEST(NetworkProject, Nodes_AreFoundByNumberAndName) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}, {16, "io-block"}});
  EXPECT_EQ((*project.find("5"))->id(), 5);
  EXPECT_EQ((*project.find("0x10"))->id(), 16);
  EXPECT_EQ((*project.find("IO-Block"))->id(), 16);
  EXPECT_EQ(project.find("6").error(), "the project has no node 6");
  EXPECT_EQ(project.find("").error(), "the project has no node \"\"; expected a node-ID or a name");
  EXPECT_EQ(project.find("dri\x1B[2J").error(),
            "the project has no node \"dri?[2J\"; expected a node-ID or a name");
}

TEST(NetworkProject, Objects_AreFoundByNumberAndName) {
  ProjectFolder folder;
  const NetworkProject project = folder.with({{5, "io-block"}});
  const network_project::ProjectNode& node = project.nodes()[0];
  const auto name_of = [&](std::string_view text) {
    const auto entry = find_object(node, text);
    return entry ? eds::object_text(entry->index, entry->sub) : entry.error();
  };
  EXPECT_EQ(name_of("1017"), "1017:00");
  EXPECT_EQ(name_of("0x6000:0x01"), "6000:01");
  EXPECT_EQ(name_of("1800:02"), "1800:02");
  EXPECT_EQ(name_of("producer heartbeat time"), "1017:00");
  EXPECT_EQ(name_of("identity object.Vendor-ID"), "1018:01");
  EXPECT_EQ(name_of("heartbeat"),
            "node 5 (io-block) has no object \"heartbeat\"; did you mean 1016:00 (Consumer heartbeat time: "
            "Highest "
            "sub-index supported), 1016:01 (Consumer heartbeat time 1), 1016:02 (Consumer heartbeat time "
            "2), 1016:03 "
            "(Consumer heartbeat time 3), 1016:04 (Consumer heartbeat time 4), 1017:00 (Producer heartbeat "
            "time)?");
  EXPECT_EQ(name_of("Producer heartbaet time"),
            "node 5 (io-block) has no object \"Producer heartbaet time\"; did you mean 1017:00 (Producer "
            "heartbeat time)?");
  EXPECT_EQ(name_of("9999:01"),
            "node 5 (io-block) has no object \"9999:01\"; expected index:sub-index in hexadecimal, for "
            "example 6000:01, "
            "or its name");
}

TEST(NetworkProject, AProjectWithMistakes_CanBeLookedAt) {
  ProjectFolder folder;
  folder.files["nodelist.cpj"] =
      "[Topology]\nNodes=3\nNode1Present=1\nNode1DCFName=gone.dcf\nNode2Present=1\nNode2DCFName=../x.dcf\n"
      "Node3Present=1\nNode4Present=1\nNode4DCFName=broken.dcf\n";
  folder.files["broken.dcf"] = "no device";
  NetworkProject project = folder.open();
  EXPECT_EQ(project.find(1)->unreadable, "there is no such file");
  EXPECT_EQ(project.find(2)->unreadable, "\"../x.dcf\" leads out of the project's folder");
  EXPECT_EQ(project.find(3)->unreadable, "the list names no DCF for it");
  EXPECT_EQ(project.find(4)->unreadable, "line 1: this is not an EDS or DCF: there is not one [section]");
  EXPECT_EQ(project.set_value(1, 0x1017, 0, "1").error(), "gone.dcf: there is no such file");
  EXPECT_EQ(project.set_value(3, 0x1017, 0, "1").error(), "node 3: the list names no DCF for it");
  EXPECT_FALSE(project.set_bit_rate(500'000));
  EXPECT_TRUE(project.changes().empty());
  EXPECT_EQ(NetworkProject::open("nodelist.cpj", folder.reader(), 1).error(), "has 1 network, not 2");
  EXPECT_EQ(NetworkProject::open("other.cpj", folder.reader()).error(), "there is no such file");
}

/// Of an in-memory folder: the only file of this name in other upper and lower case.
FindFile finder_of(const ProjectFolder& folder) {
  return [&folder](const std::string& below, const std::string& name) -> std::optional<std::string> {
    std::optional<std::string> found;
    for (const auto& [path, text] : folder.files) {
      if (!path.starts_with(below) || !ascii::equal_ignoring_case(path.substr(below.size()), name)) continue;
      if (found) return std::nullopt;
      found = path.substr(below.size());
    }
    return found;
  };
}

TEST(NetworkProject, FileNameInOtherCase_IsTakenWithANote_AndWrittenAsItIs) {
  ProjectFolder folder;
  folder.files["line/nodelist.cpj"] =
      "[Topology]\nNodes=2\nNode1Present=1\nNode1Name=a\nNode1DCFName=DCF\\DRIVE.DCF\nNode2Present=1\n"
      "Node2DCFName=C:\\x\\Other.dcf\n";
  folder.files["line/dcf/drive.dcf"] = test::device_file("drive");
  folder.files["line/other.DCF"] = test::device_file("drive");
  auto project = NetworkProject::open("line/nodelist.cpj", folder.reader(), 0, finder_of(folder));
  ASSERT_TRUE(project) << project.error();
  EXPECT_EQ(project->nodes()[0].path, "line/dcf/drive.dcf");
  EXPECT_EQ(project->nodes()[0].unreadable, "");
  EXPECT_EQ(project->nodes()[0].path_note,
            "line/DCF/DRIVE.DCF is not there, line/dcf/drive.dcf is taken: its name differs in upper and "
            "lower case "
            "alone");
  EXPECT_EQ(project->nodes()[1].path, "line/other.DCF");
  ASSERT_TRUE(project->set_value(1, 0x1017, 0, "500"));
  const auto changes = project->changes();
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes.begin()->first, "line/dcf/drive.dcf");
}

TEST(NetworkProject, FileNameInOtherCase_ThatTwoFilesHave_IsNotTaken) {
  ProjectFolder folder;
  folder.files["nodelist.cpj"] = "[Topology]\nNodes=1\nNode1Present=1\nNode1DCFName=A.DCF\n";
  folder.files["a.dcf"] = folder.files["A.dcf"] = test::device_file("drive");
  auto project = NetworkProject::open("nodelist.cpj", folder.reader(), 0, finder_of(folder));
  EXPECT_EQ(project->nodes()[0].unreadable, "there is no such file");
}

TEST(NetworkProject, ALibraryBelowTheFolder_KeepsItsPaths) {
  ProjectFolder folder;
  folder.files["line1/nodelist.cpj"] =
      "[Topology]\nNodes=1\nNode1Present=1\nNode1Name=a\nNode1DCFName=dcf\\a.dcf\n";
  folder.files["line1/dcf/a.dcf"] = test::device_file("drive");
  auto project = NetworkProject::open("line1/nodelist.cpj", folder.reader());
  ASSERT_TRUE(project);
  EXPECT_EQ(project->nodes()[0].path, "line1/dcf/a.dcf");
  ASSERT_TRUE(project->add_node({.name = "b", .eds = test::device_file("drive")}));
  EXPECT_EQ(project->nodes()[1].path, "line1/b.dcf");
}

}  // namespace
}  // namespace canopus::network_project::network_project_test
