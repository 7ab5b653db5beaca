// What `canopus check` says of the slaves that a plant file assigns, and what a check leaves alone.

#include "paths.hpp"
#include "plant/plant_review.hpp"

namespace canopus::plant::plant_review_slaves_test {
namespace {

using namespace plant_review;

// --- what the plant file asks for

TEST_F(PlantReviewTest, SlavesAll_SaysWhatItLeavesUnconnected) {
  write("none.eds", support::device_file(""));
  write("t.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x180", "255")));
  EXPECT_THAT(
      check(bus + device(3, "none.eds") + device(4, "t.eds") + master("slaves = \"all\"\n")),
      ElementsAre(
          "plant.toml:19:10: warning: slaves = \"all\" connects nothing of node 3 (none3): TPDO1: the "
          "device has no such PDO; RPDO1: the device has no such PDO"));
  EXPECT_THAT(check(bus + unconfigured("new", "t.eds") + master("slaves = \"all\"\n")),
              ElementsAre(HasSubstr("slaves = \"all\" leaves out \"new\", which has no node-ID yet")));
}

TEST_F(PlantReviewTest, SlavesAll_NamesThePdosThatCouldBeConnected) {
  write("t.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x80000180", "255") +
                                      pdo("1801", "1A01", "$NODEID+0x280", "255") +
                                      pdo("1803", "1A03", "$NODEID+0x80000480", "255")));
  EXPECT_THAT(
      check(bus + device(3, "t.eds") + master("slaves = \"all\"\n")),
      ElementsAre(HasSubstr("TPDO1: the device's file leaves this PDO switched off (COB-ID bit 31); RPDO1: "
                            "the device has no such PDO; [[plc.module.slave]] with node = 3, receive = [2] "
                            "connects others")));
}

TEST_F(PlantReviewTest, SlavesAll_SaysWhatTheModuleHasNoPlaceFor) {
  write("t.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x20000180", "255") + output +
                                      pdo("1400", "1600", "$NODEID+0x200", "255", "0x62000008")));
  EXPECT_THAT(
      check(bus + device(3, "t.eds") + master("slaves = \"all\"\n")),
      ElementsAre(HasSubstr("slaves = \"all\" connects not all of node 3 (t3): TPDO1: the PDO has a 29-bit "
                            "identifier, which the module does not take")));
}

TEST_F(PlantReviewTest, SlavesAll_ConnectsNoPdos_InAFunctionModeOfADeviceProfile) {
  write("t.eds", support::device_file(input + pdo("1800", "1A00", "$NODEID+0x180", "255")));
  const auto with_mode = [](const std::string& mode) {
    return "[[plc]]\nfamily = \"FX3\"\nlisten = \"off\"\n[[plc.module]]\nmodel = \"FX3U-CAN\"\nposition = "
           "0\nnode = 1\n"
           "master = true\nslaves = \"all\"\nbuffer = { G21 = " +
           mode + " }\n";
  };
  EXPECT_THAT(check(bus + device(3, "t.eds") + with_mode("417")),
              ElementsAre(HasSubstr(
                  "connects nothing of node 3 (t3): TPDO1: in the module's function mode its PDOs are "
                  "those of a device profile")));
  EXPECT_THAT(check(bus + device(3, "t.eds") + with_mode("405")), IsEmpty());
}

TEST_F(PlantReviewTest, StoreThatNeverStores_IsAWarning) {
  write("a.eds", support::device_file(support::variable("1017", 6)));
  write("s.eds", support::device_file(support::array_of_one("1010")));
  const auto with_store = [](const std::string& eds) { return device(3, eds, "store = \"state\"\n"); };
  EXPECT_THAT(
      check(bus + with_store("a.eds")),
      ElementsAre(
          "plant.toml:8:9: warning: store = \"state\": a.eds has no 1010H that can be written, and is "
          "no LSS slave: the device never stores anything"));
  EXPECT_THAT(check(bus + with_store("s.eds")), IsEmpty());
  EXPECT_THAT(check(bus + device(3, "a.eds", "lss = true\nstore = \"state\"\n")), IsEmpty());
  EXPECT_THAT(check(bus + "[[plc]]\nlisten = \"off\"\nstore = \"state\"\n"),
              ElementsAre(HasSubstr("store = \"state\": the PLC has no module that could store anything")));
}

