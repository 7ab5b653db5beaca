// What a node leaves out before it looks a frame up: no frame that it wants.

#include <gmock/gmock.h>

#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen::identifier_filter_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Recorder final : can::Sink {
  bool send(const can::Frame& frame) override {
    sent.push_back(frame.identifier);
    return true;
  }
  std::vector<std::uint32_t> sent;
};

can::Frame read_of_1000(std::uint32_t identifier) {
  return can::data_frame(identifier, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
}

TEST(IdentifierFilter, PassesAll_UntilItIsCleared_ThenWhatWasAdded) {
  IdentifierFilter filter;
  for (std::uint32_t identifier = 0; identifier <= can::max_base_identifier; ++identifier) {
    EXPECT_TRUE(filter.may_pass(identifier));
  }
  filter.clear();
  filter.add(0x605);
  filter.add(0x6C5);
  for (std::uint32_t identifier = 0; identifier <= can::max_base_identifier; ++identifier) {
    const bool is_alike = (identifier & 0x7F) == 0x05 || (identifier & 0x7F) == 0x45;
    EXPECT_EQ(filter.may_pass(identifier), is_alike) << identifier;
  }
  filter.pass_all();
  EXPECT_TRUE(filter.may_pass(0x601));
}

TEST(IdentifierFilter, EveryNodeIdIsHeard_AndNoOther) {
  DictionaryBuilder builder;
  builder.variable(0x1000, {});
  const auto description = builder.build();
  for (unsigned id = 1; id <= 127; ++id) {
    Recorder bus;
    Node node(description, static_cast<std::uint8_t>(id), bus);
    node.power_on({});
    bus.sent.clear();
    for (unsigned other = 1; other <= 127; ++other) node.receive(read_of_1000(0x600 + other), {});
    EXPECT_THAT(bus.sent, ElementsAre(0x580 + id));
  }
}

TEST(IdentifierFilter, AnIdentifierThatCameLater_IsHeardAtOnce) {
  DictionaryBuilder builder;
  builder.variable(0x1000, {});
  builder.sub(0x1201, 1, {.value = {0, 0, 0, 0x80}}).sub(0x1201, 2, {.value = {0, 0, 0, 0x80}});
  Recorder bus;
  Node node(builder.build(), 5, bus);
  node.power_on({});
  bus.sent.clear();
  node.receive(read_of_1000(0x6A7), {});
  EXPECT_THAT(bus.sent, IsEmpty());
  ASSERT_EQ(node.dictionary().write(0x1201, 1, can::little_endian(0x6A7, 4), {}), AbortCode::none);
  ASSERT_EQ(node.dictionary().write(0x1201, 2, can::little_endian(0x555, 4), {}), AbortCode::none);
  node.receive(read_of_1000(0x6A7), {});
  EXPECT_THAT(bus.sent, ElementsAre(0x555));
}

TEST(IdentifierFilter, AnIdentifierThatIsGone_IsHeardNoMore_AtOnce) {
  DictionaryBuilder builder;
  builder.variable(0x1000, {});
  builder.sub(0x1201, 1, {.value = {0xA7, 0x06, 0, 0}}).sub(0x1201, 2, {.value = {0x55, 0x05, 0, 0}});
  Recorder bus;
  Node node(builder.build(), 5, bus);
  node.power_on({});
  node.receive(read_of_1000(0x6A7), {});
  EXPECT_THAT(bus.sent, ElementsAre(0x705, 0x555));
  ASSERT_EQ(node.dictionary().write(0x1201, 1, can::little_endian(0x8000'06A7, 4), {}), AbortCode::none);
  bus.sent.clear();
  node.receive(read_of_1000(0x6A7), {});
  EXPECT_THAT(bus.sent, IsEmpty());
}

TEST(IdentifierFilter, ExtendedIdentifiersAreHeard) {
  DictionaryBuilder builder;
  builder.variable(0x1000, {});
  builder.sub(0x1201, 1, {.value = {0x78, 0x56, 0x34, 0x32}})
      .sub(0x1201, 2, {.value = {0x79, 0x56, 0x34, 0x32}});
  Recorder bus;
  Node node(builder.build(), 5, bus);
  node.power_on({});
  bus.sent.clear();
  can::Frame frame = read_of_1000(0x12345678);
  frame.extended = true;
  node.receive(frame, {});
  EXPECT_THAT(bus.sent, ElementsAre(0x12345679));
}

}  // namespace
}  // namespace canopus::canopen::identifier_filter_test
