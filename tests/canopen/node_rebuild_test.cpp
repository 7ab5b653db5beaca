// Node::describe() and set_sink() make dictionary and services anew; what was registered with the node stays.

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::node_rebuild_test {
namespace {

struct Refusal final : ObjectHandler {
  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override {
    ++asked;
    return AbortCode::hardware_error;
  }
  int asked = 0;
};

struct NodeRebuildTest : testing::Test, Conversation {
  void describe(const DictionaryBuilder& objects = standard_objects()) {
    node.power_off();
    node.describe(objects.build(), {});
    node.power_on(now);
    bus.drain();
  }
};

TEST_F(NodeRebuildTest, AHandler_IsCalledForTheNextDictionary_AlsoForObjectsThatTheFirstOneHadNot) {
  Refusal refusal;
  node.attach(0x2005, 0x2100, refusal);
  EXPECT_EQ(write(0x2005, 0, 7, 2), AbortCode::hardware_error);
  EXPECT_EQ(write(0x2100, 0, 7, 1), AbortCode::no_object);
  DictionaryBuilder more = standard_objects();
  more.variable(0x2100, {.name = "new", .type = DataType::unsigned8});
  describe(more);
  EXPECT_EQ(write(0x2005, 0, 7, 2), AbortCode::hardware_error);
  EXPECT_EQ(write(0x2100, 0, 7, 1), AbortCode::hardware_error);
  EXPECT_EQ(receive("605 2F 00 21 00 07 00 00 00"), "585 80 00 21 00 00 00 06 06");
  EXPECT_EQ(refusal.asked, 4);
}

TEST_F(NodeRebuildTest, ADetachedHandler_IsCalledNoMore_AndTheNodesOwnIsAgain) {
  Refusal refusal;
  for (const bool is_rebuilt_before : {false, true}) {
    for (const bool is_rebuilt_after : {false, true}) {
      node.attach(0x1017, 0x1017, refusal);
      if (is_rebuilt_before) describe();
      EXPECT_EQ(write(0x1017, 0, 100, 2), AbortCode::hardware_error);
      refusal.asked = 0;
      node.detach(refusal);
      if (is_rebuilt_after) describe();
      EXPECT_EQ(write(0x1017, 0, 100, 2), AbortCode::none);
      EXPECT_NE(wait(100ms), "") << "its heartbeat";
      EXPECT_EQ(refusal.asked, 0);
      EXPECT_EQ(write(0x1017, 0, 0, 2), AbortCode::none);
    }
  }
}

TEST_F(NodeRebuildTest, NodeId_ListenerAndParameterStore_StayAsTheyAre) {
  struct Store final : ParameterStore {
    std::vector<std::uint8_t> load() override { return image; }
    AbortCode save(std::span<const std::uint8_t> bytes) override {
      image.assign(bytes.begin(), bytes.end());
      return AbortCode::none;
    }
    std::vector<std::uint8_t> image;
  } store;
  DictionaryBuilder objects = standard_objects();
  objects.uniform(0x1010, ObjectCode::array, "store", 1, {.value = {1, 0, 0, 0}});
  node.set_parameter_store(&store);
  node.set_node_id(9);
  describe(objects);
  EXPECT_EQ(node.node_id(), 9);
  EXPECT_EQ(drain_events(), "reset done, pre-operational");
  EXPECT_EQ(write(0x2005, 0, 7, 2), AbortCode::none);
  EXPECT_EQ(write(0x1010, 1, 0x65766173, 4), AbortCode::none);
  EXPECT_FALSE(store.image.empty());
  describe(objects);
  EXPECT_EQ(node.dictionary().get<std::uint16_t>(0x2005, 0), 7);
}

TEST_F(NodeRebuildTest, AnotherSink_GetsTheFrames_AndTheHandlersStay) {
  Refusal refusal;
  node.attach(0x2005, 0x2005, refusal);
  node.power_off();
  Notebook other;
  node.set_sink(other);
  node.power_on(now);
  EXPECT_EQ(other.drain(), "705 00");
  EXPECT_EQ(receive("605 2B 05 20 00 07 00 00 00"), "");
  EXPECT_EQ(other.drain(), "585 80 05 20 00 00 00 06 06");
  node.power_off();
  node.set_sink(bus);
  node.power_on(now);
  EXPECT_EQ(bus.drain(), "705 00");
}

TEST_F(NodeRebuildTest, IdentifiersChange_AsTheyMay) {
  const std::uint32_t before = node.identifiers_revision();
  node.power_off();
  node.describe(standard_objects().build(), {});
  EXPECT_NE(node.identifiers_revision(), before);
  EXPECT_EQ(node.deadline(), can::never);
}

// The reference is a list: the last registration that covers an object counts.
RC_GTEST_PROP(NodeHandlers, AnObject_HasTheHandlerThatWasRegisteredLast,
              (const std::vector<std::uint8_t>& bytes)) {
  struct Listing final : ObjectHandler {
    AbortCode before_read(ObjectDictionary&, const Entry&, can::Time) override {
      was_asked = true;
      return AbortCode::none;
    }
    bool was_asked = false;
  };
  struct Registration {
    std::uint16_t first;
    std::uint16_t last;
    std::size_t handler;
    bool operator==(const Registration&) const = default;
  };
  constexpr std::uint16_t begin = 0x2000;
  constexpr std::uint16_t objects = 6;
  DictionaryBuilder builder;
  for (std::uint16_t i = 0; i < objects; ++i)
    builder.variable(static_cast<std::uint16_t>(begin + i), {.name = "value", .type = DataType::unsigned8});
  const auto description = builder.build();
  Notebook bus;
  Node node(description, 5, bus);
  std::array<Listing, 3> handlers;
  std::vector<Registration> expected;
  for (const std::uint8_t byte : bytes) {
    const std::size_t number = byte / 16 % handlers.size();
    const auto first = static_cast<std::uint16_t>(begin + byte % objects);
    const auto last = static_cast<std::uint16_t>(first + byte / 64);
    if (byte % 16 == 15) {
      node.describe(description, {});
    } else if (byte % 16 >= 12) {
      node.detach(handlers[number]);
      std::erase_if(expected, [&](const Registration& known) { return known.handler == number; });
    } else {
      node.attach(first, last, handlers[number]);
      std::erase(expected, Registration{first, last, number});
      expected.push_back({first, last, number});
    }
    for (std::uint16_t index = begin; index < begin + objects; ++index) {
      for (Listing& handler : handlers) handler.was_asked = false;
      RC_ASSERT(node.dictionary().read(index, 0, {}).has_value());
      const auto owner = std::find_if(expected.rbegin(), expected.rend(), [&](const Registration& known) {
        return known.first <= index && index <= known.last;
      });
      for (std::size_t i = 0; i < handlers.size(); ++i)
        RC_ASSERT(handlers[i].was_asked == (owner != expected.rend() && owner->handler == i));
    }
  }
}

TEST(NodeHandlers, ThatComeAndGo_DoNotUseUpTheirNumbers) {
  Notebook bus;
  Node node(standard_objects().build(), 5, bus);
  for (int i = 0; i < 1000; ++i) {
    Refusal first;
    Refusal second;
    node.attach(0x2005, 0x2006, first);
    node.attach(0x2006, 0x2007, second);
    node.detach(first);
    EXPECT_EQ(node.dictionary().write(0x2006, 0, std::vector<std::uint8_t>(4), {}),
              AbortCode::hardware_error);
    EXPECT_EQ(first.asked, 0);
    node.detach(second);
    EXPECT_EQ(node.dictionary().write(0x2006, 0, std::vector<std::uint8_t>(4), {}), AbortCode::none);
  }
}

TEST(NodeHandlers, MoreThan255_AreRefused_AndTheOthersStay) {
  Notebook bus;
  Node node(standard_objects().build(), 5, bus);
  std::array<Refusal, 300> handlers;
  std::size_t attached = 0;
  const auto attach_all = [&] {
    for (; attached < handlers.size(); ++attached) node.attach(0x2005, 0x2005, handlers[attached]);
  };
  EXPECT_THROW(attach_all(), std::length_error);
  EXPECT_GT(attached, 200U);
  EXPECT_EQ(node.dictionary().write(0x2005, 0, std::vector<std::uint8_t>(2), {}), AbortCode::hardware_error);
  EXPECT_EQ(handlers[attached - 1].asked, 1);
}

}  // namespace
}  // namespace canopus::canopen::node_rebuild_test
