// What `canopus check` says of nodes that do not fit together. Each finding has a plant that has it, and one that
// has not.

#include "plant/plant_review.hpp"

namespace canopus::plant::plant_review_test {
namespace {

using namespace plant_review;

// --- SYNC

TEST_F(PlantReviewTest, SynchronousTpdoWithoutProducer_IsAWarning) {
  write("t.eds", support::device_file(support::variable("1005", 7, "0x80") + input +
                                      pdo("1800", "1A00", "$NODEID+0x180", "1")));
  EXPECT_THAT(
      check(bus + device(3, "t.eds")),
      ElementsAre(
          "plant.toml:4:1: warning: node 3 (t3): TPDO1 (1800:02 = 1) waits for SYNC, but no node on bus "
          "\"line1\" produces it: a producer has bit 30 of 1005H and 1006H set, and transmission type 255 "
          "works without SYNC"));
  EXPECT_EQ(exit_code_, 0);
  EXPECT_THAT(summary_, HasSubstr("good"));
  EXPECT_THAT(check(bus + device(3, "t.eds"), true), SizeIs(1));
  EXPECT_EQ(exit_code_, 2) << "--strict";
}

TEST_F(PlantReviewTest, TransmissionTypeOfThePlantFile_IsNamedAtItsPlace) {
  write("t.eds", support::device_file(support::variable("1005", 7, "0x80") + input +
                                      pdo("1800", "1A00", "$NODEID+0x180", "255")));
  EXPECT_THAT(check(bus + device(3, "t.eds", "objects = { \"1017:00\" = 500, \"1800:02\" = 0 }\n")),
              Not(IsEmpty()));
  EXPECT_THAT(check(bus + device(3, "t.eds", "objects = { \"1800:02\" = 240 }\n")),
              ElementsAre(HasSubstr("plant.toml:8:13: warning: node 3 (t3): TPDO1 (1800:02 = 240) waits")));
}

TEST_F(PlantReviewTest, SynchronousTpdoWithAProducer_IsNone) {
  write("t.eds", support::device_file(support::variable("1005", 7, "0x80") + input +
                                      pdo("1800", "1A00", "$NODEID+0x180", "240")));
  write("p.eds", support::device_file(support::variable("1005", 7, "0x40000080") +
                                      support::variable("1006", 7, "10000")));
  EXPECT_THAT(check(bus + device(3, "t.eds") + device(4, "p.eds")), IsEmpty());
  EXPECT_THAT(check(bus + device(3, "t.eds") +
                    master("objects = { \"1005:00\" = 0x4000_0080, \"1006:00\" = 10_000 }\n")),
              IsEmpty());
  EXPECT_THAT(check(bus + device(3, "t.eds") + unconfigured("new", "p.eds")), IsEmpty())
      << "it produces once LSS has given it a node-ID";
}

TEST_F(PlantReviewTest, ProducerThatIsNotSetUpOrOnlyListens_IsNone) {
  write("t.eds", support::device_file(support::variable("1005", 7, "0x80") + input +
                                      pdo("1800", "1A00", "$NODEID+0x180", "240")));
  write("p.eds", support::device_file(support::variable("1005", 7, "0x40000080") +
                                      support::variable("1006", 7, "10000")));
  const auto with = [&](const std::string& more) {
    return check(bus + device(3, "t.eds") + device(4, "p.eds", more));
  };
  EXPECT_THAT(with("objects = { \"1006:00\" = 0 }\n"), SizeIs(1));
  EXPECT_THAT(with("objects = { \"1005:00\" = 0x80 }\n"), SizeIs(1));
  EXPECT_THAT(with("listen_only = true\n"), SizeIs(1));
  EXPECT_THAT(check(bus + device(3, "t.eds", "objects = { \"1005:00\" = 0x81 }\n") + device(4, "p.eds")),
              ElementsAre(HasSubstr("no node on bus \"line1\" produces it with CAN-ID 081H, its 1005H:")));
  EXPECT_THAT(check(bus + device(3, "t.eds") + master("objects = { \"1005:00\" = 0x4000_0080 }\n")),
              SizeIs(1))
      << "1006H is 0";
}

TEST_F(PlantReviewTest, SynchronousTpdoWithout1005H_IsAWarningWithAnyProducer) {
  write("t.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x180", "0")));
  write("p.eds", support::device_file(support::variable("1005", 7, "0x40000080") +
                                      support::variable("1006", 7, "10000")));
  const auto warning =
      HasSubstr("TPDO1 (1800:02 = 0) waits for SYNC, but its file has no 1005H, so it never receives it");
  EXPECT_THAT(check(bus + device(3, "t.eds") + device(4, "p.eds")), ElementsAre(warning));
  EXPECT_THAT(check(served + device(3, "t.eds")), ElementsAre(warning)) << "whoever produces it";
}

