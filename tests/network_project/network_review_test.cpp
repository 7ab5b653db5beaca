// What does not fit together in a project, each in the words that a person reads; and the load of its bus.

#include "canopus/network_project/network_review.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "canopus/network_project/network_load.hpp"

#include "network_project/project_folder.hpp"

namespace canopus::network_project::network_review_test {
namespace {

using namespace canopus;
using network_project::NetworkProject;
using test::ProjectFolder;

std::string findings(const NetworkProject& project, bool with_notes = false) {
  std::string text;
  for (const network_project::Finding& finding : review(project)) {
    if (finding.severity == eds::Problem::Severity::note && !with_notes) continue;
    text += fmt::format("{}: {}: {}\n", finding.path, eds::name(finding.severity), finding.message);
  }
  return text;
}

network_project::Pdo pdo_of(const NetworkProject& project, std::uint8_t node, const std::string& name) {
  for (const network_project::Pdo& pdo : project.find(node)->pdos) {
    if (pdo.name() == name) return pdo;
  }
  throw std::out_of_range(name);
}

/// The drive's RPDO1 takes the frame of the I/O block's TPDO1, which maps this.
NetworkProject joined(ProjectFolder& folder, const std::vector<network_project::MappedObject>& sent,
                      const std::vector<network_project::MappedObject>& taken) {
  NetworkProject project = folder.with({{5, "drive"}, {7, "io-block"}});
  network_project::Pdo tpdo = pdo_of(project, 7, "TPDO1");
  tpdo.mapping = sent;
  EXPECT_TRUE(project.set_pdo(7, tpdo));
  network_project::Pdo rpdo = pdo_of(project, 5, "RPDO1");
  rpdo.cob_id.raw = tpdo.cob_id.key();
  rpdo.mapping = taken;
  EXPECT_TRUE(project.set_pdo(5, rpdo));
  return project;
}

TEST(NetworkReview, AProjectOfGoodFiles_HasNotesAlone) {
  ProjectFolder folder;
  const NetworkProject project = folder.with({{2, "encoder"}, {5, "drive"}});
  EXPECT_EQ(findings(project), "");
  EXPECT_NE(
      findings(project, true)
          .find(
              "drive.dcf: note: node 5 (drive): RPDO1 waits for 205H, which no node of the project sends\n"),
      std::string::npos);
  EXPECT_NE(
      findings(project, true)
          .find("encoder.dcf: note: node 2 (encoder): no node of the project receives its TPDO1 (182H)\n"),
      std::string::npos);
}

TEST(NetworkReview, PdosOfNodesOutsideOfTheProject_AreKnown) {
  ProjectFolder folder;
  const NetworkProject project = folder.with({{2, "encoder"}, {5, "drive"}});
  std::string messages;
  for (const network_project::Finding& finding : review(project, {.sent = {0x205}, .received = {0x182}}))
    messages += finding.message + "\n";
  EXPECT_EQ(messages.find("RPDO1 waits for 205H"), std::string::npos) << messages;
  EXPECT_EQ(messages.find("receives its TPDO1 (182H)"), std::string::npos) << messages;
  EXPECT_NE(messages.find("receives its TPDO1 (185H)"), std::string::npos) << messages;
}

TEST(NetworkReview, FilesThatCannotBeRead) {
  ProjectFolder folder;
  folder.files["nodelist.cpj"] =
      "[Topology]\nNodes=3\nNode1Present=1\nNode1DCFName=gone.dcf\nNode2Present=1\nNode2Name=x\n"
      "Node3Present=1\nNode3Name=eds\nNode3DCFName=a.eds\n";
  folder.files["a.eds"] = test::device_file("drive");
  EXPECT_EQ(findings(folder.open()),
            "gone.dcf: error: there is no such file\n"
            "nodelist.cpj: warning: node 2 has no DCF: Node2DCFName\n"
            "nodelist.cpj: warning: no DCF has a bit rate, so no load can be calculated\n"
            "nodelist.cpj: warning: node 3 (eds): a.eds has no [DeviceComissioning]: it is an EDS, not the "
            "DCF of a "
            "node\n");
}

TEST(NetworkReview, ADcfOfAnotherNode) {
  ProjectFolder folder;
  static_cast<void>(folder.with({{5, "drive"}}));
  std::string& list = folder.files.at("nodelist.cpj");
  for (std::size_t at = 0; (at = list.find("Node5", at)) != std::string::npos; ++at) list[at + 4] = '6';
  EXPECT_EQ(findings(folder.open()),
            "nodelist.cpj: error: node 6 (drive): drive.dcf is the DCF of node 5: its NodeID and the list "
            "must say the "
            "same\n");
}

TEST(NetworkReview, BitRatesThatDiffer_OrThatTheDeviceHasNot) {
  ProjectFolder folder;
  static_cast<void>(folder.with({{2, "encoder"}, {5, "drive"}}));
  std::string& dcf = folder.files.at("drive.dcf");
  dcf.replace(dcf.find("Baudrate=500"), 12, "Baudrate=100");
  EXPECT_EQ(
      findings(folder.open()),
      "nodelist.cpj: error: the DCFs have more than one bit rate: 100 kbit/s (node 5 (drive)), 500 kbit/s "
      "(node 2 "
      "(encoder))\n"
      "nodelist.cpj: error: node 5 (drive): its device file does not have 100 kbit/s among its bit rates\n");
}

TEST(NetworkReview, AFrameThatIsTooShort) {
  ProjectFolder folder;
  const NetworkProject project = joined(folder, {{0x6000, 1, 8}}, {{0x6040, 0, 16}});
  EXPECT_EQ(findings(project),
            "drive.dcf: error: node 5 (drive): RPDO1 maps 2 bytes, but TPDO1 of node 7 (io-block) sends 1 "
            "with 187H: a "
            "frame that is too short is not taken (EMCY 8210H); map fewer objects here or more there\n");
}

TEST(NetworkReview, SignalsThatAreCutInPieces_AndThatDoNot) {
  ProjectFolder folder;
  EXPECT_EQ(
      findings(joined(folder, {{0x6000, 1, 8}, {0x6000, 2, 8}}, {{0x6040, 0, 16}})),
      "drive.dcf: warning: node 5 (drive): RPDO1 takes bits 0 to 15 as 6040:00, but there TPDO1 of node 7 "
      "(io-block) has 6000:01 in bits 0 to 7\n");
  ProjectFolder shifted;
  EXPECT_EQ(findings(joined(shifted, {{0x6000, 1, 8}, {0x6401, 1, 16}, {0x6401, 2, 16}},
                            {{0x0006, 0, 16}, {0x6040, 0, 16}})),
            "drive.dcf: warning: node 5 (drive): RPDO1 takes bits 16 to 31 as 6040:00, but there TPDO1 of "
            "node 7 (io-block) "
            "has 6401:01 in bits 8 to 23\n");
  ProjectFolder other;
  const NetworkProject good = joined(other, {{0x6401, 1, 16}}, {{0x6040, 0, 16}});
  EXPECT_EQ(findings(good), "");
  EXPECT_NE(findings(good, true)
                .find("RPDO1: 6040:00 is UNSIGNED16, and 6401:01 of TPDO1 of node 7 (io-block) that it "
                      "gets is INTEGER16\n"),
            std::string::npos);
}

TEST(NetworkReview, MappingsThatTheDeviceCannot) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  for (const auto& [sub, value] :
       {std::pair(1, "0x60810020"), std::pair(2, "0x77770010"), std::pair(3, "0x60410008")}) {
    ASSERT_TRUE(project.set_value(5, 0x1A00, static_cast<std::uint8_t>(sub), value));
  }
  ASSERT_TRUE(project.set_value(5, 0x1A00, 0, "3"));
  const std::string text = findings(project);
  EXPECT_NE(text.find("drive.dcf: warning: TPDO1 maps 7777:00, which does not exist"), std::string::npos)
      << text;
  EXPECT_NE(text.find("drive.dcf: warning: TPDO1 maps 6041:00 with 8 bits, it has 16"), std::string::npos)
      << text;
}

TEST(NetworkReview, TwoPdosOfANodeWithOneCanId) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  ASSERT_TRUE(project.set_value(5, 0x1801, 1, "$NODEID+0x180"));
  EXPECT_EQ(findings(project),
            "drive.dcf: error: node 5 (drive): TPDO1 and TPDO2 have 185H both: receivers cannot distinguish "
            "them; give one "
            "another CAN-ID\n");
}

