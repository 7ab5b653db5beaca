// Plant files: buses that are not simulated, and bridges between buses.

#include "plant/good_plant.hpp"

namespace canopus::plant::plant_file_bus_test {
namespace {

constexpr std::string_view two_buses =
    "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n[[bus]]\nname = \"b\"\nbit_rate = 500_000\n";

std::string bus_with(std::string_view keys) {
  return "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n" + std::string(keys);
}
std::vector<std::string> errors_of_bridge(std::string_view keys) {
  return errors_of(std::string(two_buses) + "[[bridge]]\n" + std::string(keys));
}
BridgeSection bridge_of(std::string_view keys) {
  auto reading = read_plant(
      std::string(two_buses) + "[[bridge]]\nfrom = \"a\"\nto = \"b\"\n" + std::string(keys), "plant.toml");
  EXPECT_THAT(reading.errors, IsEmpty());
  return reading.plant.bridges.at(0);
}

TEST(PlantFileLink, Simulated_IsWhatABusIsByItself) {
  for (const std::string_view keys : {"", "link = \"sim\"\n"}) {
    const auto reading = read_plant(bus_with(keys), "plant.toml");
    EXPECT_THAT(reading.errors, IsEmpty());
    EXPECT_FALSE(reading.plant.buses.at(0).is_linked());
  }
}

TEST(PlantFileLink, AddressOfABus_IsRead) {
  const auto reading = read_plant(bus_with("link = \"socketcan:can0\"\n"), "plant.toml");
  EXPECT_THAT(reading.errors, IsEmpty());
  ASSERT_TRUE(reading.plant.buses.at(0).address);
  EXPECT_EQ(reading.plant.buses[0].address->bus, "can0");
  EXPECT_TRUE(reading.plant.buses[0].is_linked());
}

TEST(PlantFileLink, Replay_NamesAFile) {
  const auto reading = read_plant(bus_with("link = \"replay:runs/run 1.log\"\n"), "plant.toml");
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_EQ(reading.plant.buses.at(0).replay, "runs/run 1.log");
  EXPECT_TRUE(reading.plant.buses[0].is_linked());
}

TEST(PlantFileLink, Replay_MayNameAChannelOfTheTrace) {
  const auto reading = read_plant(bus_with("link = \"replay:a#b/run.log#can1\"\n"), "plant.toml");
  EXPECT_THAT(reading.errors, IsEmpty());
  EXPECT_EQ(reading.plant.buses.at(0).replay, "a#b/run.log");
  EXPECT_EQ(reading.plant.buses[0].replay_channel, "can1");
}

TEST(PlantFileLink, WrongLink_IsSaidWithItsPlace) {
  EXPECT_THAT(errors_of(bus_with("link = \"can0\"\n")),
              ElementsAre(AllOf(HasSubstr("plant.toml:4:8: link = \"can0\" is not a bus"),
                                HasSubstr("socketcan:"), HasSubstr("or \"sim\", or \"replay:FILE\""))));
  EXPECT_THAT(
      errors_of(bus_with("link = \"replay:\"\n")),
      ElementsAre(HasSubstr(
          "plant.toml:4:8: link = \"replay:\" has no file; expected replay:FILE or replay:FILE#CHANNEL")));
  EXPECT_THAT(errors_of(bus_with("link = 5\n")), ElementsAre(HasSubstr("plant.toml:4:8")));
}

TEST(PlantFileLink, FaultsNeedASimulatedBus) {
  EXPECT_THAT(
      errors_of(bus_with("link = \"socketcan:can0\"\n[[bus.fault]]\nkind = \"drop\"\n")),
      ElementsAre(
          "plant.toml:4:8: link = only a simulated bus can be disturbed, and there is a fault in line 5; "
          "expected \"sim\""));
}

TEST(PlantFileLink, TwoBusesOnOneLink_AreAMistake) {
  const std::string second = "[[bus]]\nname = \"b\"\nbit_rate = 250_000\nlink = ";
  EXPECT_THAT(errors_of(bus_with("link = \"socketcan:can0\"\n" + second + "\"socketcan:can0\"\n")),
              ElementsAre("plant.toml:8:8: link = \"socketcan:can0\": the bus in line 4 is on it already; "
                          "put its nodes on one bus"));
  EXPECT_THAT(errors_of(bus_with("link = \"socketcand:\"\n" + second + "\"socketcand:localhost:29536\"\n")),
              IsEmpty())
      << "names are not resolved";
  EXPECT_THAT(errors_of(bus_with("link = \"socketcan:can0\"\n" + second + "\"socketcan:can1\"\n")),
              IsEmpty());
  EXPECT_THAT(errors_of(bus_with("link = \"replay:a.log\"\n" + second + "\"replay:a.log\"\n")), IsEmpty());
}

TEST(PlantFileLink, NodesOutsideOfThePlant_MayBeOnALinkedBus) {
  const std::string module =
      "[[plc]]\nlisten = \"off\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nnode = 1\nmaster = true\n"
      "[[plc.module.slave]]\nnode = 9\n";
  EXPECT_THAT(errors_of(bus_with("link = \"socketcan:can0\"\n" + module)), IsEmpty());
  EXPECT_THAT(errors_of(bus_with(module)), ElementsAre(HasSubstr("the bus needs serve or link")));
}

TEST(PlantFileBridge, WithoutIdentifiers_PassesEverything) {
  const BridgeSection bridge = bridge_of("");
  EXPECT_FALSE(bridge.both_ways);
  EXPECT_TRUE(bridge.passes(can::data_frame(0)));
  EXPECT_TRUE(bridge.passes({.identifier = 0x1FFF'FFFF, .extended = true}));
}

TEST(PlantFileBridge, Identifiers_HaveElevenBitsOrTwentyNine) {
  const BridgeSection bridge =
      bridge_of("identifiers = [\"180-1FF\", \"701\", \"18FF0000-18FF00FF\"]\nboth_ways = true\n");
  EXPECT_TRUE(bridge.both_ways);
  for (const std::uint32_t identifier : {0x180U, 0x1FFU, 0x701U}) {
    EXPECT_TRUE(bridge.passes(can::data_frame(identifier))) << identifier;
    EXPECT_FALSE(bridge.passes({.identifier = identifier, .extended = true})) << identifier;
  }
  for (const std::uint32_t identifier : {0x17FU, 0x200U, 0x700U, 0x702U}) {
    EXPECT_FALSE(bridge.passes(can::data_frame(identifier))) << identifier;
  }
  EXPECT_TRUE(bridge.passes({.identifier = 0x18FF'00FF, .extended = true}));
  EXPECT_FALSE(bridge.passes({.identifier = 0x18FF'0100, .extended = true}));
}

TEST(PlantFileBridge, WrongIdentifiers_AreSaidOneByOne) {
  EXPECT_THAT(errors_of_bridge("from = \"a\"\nto = \"b\"\nidentifiers = [\"800\", \"1FF-180\", \"G1\", "
                               "\"180-18FF0000\", \"20000000\", 5, \"\"]\n"),
              testing::SizeIs(7));
  EXPECT_THAT(errors_of_bridge("from = \"a\"\nto = \"b\"\nidentifiers = []\n"),
              ElementsAre(HasSubstr("expected hexadecimal identifiers such as \"181\" or \"180-1FF\"")));
}

TEST(PlantFileBridge, ItsBusesMustBeThere) {
  EXPECT_THAT(errors_of_bridge("from = \"a\"\nto = \"c\"\n"),
              ElementsAre("plant.toml:7:1: bridge: there is no bus \"c\"; expected one of a, b"));
  EXPECT_THAT(errors_of_bridge("from = \"a\"\n"), ElementsAre(HasSubstr("to is missing")));
  EXPECT_THAT(errors_of_bridge("from = \"a\"\nto = \"a\"\n"), ElementsAre(HasSubstr("expected two buses")));
}

TEST(PlantFileBridge, SecondWayBetweenTwoBuses_IsAMistake) {
  EXPECT_THAT(
      errors_of_bridge("from = \"a\"\nto = \"b\"\n[[bridge]]\nfrom = \"b\"\nto = \"a\"\n"),
      ElementsAre(
          "plant.toml:10:1: bridge: frames can come from bus \"b\" to bus \"a\" already; a second way would "
          "repeat them. For both directions: both_ways = true"));
}

TEST(PlantFileBridge, RingOfThree_IsAMistake) {
  EXPECT_THAT(
      errors_of(std::string(two_buses) + "[[bus]]\nname = \"c\"\nbit_rate = 250_000\n"
                                         "[[bridge]]\nfrom = \"a\"\nto = \"b\"\n[[bridge]]\nfrom = \"b\"\nto "
                                         "= \"c\"\n[[bridge]]\nfrom = \"c\"\nto = \"a\"\n"),
      ElementsAre(HasSubstr("plant.toml:16:1: bridge: frames can come from bus \"c\" to bus \"a\" already")));
}

}  // namespace
}  // namespace canopus::plant::plant_file_bus_test
