#include "canopus/trace/decode/names.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/trace/decode/bus_knowledge.hpp"
#include "canopus/trace/decode/value_text.hpp"

namespace canopus::trace::names_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> on(const Names& names, std::string_view channel) {
  std::vector<std::string> found;
  for (const NodeDescription* node : names.on_channel(channel)) found.push_back(node->name);
  return found;
}

TEST(Names, Channel_HasTheNodesOfTheBusOfItsName) {
  Names names;
  names.add({.bus = "line1", .node_id = 2, .name = "a"});
  names.add({.bus = "line2", .node_id = 2, .name = "b"});
  names.add({.bus = "line2", .node_id = 3, .name = "c"});
  names.add({.node_id = 9, .name = "everywhere"});
  EXPECT_THAT(on(names, "line1"), ElementsAre("a", "everywhere"));
  EXPECT_THAT(on(names, "line2"), ElementsAre("b", "c", "everywhere"));
}

TEST(Names, ChannelOfNoBus_HasTheNodeIdsThatAreInOneBusAlone) {
  Names names;
  names.add({.bus = "line1", .node_id = 2, .name = "a"});
  names.add({.bus = "line2", .node_id = 2, .name = "b"});
  names.add({.bus = "line2", .node_id = 3, .name = "c"});
  EXPECT_THAT(on(names, "can0"), ElementsAre("c"));
}

TEST(Names, SecondNodeOfABusAndNodeId_TakesThePlaceOfTheFirst) {
  Names names;
  names.add({.bus = "line1", .node_id = 2, .name = "a"});
  names.add({.bus = "line1", .node_id = 2, .name = "b"});
  EXPECT_THAT(on(names, "line1"), ElementsAre("b"));
}

TEST(BusKnowledge, IdentifierOfTwoPdos_NamesThatOfTheConnectionSet) {
  // Node 1 sends on the identifier on which node 2 receives its RPDO1.
  const NodeDescription master{
      .node_id = 1, .name = "master", .settings = {{0x1800, 1, 0x202}, {0x1A00, 0, 0}}};
  const NodeDescription slave{
      .node_id = 2, .name = "slave", .settings = {{0x1400, 1, 0x202}, {0x1600, 0, 0}}};
  const BusKnowledge bus({&master, &slave});
  ASSERT_NE(bus.pdo(0x202), nullptr);
  EXPECT_EQ(bus.pdo(0x202)->node, 2);
  EXPECT_FALSE(bus.pdo(0x202)->transmit);
  EXPECT_EQ(bus.pdos(0x202).size(), 2U);
}

TEST(BusKnowledge, CobIdsOfOtherServices_AreFollowed) {
  const NodeDescription node{.node_id = 5,
                             .settings = {{0x1005, 0, 0x4000'0088}, {0x1012, 0, 0x1FF}, {0x1014, 0, 0x090}}};
  BusKnowledge bus({&node});
  EXPECT_TRUE(bus.is_sync(0x88));
  EXPECT_TRUE(bus.is_time(0x1FF));
  EXPECT_EQ(bus.emcy_producer(0x90), 5);
  bus.learn(5, 0x1014, 0, 0x8000'0090);  // switched off: the identifier is the connection set's again
  EXPECT_EQ(bus.emcy_producer(0x90), 0x10);
  bus.learn(5, 0x1005, 0, 0x0000'0089);
  EXPECT_FALSE(bus.is_sync(0x88));
  EXPECT_TRUE(bus.is_sync(0x89));
  bus.learn(5, 0x1005, 0, 0x0000'0705);  // a restricted identifier is used by nobody
  EXPECT_FALSE(bus.is_sync(0x705));
}

TEST(BusKnowledge, SdoClientOfAMaster_IsAChannelOfItsServer) {
  BusKnowledge bus({});
  bus.learn(1, 0x1280, 1, 0x640);
  bus.learn(1, 0x1280, 2, 0x5C0);
  EXPECT_EQ(bus.sdo(0x640)->server, 0x40);  // of the connection set, as long as the server is not known
  bus.learn(1, 0x1280, 3, 7);
  EXPECT_EQ(bus.sdo(0x640)->server, 7);
  EXPECT_TRUE(bus.sdo(0x640)->from_client);
  EXPECT_FALSE(bus.sdo(0x5C0)->from_client);
}

TEST(ValueText, IsTheValueOfItsType) {
  using canopen::DataType;
  const auto text = [](std::vector<std::uint8_t> bytes, DataType type) { return value_text(bytes, type); };
  EXPECT_EQ(text({0xFB, 0xFF}, DataType::integer16), "-5");
  EXPECT_EQ(text({0xFB, 0xFF}, DataType::unsigned16), "65531");
  EXPECT_EQ(text({0xFF, 0xFF, 0xFF}, DataType::integer24), "-1");
  EXPECT_EQ(text({0x00, 0x00, 0xC0, 0x3F}, DataType::real32), "1.5");
  EXPECT_EQ(text({0x01}, DataType::boolean), "true");
  EXPECT_EQ(text({'a', 'b', 0, 0}, DataType::visible_string), "\"ab\"");
  EXPECT_EQ(text({1, 2, 3}, DataType::domain), "01 02 03");
  EXPECT_EQ(text({1, 2, 3}, DataType::unsigned16), "030201H");  // another length than the type's
  EXPECT_EQ(text({}, DataType::none), "nothing");
}

TEST(NumberOf, TakesTheBitsThatAreMapped) {
  using canopen::DataType;
  EXPECT_EQ(number_of(0xFF0F, 4, DataType::integer8), -1.0);
  EXPECT_EQ(number_of(0xFF0F, 4, DataType::unsigned8), 15.0);
  EXPECT_EQ(number_of(0x8000'0000'0000'0000, 64, DataType::integer64), -9223372036854775808.0);
  EXPECT_EQ(number_of(1, 0, DataType::unsigned8), std::nullopt);
  EXPECT_EQ(number_of(1, 32, DataType::visible_string), std::nullopt);
}

}  // namespace
}  // namespace canopus::trace::names_test