TEST_F(PlantReviewTest, EventDrivenOrUnusedTpdo_IsNone) {
  write("e.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x180", "255")));
  write("off.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x80000180", "1")));
  write("empty.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x180", "1", "0")));
  EXPECT_THAT(check(bus + device(3, "e.eds") + device(4, "off.eds") + device(5, "empty.eds")), IsEmpty());
}

TEST_F(PlantReviewTest, SynchronousRpdo_IsAWarningWhereSomebodySendsToIt) {
  write("r.eds", support::device_file(support::variable("1005", 7, "0x80") + output +
                                      pdo("1400", "1600", "0x185", "1", "0x62000008")));
  write("t.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x180", "255")));
  EXPECT_THAT(check(bus + device(3, "r.eds")), IsEmpty());
  EXPECT_THAT(check(bus + device(3, "r.eds") + device(5, "t.eds")),
              ElementsAre(HasSubstr("node 3 (r3): RPDO1 (1400:02 = 1) waits for SYNC")));
}

TEST_F(PlantReviewTest, ProgramOutsideThatMayProduceSync_KeepsTheWarningAway) {
  write("t.eds", support::device_file(support::variable("1005", 7, "0x80") + input +
                                      pdo("1800", "1A00", "$NODEID+0x180", "1")));
  EXPECT_THAT(check(served + device(3, "t.eds")), IsEmpty()) << "its master is a program outside";
  EXPECT_THAT(check(served + device(3, "t.eds") + master("")), SizeIs(1)) << "its master is the module";
  const std::string layer2 =
      "[[plc]]\nlisten = \"off\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nbuffer = { G21 = 11 }\n";
  EXPECT_THAT(check(bus + device(3, "t.eds") + layer2), IsEmpty()) << "its program sends any frame";
}

TEST_F(PlantReviewTest, ManySynchronousTpdos_AreOneWarning) {
  std::string tpdos;
  constexpr std::string_view cob_ids[] = {"$NODEID+0x180", "$NODEID+0x280", "$NODEID+0x380",
                                          "$NODEID+0x480", "0x1F0",         "0x2F0"};
  for (std::size_t i = 0; i < std::size(cob_ids); ++i) {
    tpdos += pdo("180" + std::to_string(i), "1A0" + std::to_string(i), std::string(cob_ids[i]), "1");
  }
  write("t.eds", support::device_file(support::variable("1005", 7, "0x80") + input + tpdos));
  EXPECT_THAT(check(bus + device(3, "t.eds")),
              ElementsAre(HasSubstr("TPDO1 (1800:02 = 1), TPDO2 (1801:02 = 1), TPDO3 (1802:02 = 1), TPDO4 "
                                    "(1803:02 = 1) and 2 more wait for SYNC")));
}

// --- CAN-IDs

TEST_F(PlantReviewTest, RestrictedIdentifier_IsAWarningAndNotUsed) {
  write("z.eds", support::device_file(support::variable("1014", 7, "0")));
  EXPECT_THAT(
      check(bus + device(3, "z.eds")),
      ElementsAre("plant.toml:4:1: warning: node 3 (z3): 1014H is 00000000H, and CiA 301 restricts CAN-ID "
                  "000H: EMCY is not sent; objects can give it another"));
  EXPECT_THAT(check(bus + device(3, "z.eds", "objects = { \"1014:00\" = 0x83 }\n")), IsEmpty());
}

TEST_F(PlantReviewTest, RestrictedIdentifierOfWhatIsNotThere_IsNone) {
  write("z.eds",
        support::device_file(input + pdo("1800", "1A00", "0", "255", "0") +
                             "[1280]\nParameterName=C\nObjectType=9\n" +
                             support::variable("1280sub0", 5, "3") + support::variable("1280sub1", 7) +
                             support::variable("1280sub2", 7) + support::variable("1280sub3", 5)));
  EXPECT_THAT(check(bus + device(3, "z.eds")), IsEmpty()) << "no SDO client, nothing mapped";
}

