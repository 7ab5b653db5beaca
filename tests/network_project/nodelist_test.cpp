// CiA 306 projects: read, changed in the lines that say so, and nothing else.

#include "canopus/network_project/nodelist.hpp"

#include <gtest/gtest.h>

namespace canopus::network_project::nodelist_test {
namespace {

using namespace canopus;
using network_project::ListedNode;
using network_project::Nodelist;

const std::string foreign =
    "; made by another tool\r\n"
    "[Topology]\r\n"
    "NetName=Line 1\r\n"
    "Nodes=0x02\r\n"
    "\r\n"
    "Node5Present=0x01\r\n"
    "Node5Name=Pump\r\n"
    "Node5Refd=-M1\r\n"
    "Node5DCFName=dcf\\pump.dcf\r\n"
    "Node5X=10 ; where it is drawn\r\n"
    "Node12Present=0x00\r\n"
    "Node12Name=Valve\r\n"
    "Node12DCFName=valve.dcf\r\n"
    "EDSBaseName=../eds\r\n"
    "[Tool]\r\n"
    "Window=1,2,3\r\n";

std::string problems(const Nodelist& list) {
  std::string text;
  for (const eds::Problem& problem : list.problems()) {
    text += std::to_string(problem.line) + ": " + std::string(name(problem.severity)) + ": " +
            problem.message + '\n';
  }
  return text;
}

std::string problems(std::string_view text) { return problems(Nodelist(text)); }

/// `foreign` with one piece replaced.
std::string with(std::string_view piece, std::string_view instead) {
  std::string text = foreign;
  return text.replace(text.find(piece), piece.size(), instead);
}

TEST(Nodelist, ForeignProject_IsReadAsItIsWritten) {
  const Nodelist list(foreign);
  EXPECT_EQ(problems(list), "");
  EXPECT_EQ(list.text(), foreign);
  ASSERT_EQ(list.networks().size(), 1U);
  const network_project::ListedNetwork& network = list.networks()[0];
  EXPECT_EQ(network.name, "Line 1");
  EXPECT_EQ(network.eds_base_name, "../eds");
  ASSERT_EQ(network.nodes.size(), 2U);
  const ListedNode& pump = network.nodes[0];
  EXPECT_EQ(pump.node_id, 5);
  EXPECT_TRUE(pump.present);
  EXPECT_EQ(pump.name, "Pump");
  EXPECT_EQ(pump.reference, "-M1");
  EXPECT_EQ(pump.dcf_name, "dcf\\pump.dcf");
  EXPECT_EQ(pump.line, 6U);
  EXPECT_FALSE(network.nodes[1].present);
  EXPECT_EQ(network.find(12), &network.nodes[1]);
  EXPECT_EQ(network.find(13), nullptr);
}

TEST(Nodelist, ManyNetworks_AreReadEachForItself) {
  const Nodelist list(
      "[Topology]\nNetName=A\n[Topology2]\nNetName=B\nNode1Present=1\nNode1DCFName=a.dcf\n[TopologyX]\n");
  ASSERT_EQ(list.networks().size(), 2U);
  EXPECT_EQ(list.networks()[1].name, "B");
  EXPECT_EQ(list.networks()[1].nodes.size(), 1U);
  EXPECT_EQ(list.networks()[0].nodes.size(), 0U);
}

TEST(Nodelist, NewName_IsOneOtherLine) {
  Nodelist list(foreign);
  ListedNode pump = list.networks()[0].nodes[0];
  pump.name = "Main pump";
  ASSERT_TRUE(list.set_node(0, pump));
  EXPECT_EQ(list.text(), with("Name=Pump", "Name=Main pump"));
  EXPECT_EQ(list.networks()[0].nodes[0].name, "Main pump");
  ASSERT_TRUE(list.set_network_name(0, "Line 2"));
  EXPECT_EQ(list.networks()[0].name, "Line 2");
  pump.present = false;
  ASSERT_TRUE(list.set_node(0, pump));
  EXPECT_NE(list.text().find("Node5Present=0x00\r\n"), std::string::npos);
}

TEST(Nodelist, NodeThatIsSetAsItIs_ChangesNothing) {
  const std::string text = with("Node5Present=0x01", "Node5Present = 1 ; there");
  Nodelist list(text);
  for (const ListedNode& node : std::vector<ListedNode>(list.networks()[0].nodes)) {
    ASSERT_TRUE(list.set_node(0, node));
  }
  EXPECT_EQ(list.text(), text);
}

TEST(Nodelist, NewNode_IsListedBehindTheOthers_AndCounted) {
  Nodelist list(foreign);
  ASSERT_TRUE(list.set_node(0, {7, true, "Drive", "", "drive.dcf"}));
  std::string expected = with("Nodes=0x02", "Nodes=0x03");
  const std::string_view last = "EDSBaseName=../eds\r\n";
  expected.insert(expected.find(last) + last.size(),
                  "Node7Present=0x01\r\nNode7Name=Drive\r\nNode7DCFName=drive.dcf\r\n");
  EXPECT_EQ(list.text(), expected);
  EXPECT_EQ(problems(list.text()), "");

  Nodelist decimal(with("Nodes=0x02", "Nodes=2"));
  ASSERT_TRUE(decimal.set_node(0, {7, true, "", "", "drive.dcf"}));
  EXPECT_NE(decimal.text().find("Nodes=3\r\n"), std::string::npos) << "decimal stays decimal";
}

TEST(Nodelist, RemovedNode_LeavesWhatNoNodeHas) {
  Nodelist list(foreign);
  ASSERT_TRUE(list.remove_node(0, 5));
  EXPECT_EQ(list.text(),
            "; made by another tool\r\n[Topology]\r\nNetName=Line 1\r\nNodes=0x01\r\n\r\n"
            "Node5X=10 ; where it is drawn\r\nNode12Present=0x00\r\nNode12Name=Valve\r\n"
            "Node12DCFName=valve.dcf\r\nEDSBaseName=../eds\r\n[Tool]\r\nWindow=1,2,3\r\n");
  ASSERT_TRUE(list.remove_node(0, 99));
}

TEST(Nodelist, NewProject_TakesNodes) {
  Nodelist list;
  EXPECT_EQ(problems(list), "");
  ASSERT_TRUE(list.set_network_name(0, "Line"));
  ASSERT_TRUE(list.set_node(0, {127, true, "A", "", "a.dcf"}));
  EXPECT_EQ(list.text(),
            "[Topology]\r\nNetName=Line\r\nNodes=0x01\r\nNode127Present=0x01\r\nNode127Name=A\r\n"
            "Node127DCFName=a.dcf\r\n");
}

TEST(Nodelist, LeftoversOfANode_AreNotTakenOver) {
  Nodelist list("[Topology]\nNode3Name=Old\nNode3DCFName=old.dcf\n");
  EXPECT_EQ(problems(list), "2: warning: node 3 has no Node3Present: it is not in the network\n");
  ASSERT_TRUE(list.set_node(0, {3, true, "", "", "new.dcf"}));
  EXPECT_EQ(list.text(), "[Topology]\nNode3Name=\nNode3DCFName=new.dcf\nNode3Present=0x01\nNodes=0x01\n");
}

TEST(Nodelist, Mistakes_AreSaidWithTheirLine) {
  EXPECT_EQ(problems(""), "1: error: there is no section [Topology]: this is no list of nodes of CiA 306\n");
  EXPECT_EQ(problems(std::string_view("\xFF\xFE[", 3)),
            "1: error: the file is not the UTF-16LE text that it begins as: save it as UTF-8 text\n");
  EXPECT_EQ(problems(with("Nodes=0x02", "Nodes=9")),
            "4: warning: Nodes=9, but 2 nodes listed: the list counts\n");
  EXPECT_EQ(problems(with("Nodes=0x02", "Nodes=1")), "") << "some count the nodes that are there";
  EXPECT_EQ(problems(with("Node5Present=0x01", "Node5Present=yes")),
            "6: warning: Node5Present=yes: 0x01 or 0x00 is expected: taken as not there\n");
  EXPECT_EQ(problems(with("Node5DCFName=dcf\\pump.dcf", "Other=")),
            "6: warning: node 5 has no DCF: Node5DCFName\n");
  EXPECT_EQ(problems(with("valve.dcf", "DCF/Pump.dcf")),
            "13: warning: node 12 has the DCF of node 5: each node needs its own\n");
  EXPECT_EQ(problems(with("valve.dcf", "..\\\\valve.dcf")),
            "13: warning: DCF of node 12: \"..\\\\valve.dcf\" leads out of the project's folder\n");
  for (const char* id : {"0", "128", "05", "999", "4294967297"}) {
    EXPECT_EQ(problems("[Topology]\nNode" + std::string(id) + "Present=1\n"),
              "2: warning: key node" + std::string(id) +
                  "present: a node-ID is 1 to 127, without zeros before it: not read\n");
  }
}

TEST(Nodelist, FileMadeToAnnoy_IsReadWithAnEnd) {
  std::string text = "[Topology]\n";
  for (int i = 0; i < 20'000; ++i) text += "Node" + std::to_string(1000 + i) + "Present=1\n";
  Nodelist list(text);
  EXPECT_EQ(list.problems().size(), 2001U);
  ASSERT_TRUE(list.set_node(0, {7, true, "", "", "a.dcf"}));
  EXPECT_EQ(list.problems().size(), 2001U) << "those of the file that was read";
}

TEST(Nodelist, WhatCannotBeWritten_IsRefused_AndChangesNothing) {
  Nodelist list(foreign);
  EXPECT_FALSE(list.set_node(0, {0, true, "", "", "a.dcf"}));
  EXPECT_FALSE(list.set_node(0, {128, true, "", "", "a.dcf"}));
  EXPECT_FALSE(list.set_node(1, {7, true, "", "", "a.dcf"}));
  EXPECT_FALSE(list.set_node(0, {7, true, "a\r\n[Tool]", "", "a.dcf"}));
  EXPECT_FALSE(list.set_node(0, {7, true, "", "", "/etc/a.dcf"}));
  EXPECT_FALSE(list.set_network_name(0, "a\nb"));
  EXPECT_EQ(list.text(), foreign);
  Nodelist unusable("[Other]\n");
  EXPECT_EQ(unusable.set_node(0, {7, true, "", "", "a.dcf"}).error(),
            "line 1: there is no section [Topology]: this is no list of nodes of CiA 306");
  EXPECT_EQ(unusable.text(), "[Other]\n");
}

TEST(Nodelist, QuotesRoundValues_AreTakenOffWithANote) {
  const std::string text =
      "[Topology]\nNetName=\"Line 1\"\nNodes=\"1\"\nNode5Present=\"0x01\"\nNode5Name='Pump "
      "1'\nNode5Refd=\"\"\n"
      "Node5DCFName=\"pump.dcf\"\n";
  Nodelist list(text);
  EXPECT_EQ(problems(list),
            "2: note: NetName=\"Line 1\": the quotes round it are taken off (and in 4 more places)\n");
  ASSERT_EQ(list.networks().size(), 1U);
  EXPECT_EQ(list.networks()[0].name, "Line 1");
  const ListedNode& node = *list.networks()[0].find(5);
  EXPECT_TRUE(node.present);
  EXPECT_EQ(node.name, "Pump 1");
  EXPECT_EQ(node.reference, "");
  EXPECT_EQ(node.dcf_name, "pump.dcf");
  EXPECT_EQ(list.text(), text);
  ASSERT_TRUE(list.set_node(0, {5, true, "Pump 2", "", "pump.dcf"}));
  std::string changed = text;
  EXPECT_EQ(list.text(), changed.replace(text.find("'Pump 1'"), 8, "Pump 2")) << "the other quotes stay";
}

TEST(Nodelist, QuoteThatIsNoPair_Stays) {
  const Nodelist list("[Topology]\nNodes=1\nNode5Present=1\nNode5Name=5\" pipe\"\nNode5DCFName=a.dcf\n");
  EXPECT_EQ(list.networks()[0].find(5)->name, "5\" pipe\"");
  EXPECT_EQ(problems(list), "");
}

TEST(Nodelist, PathsOfAnotherComputer_AreTakenFromTheFolder_WithANote) {
  const std::string text =
      "[Topology]\r\nNodes=3\r\nNode1Present=1\r\nNode1DCFName=C:\\Projects\\Line "
      "1\\pump.dcf\r\nNode2Present=1\r\n"
      "Node2DCFName=\\\\server\\share\\valve.dcf\r\nNode3Present=1\r\nNode3DCFName=d:fan.dcf\r\n";
  EXPECT_EQ(problems(text),
            "4: note: DCF of node 1: \"C:\\Projects\\Line 1\\pump.dcf\" is a path of another computer: "
            "pump.dcf in the "
            "project's folder is taken\n"
            "6: note: DCF of node 2: \"\\\\server\\share\\valve.dcf\" is a path of another computer: "
            "valve.dcf in the "
            "project's folder is taken\n"
            "8: note: DCF of node 3: \"d:fan.dcf\" is a path of another computer: fan.dcf in the project's "
            "folder is "
            "taken\n");
  Nodelist list(text);
  ASSERT_TRUE(list.set_node(0, {1, true, "Pump", "", "C:\\Projects\\Line 1\\pump.dcf"}))
      << "the path is not new";
  EXPECT_FALSE(list.set_node(0, {4, true, "", "", "C:\\a.dcf"}));
  EXPECT_EQ(problems("[Topology]\nNodes=1\nNode1Present=1\nNode1DCFName=C:\\dcf\\\n"),
            "4: warning: DCF of node 1: no file is named\n");
}

// Pump in Chinese, valve in Japanese.
TEST(Nodelist, OtherEncodings_AreReadAndWrittenAgain) {
  const auto list_with = [](const std::string& name) {
    return "[Topology]\r\nNodes=1\r\nNode5Present=1\r\nNode5Name=" + name + "\r\nNode5DCFName=a.dcf\r\n";
  };
  struct Case {
    std::string text;
    std::string name;
    std::string note;
  };
  std::string wide = "\xFF\xFE";
  for (const char c : list_with("A@")) wide += {c, '\0'};
  wide.replace(wide.find('@'), 2, "\xF6\x6C");
  const Case cases[] = {
      {list_with("\xCB\xAE\xB1\xC3\xB5\xE7\xBB\xFA"), "水泵电机",
       "bytes that are not UTF-8: read as GB18030 text"},
      {list_with("\x83\x6F\x83\x8B\x83\x75"), "バルブ", "bytes that are not UTF-8: read as CP932 text"},
      {list_with("T\xFCr \x80"), "Tür €", "bytes that are not UTF-8: read as Windows Latin text"},
      {"\xEF\xBB\xBF" + list_with("Tür"), "Tür", "the file begins with a UTF-8 byte order mark: skipped"},
      {wide, "A泶", "the file is UTF-16LE text: converted"},
  };
  for (const auto& [text, name, note] : cases) {
    SCOPED_TRACE(name);
    Nodelist list(text);
    EXPECT_EQ(problems(list), "1: note: " + note + "\n");
    ASSERT_EQ(list.networks().size(), 1U);
    EXPECT_EQ(list.networks()[0].find(5)->name, name);
    EXPECT_EQ(list.text(), text);
    ASSERT_TRUE(list.set_node(0, {5, true, name, "-M1", "a.dcf"}));
    const Nodelist again(list.text());
    EXPECT_EQ(again.networks()[0].find(5)->name, name);
    EXPECT_EQ(again.networks()[0].find(5)->reference, "-M1");
  }
  Nodelist chinese(cases[0].text);
  EXPECT_EQ(chinese.set_node(0, {5, true, "\xED\xA0\x80", "", "a.dcf"}).has_value(), false);
}

TEST(PathInProject, PathThatLeavesTheFolder_IsRefused) {
  EXPECT_EQ(network_project::path_in_project("a.dcf"), "a.dcf");
  EXPECT_EQ(network_project::path_in_project("dcf\\..a\\b..dcf"), "dcf/..a/b..dcf");
  for (const char* bad :
       {"", " ", "/a", "\\a", "C:\\a", "c:a", "..", "../a", "a/../b", "a\\..", "a/", "a\x1B[2J", "a\nb"}) {
    EXPECT_FALSE(network_project::path_in_project(bad)) << bad;
  }
}

}  // namespace
}  // namespace canopus::network_project::nodelist_test