TEST(NetworkReview, TwoNodesWithOneCanId_AreFoundWherePlantsAreChecked) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}, {7, "io-block"}});
  ASSERT_TRUE(project.set_value(5, 0x1800, 1, "0x187"));
  EXPECT_EQ(findings(project).find("both: receivers"), std::string::npos);
}

TEST(NetworkReview, HeartbeatAndGuarding) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  ASSERT_TRUE(project.set_value(5, 0x1017, 0, "500"));
  ASSERT_TRUE(project.set_value(5, 0x100C, 0, "100"));
  ASSERT_TRUE(project.set_value(5, 0x100D, 0, "3"));
  EXPECT_EQ(findings(project),
            "drive.dcf: warning: node 5 (drive): has a heartbeat (1017H) and node guarding (100CH, 100DH): "
            "the heartbeat "
            "counts, set 100CH to 0\n");
}

TEST(NetworkLoad, TheLongestFrames_AreThoseOfTheStandard) {
  // Most stuff bits: one behind each four bits from SOF to the end of the CRC sequence, the first of them excepted.
  EXPECT_EQ(network_project::longest_frame_bits(8, false), 135U);
  EXPECT_EQ(network_project::longest_frame_bits(0, false), 55U);
  EXPECT_EQ(network_project::longest_frame_bits(8, true), 160U);
}