TEST_F(PlantReviewTest, TwoSendersOfOneCanId_AreAWarning) {
  write("t.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x180", "255")));
  EXPECT_THAT(check(bus + device(3, "t.eds") + device(4, "t.eds")), IsEmpty());
  EXPECT_THAT(
      check(bus + device(3, "t.eds") + device(4, "t.eds", "objects = { \"1800:01\" = 0x183 }\n")),
      ElementsAre("plant.toml:12:13: warning: node 4 (t4): TPDO1 (1800:01) has CAN-ID 183H, and TPDO1 of "
                  "node 3 (t3) (line 4) has it, too: receivers cannot distinguish them, and frames at one "
                  "moment destroy each other; give each a CAN-ID of its own"));
  EXPECT_THAT(check(bus + device(3, "t.eds") +
                    device(4, "t.eds", "objects = { \"1800:01\" = 0x183 }\nlisten_only = true\n")),
              IsEmpty())
      << "it drives nothing";
}

TEST_F(PlantReviewTest, TwoBuses_AreReviewedEachForItself) {
  write("t.eds", support::device_file(input + pdo("1800", "1A00", "0x1A0", "255")));
  const std::string two = bus + "[[bus]]\nname = \"line2\"\nbit_rate = 250_000\n";
  EXPECT_THAT(
      check(two + device(32, "t.eds", "bus = \"line1\"\n") + device(32, "t.eds", "bus = \"line2\"\n")),
      IsEmpty());
}

TEST_F(PlantReviewTest, TwoProducersOfSync_AreAWarning) {
  write("p.eds", support::device_file(support::variable("1005", 7, "0x40000080") +
                                      support::variable("1006", 7, "10000")));
  EXPECT_THAT(
      check(bus + device(3, "p.eds") + device(4, "p.eds")),
      ElementsAre(HasSubstr("node 4 (p4): SYNC (1005:00) has CAN-ID 080H, and SYNC of node 3 (p3) (line 4) "
                            "has it, too: the others receive it twice; clear bit 30 of one 1005H")));
}

TEST_F(PlantReviewTest, LiteralCobIdsOfADcfUnderAnotherNode_AreAWarning) {
  write("t.dcf",
        support::device_file("[DeviceComissioning]\nNodeID=5\n" + support::variable("1014", 7, "0x85") +
                             input + pdo("1800", "1A00", "0x185", "255")));
  EXPECT_THAT(check(bus + device(5, "t.dcf")), IsEmpty());
  EXPECT_THAT(
      check(bus + device(7, "t.dcf")),
      ElementsAre("plant.toml:6:7: warning: node 7 (t7): 1014H = 085H, 1800:01 = 185H are for node 5 in the "
                  "pre-defined connection set: the DCF was made for node 5; objects can give it its own"));
  EXPECT_THAT(check(bus + device(7, "t.dcf", "objects = { \"1014:00\" = 0x85, \"1800:01\" = 0x185 }\n")),
              IsEmpty())
      << "meant so";
}

TEST_F(PlantReviewTest, CobIdOfAnotherNodeInTheDcfOfThisOne_IsMeantSo) {
  write("t.dcf", support::device_file("[DeviceComissioning]\nNodeID=5\n" + output +
                                      pdo("1400", "1600", "0x203", "255", "0x62000008")));
  EXPECT_THAT(check(bus + device(5, "t.dcf")), IsEmpty());
}

TEST_F(PlantReviewTest, FixedCobIdsOfAnEds_AreAWarningUnderAnotherNode) {
  write("t.eds", support::device_file(input + pdo("1800", "1A00", "0x181", "255")));
  EXPECT_THAT(check(bus + device(1, "t.eds")), IsEmpty());
  EXPECT_THAT(
      check(bus + device(7, "t.eds")),
      ElementsAre(HasSubstr("node 7 (t7): 1800:01 = 181H is for node 1 in the pre-defined connection set: "
                            "the file has fixed numbers where $NODEID is usual")));
}

// --- nodes that wait for each other