// --- what a look must not do, and what it must see

TEST_F(PlantReviewTest, ACheck_LeavesTheMarkOfAnInterruptedSaveAlone) {
  const std::filesystem::path stored = folder_ / "state" / "plc1.U000-ME3CAN1-Q";
  store::FileMemory memory(stored, "the ME3CAN1-Q at head 000H of PLC \"plc1\"");
  ASSERT_TRUE(memory.write("saving", {}));
  const std::string plant = bus + "[[plc]]\nname = \"plc1\"\nstore = \"state\"\n" +
                            master("").substr(std::string("[[plc]]\n").size());
  EXPECT_THAT(check(plant), IsEmpty());
  EXPECT_TRUE(std::filesystem::exists(stored / "saving")) << "the next start has to find it";
}

TEST_F(PlantReviewTest, SlaveThatTheMasterConfigures_IsNotReviewed) {
  write("t.eds", support::device_file(support::variable("1005", 7, "0x80") + input +
                                      pdo("1800", "1A00", "$NODEID+0x180", "1")));
  const std::string plant = bus + device(3, "t.eds") + "[[plc]]\nname = \"plc1\"\nstore = \"state\"\n" +
                            master("").substr(std::string("[[plc]]\n").size());
  EXPECT_THAT(check(plant), SizeIs(1));
  store::FileMemory memory(folder_ / "state" / "plc1.U000-ME3CAN1-Q",
                           "the ME3CAN1-Q at head 000H of PLC \"plc1\"");
  module::FlashMemory flash(memory, {"concise-dcf"});
  std::vector<std::uint8_t> image;
  const std::uint8_t type[] = {1, 0, 0, 0, 0x00, 0x18, 2, 1, 0, 0, 0, 255};
  canopen::append_stored_value(image, canopen::StoredLength::two_bytes, 0x1F22, 3, type);
  ASSERT_TRUE(flash.write("concise-dcf", image));
  EXPECT_THAT(check(plant), IsEmpty()) << "1F22:03 makes it event-driven";
  EXPECT_THAT(check(plant + device(4, "t.eds")), IsEmpty()) << "1F22:03 could make node 3 produce SYNC";
}

TEST_F(PlantReviewTest, ManyDevices_AreReviewedInTime) {
  write("t.eds", support::device_file(support::variable("1005", 7, "0x80") + input +
                                      pdo("1800", "1A00", "$NODEID+0x180", "1")));
  std::string text = bus;
  for (int node = 2; node <= 127; ++node) text += device(node, "t.eds");
  EXPECT_THAT(check(text + master("slaves = \"all\"\n")), Not(IsEmpty()));
}

// Every file of other makers on one bus: each line is true, and there are fewer than devices.
TEST_F(PlantReviewTest, RealDeviceFiles_GetFewWarnings) {
  const std::filesystem::path files = CANOPUS_SOURCE_DIR "/../shared/data/eds";
  if (!std::filesystem::exists(files)) GTEST_SKIP() << "no device files in " << files;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(files)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".eds" || ending == ".dcf") names.push_back(entry.path().string());
  }
  std::ranges::sort(names);
  std::string text = bus;
  int node = 2;
  for (const std::string& name : names) {
    text += "[[device]]\nnode = " + std::to_string(node++) + "\neds = \"" + name + "\"\n";
  }
  const auto lines = check(text);
  EXPECT_EQ(exit_code_, 0);
  EXPECT_LT(lines.size(), names.size());
  for (const std::string& line : lines) EXPECT_THAT(line, HasSubstr(": warning: "));
  EXPECT_THAT(lines, Not(Contains(HasSubstr("restricts"))));
}

}  // namespace
}  // namespace canopus::plant::plant_review_slaves_test