TEST(NetworkLoad, TimersSyncAndEvents_AreToldApart) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}, {7, "io-block"}}, 125'000);
  ASSERT_TRUE(project.set_value(5, 0x1017, 0, "100"));  // 10/s, 1 byte: 65 bits
  ASSERT_TRUE(project.set_value(5, 0x1800, 2, "1"));    // with SYNC, of which there is none
  ASSERT_TRUE(project.set_value(5, 0x1801, 5, "50"));   // 20/s, 3 bytes; inhibit time 10 ms: 100/s at most
  ASSERT_TRUE(project.set_value(5, 0x1802, 3, "0"));    // nothing limits it
  ASSERT_TRUE(project.set_value(5, 0x1803, 2, "253"));  // asked for alone
  const network_project::NetworkLoad load = reckon_load(project);
  const auto frame = [&](const std::string& what) {
    for (const network_project::CyclicFrame& one : load.frames) {
      if (one.node_id == 5 && one.what == what) return one;
    }
    throw std::out_of_range(what);
  };
  EXPECT_DOUBLE_EQ(frame("heartbeat").steady, 10);
  EXPECT_DOUBLE_EQ(frame("TPDO1").most.value(), 0);
  EXPECT_DOUBLE_EQ(frame("TPDO2").steady, 20);
  EXPECT_DOUBLE_EQ(frame("TPDO2").most.value(), 100);
  EXPECT_EQ(frame("TPDO3").most, std::nullopt);
  EXPECT_DOUBLE_EQ(frame("TPDO4").most.value(), 0);
  EXPECT_EQ(load.bit_rate, 125'000U);
  // 10 x 65 and 20 x 85 bits of 125,000.
  EXPECT_NEAR(load.steady, (10 * 65 + 20 * 85) / 125'000.0, 1e-9);
}

TEST(NetworkLoad, TheInhibitTime_HoldsTheEventTimer) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  ASSERT_TRUE(project.set_value(5, 0x1801, 5, "5"));  // inhibit time 10 ms
  for (const network_project::CyclicFrame& frame : reckon_load(project).frames) {
    if (frame.what != "TPDO2") continue;
    EXPECT_DOUBLE_EQ(frame.steady, 100);
    EXPECT_DOUBLE_EQ(frame.most.value(), 100);
  }
}

TEST(NetworkLoad, Sync_MakesSynchronousPdosCount) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}});
  ASSERT_TRUE(project.set_value(5, 0x1800, 2, "4"));
  ASSERT_TRUE(project.set_value(5, 0x1801, 2, "0"));
  EXPECT_DOUBLE_EQ(reckon_load(project).frames[0].steady, 0);
  std::string& dcf = folder.files.at("drive.dcf");
  dcf.replace(dcf.find("DefaultValue=0x00000080"), 23, "DefaultValue=0x40000080");
  dcf +=
      "[1006]\nParameterName=Communication cycle "
      "period\nObjectType=7\nDataType=7\nAccessType=rw\nDefaultValue=10000\n";
  NetworkProject with_sync = folder.open();
  ASSERT_TRUE(with_sync.set_value(5, 0x1800, 2, "4"));
  ASSERT_TRUE(with_sync.set_value(5, 0x1801, 2, "0"));
  const auto frames = reckon_load(with_sync).frames;
  EXPECT_EQ(frames[0].what, "SYNC");
  EXPECT_DOUBLE_EQ(frames[0].steady, 100);
  EXPECT_DOUBLE_EQ(frames[1].steady, 25);
  EXPECT_DOUBLE_EQ(frames[2].steady, 0);
  EXPECT_DOUBLE_EQ(frames[2].most.value(), 100);
}

TEST(NetworkReview, ABusThatIsTooFull) {
  ProjectFolder folder;
  NetworkProject project = folder.with({{5, "drive"}}, 10'000);
  ASSERT_TRUE(project.set_value(5, 0x1800, 5, "5"));
  EXPECT_NE(findings(project).find(
                "nodelist.cpj: error: timers and SYNC alone take 150 % of 10 kbit/s: make them slower, or "
                "the bus faster\n"),
            std::string::npos)
      << findings(project);
  ASSERT_TRUE(project.set_value(5, 0x1800, 5, "50"));
  EXPECT_NE(findings(project).find("warning: when all values change at once, "), std::string::npos);
}

}  // namespace
}  // namespace canopus::network_project::network_review_test