TEST_F(PlantReviewTest, HeartbeatConsumer_WhoseNodeIsMissingSilentOrSlow) {
  write("c.eds", support::device_file(support::array_of_one("1016")));
  write("p.eds", support::device_file(support::variable("1017", 6)));
  const std::string consumer =
      device(3, "c.eds", "objects = { \"1016:01\" = 0x0005_00C8 }\n");  // node 5 within 200 ms
  EXPECT_THAT(
      check(bus + consumer),
      ElementsAre("plant.toml:8:13: warning: node 3 (c3): 1016:01 waits for heartbeats of node 5, which is "
                  "not on bus \"line1\""));
  EXPECT_THAT(check(bus + consumer + device(5, "p.eds")),
              ElementsAre(HasSubstr("waits for heartbeats of node 5 (p5), whose 1017H is 0: it sends none")));
  EXPECT_THAT(check(bus + consumer + device(5, "p.eds", "objects = { \"1017:00\" = 500 }\n")),
              ElementsAre(HasSubstr("node 5 (p5), one in 200 ms at least, but its 1017H is 500 ms")));
  EXPECT_THAT(check(bus + consumer + device(5, "p.eds", "objects = { \"1017:00\" = 100 }\n")), IsEmpty());
  EXPECT_THAT(check(served + consumer), IsEmpty()) << "a program may become node 5";
  EXPECT_THAT(check(bus + consumer + unconfigured("new", "p.eds")), IsEmpty()) << "LSS may make it node 5";
}

TEST_F(PlantReviewTest, HeartbeatConsumerOfADeviceFile_MattersWhereHeartbeatsComeTooSeldom) {
  write("c.eds", support::device_file(support::array_of_one("1016", "0x000500C8")));
  write("c.dcf", support::device_file("[DeviceComissioning]\nNodeID=3\n" +
                                      support::array_of_one("1016", "0x000500C8")));
  write("p.eds", support::device_file(support::variable("1017", 6, "300")));
  EXPECT_THAT(check(bus + device(3, "c.eds")), IsEmpty()) << "who was never heard is not missed";
  EXPECT_THAT(check(bus + device(3, "c.dcf")), SizeIs(1)) << "made for this network";
  EXPECT_THAT(check(bus + device(3, "c.eds") + device(5, "p.eds")),
              ElementsAre(HasSubstr("one in 200 ms at least, but its 1017H is 300 ms")));
}

TEST_F(PlantReviewTest, SlaveThatNobodyIs_IsAWarning) {
  EXPECT_THAT(check(bus + master("objects = { \"1F81:09\" = 0x0D }\n")),
              ElementsAre(AllOf(HasSubstr("plant.toml:11:13: warning: node 1 ("),
                                HasSubstr("1F81:09 assigns node 9 as a slave, which is not on bus \"line1\": "
                                          "mandatory (bit 3), so the network does not start without it"))));
  EXPECT_THAT(check(served + master("objects = { \"1F81:09\" = 0x0D }\n")), IsEmpty())
      << "a program may become node 9";
}

TEST_F(PlantReviewTest, TwoMasters_AreAWarning) {
  const auto second = [](const std::string& more) {
    return "[[plc]]\nname = \"b\"\nlisten = \"off\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nnode = "
           "2\n" +
           more;
  };
  EXPECT_THAT(check(bus + master("") + second("objects = { \"1F80:00\" = 1 }\n")),
              ElementsAre(HasSubstr("is NMT master of bus \"line1\", and node 1 (")));
  EXPECT_THAT(check(bus + master("") + second("")), IsEmpty());
  const std::string flying = "objects = { \"1F80:00\" = 0x21 }\n";
  EXPECT_THAT(check(bus + master(flying) + second("master = true\n" + flying)), IsEmpty());
}

TEST_F(PlantReviewTest, EqualLssAddresses_AreAWarning) {
  write("a.eds", support::device_file(""));
  EXPECT_THAT(
      check(bus + unconfigured("left", "a.eds") + unconfigured("right", "a.eds")),
      ElementsAre(AllOf(HasSubstr("plant.toml:8:1: warning: right has the LSS address of left in line 4"),
                        HasSubstr("objects = { \"1018:04\" = 7 }"))));
  EXPECT_THAT(check(bus + unconfigured("left", "a.eds") +
                    unconfigured("right", "a.eds", "objects = { \"1018:04\" = 7 }\n")),
              IsEmpty());
}

}  // namespace
}  // namespace canopus::plant::plant_review_test
