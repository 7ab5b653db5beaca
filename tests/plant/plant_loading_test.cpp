// Every mistake of a plant is found in one run, however many there are.

#include "support/plant_folder.hpp"

namespace canopus::plant::plant_loading_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const std::string bus = "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n";

class PlantLoadingTest : public support::PlantFolder {
 protected:
  PlantLoadingTest() { write("a.eds", support::device_file(support::variable("1017", 6))); }
};

TEST_F(PlantLoadingTest, UnknownKey_DoesNotHideMistakesInWhatTheFileNames) {
  EXPECT_THAT(check(bus + "colour = \"red\"\n"
                          "[[device]]\nnode = 3\neds = \"missing.eds\"\n"
                          "[[device]]\nnode = 4\neds = \"a.eds\"\nobjects = { \"2000:00\" = 1 }\n"),
              ElementsAre(HasSubstr("plant.toml:4:1: bus: unknown key colour"),
                          HasSubstr("plant.toml:7:7: eds = \"missing.eds\": cannot read"),
                          HasSubstr("plant.toml:11:13: a.eds has no object 2000:00")));
  EXPECT_EQ(exit_code_, 2);
}

TEST_F(PlantLoadingTest, WrongSection_IsSaidOnceAndLeftOut) {
  EXPECT_THAT(check(bus + "[[device]]\nnode = 300\neds = \"a.eds\"\n"
                          "[[device]]\nnode = 4\neds = \"a.eds\"\nbus = \"line2\"\n"
                          "[[device]]\nnode = 5\n"
                          "[[device.behaviour]]\nobject = \"1017:00\"\nkind = \"jump\"\n"
                          "[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN9\"\nhead = 0\nbuffer = { G0 = 1 }\n"),
              ElementsAre(HasSubstr("plant.toml:5:8: node = 300"),
                          HasSubstr("plant.toml:7:1: device: there is no bus \"line2\""),
                          HasSubstr("plant.toml:11:1: device: eds is missing"),
                          HasSubstr("plant.toml:15:8: kind = \"jump\""),
                          HasSubstr("plant.toml:18:9: model = \"ME3CAN9\"")));
}

TEST_F(PlantLoadingTest, BitRateThatIsNone_DoesNotHideWhatIsOnTheBus) {
  EXPECT_THAT(
      check("[[bus]]\nname = \"line1\"\nbit_rate = 1\n[[device]]\nnode = 4\neds = \"no.eds\"\n"),
      ElementsAre(HasSubstr("plant.toml:3:12: bit_rate = 1"), HasSubstr("plant.toml:6:7: eds = \"no.eds\"")));
}

TEST_F(PlantLoadingTest, GoodPlant_IsGood) {
  EXPECT_THAT(check(bus + "[[device]]\nnode = 4\neds = \"a.eds\"\n"), IsEmpty());
  EXPECT_EQ(exit_code_, 0);
  EXPECT_EQ(summary_, "plant.toml: good: 1 bus, 1 device, 0 PLCs\n");
}

// A file by a program that went wrong: a line each, a hundred of them, and the number of the others.
TEST_F(PlantLoadingTest, ThousandsOfMistakes_AreSummedUp) {
  std::string text = bus;
  for (int i = 0; i < 5000; ++i) text += "[[device]]\nnode = 3\neds = \"a.eds\"\n";
  const auto lines = check(text);
  ASSERT_THAT(lines, SizeIs(101));
  EXPECT_EQ(lines[0], "plant.toml:7:1: device: node 3 of bus \"line1\" is taken already, in line 4");
  EXPECT_EQ(lines[100], "plant.toml: 4899 more mistakes");
}

TEST_F(PlantLoadingTest, DevicesWhoseFileNamesTheSameNode_AreMistakesOnceEach) {
  write("a.dcf", support::device_file("[DeviceComissioning]\nNodeID=7\n"));
  std::string text = bus;
  for (int i = 0; i < 100; ++i) text += "[[device]]\neds = \"a.dcf\"\n";
  const auto lines = check(text);
  ASSERT_THAT(lines, SizeIs(99));
  EXPECT_EQ(lines[0], "plant.toml:6:1: device: node 7 of bus \"line1\" is taken already");
}

TEST_F(PlantLoadingTest, MoreNodesThanNodeIds_IsOneMistake) {
  std::string text = bus;
  for (int i = 0; i < 200; ++i) text += "[[device]]\nnode = \"unconfigured\"\neds = \"a.eds\"\n";
  EXPECT_THAT(check(text),
              ElementsAre("plant.toml:385:1: device: bus \"line1\" has 127 nodes already, as many as "
                          "there are node-IDs"));
}

}  // namespace
}  // namespace canopus::plant::plant_loading_test
