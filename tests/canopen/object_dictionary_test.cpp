#include "canopus/canopen/dictionary/object_dictionary.hpp"

#include <functional>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/timer_queue.hpp"

namespace canopus::canopen::object_dictionary_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(DictionaryDescription, SubIndexZero_IsMadeWithTheHighestSubIndex) {
  DictionaryBuilder b;
  b.object(0x2000, ObjectCode::record, "r").sub(0x2000, 3, {.name = "c", .value = {7}});
  const auto d = b.build();
  ObjectDictionary od(d, 1);
  EXPECT_EQ(od.get<std::uint8_t>(0x2000, 0), 3);
  EXPECT_EQ(od.get<std::uint32_t>(0x2000, 3), 7U);
  EXPECT_EQ(od.find(0x2000, 1).error(), AbortCode::no_sub_index);
  EXPECT_EQ(od.find(0x2000, 4).error(), AbortCode::no_sub_index);
  EXPECT_EQ(od.find(0x2001, 0).error(), AbortCode::no_object);
}

TEST(DictionaryDescription, SubIndexFfh_DoesNotCountAsHighest) {
  DictionaryBuilder b;
  b.sub(0x2000, 2, {}).sub(0x2000, 0xFF, {});
  ObjectDictionary od(b.build(), 1);
  EXPECT_EQ(od.get<std::uint8_t>(0x2000, 0), 2);
  EXPECT_TRUE(od.find(0x2000, 0xFF));
}

TEST(DictionaryDescription, ObjectWithoutSubIndexes_HasNone) {
  DictionaryBuilder b;
  b.object(0x2000, ObjectCode::variable, "nothing");
  b.variable(0x2001, {.value = {1}});
  ObjectDictionary od(b.build(), 1);
  EXPECT_EQ(od.find(0x2000, 0).error(), AbortCode::no_sub_index);
  EXPECT_EQ(od.get<std::uint32_t>(0x2001, 0), 1U);
}

TEST(DictionaryDescription, UniformObject_HasOneValueForEachSubIndex) {
  DictionaryBuilder b;
  b.uniform(0xA100, ObjectCode::array, "words", 254, {.type = DataType::unsigned16, .value = {1, 2}});
  ObjectDictionary od(b.build(), 1);
  EXPECT_EQ(od.get<std::uint8_t>(0xA100, 0), 254);
  EXPECT_EQ(od.get<std::uint16_t>(0xA100, 254), 0x0201);
  od.set(0xA100, 2, std::uint16_t{9});
  EXPECT_EQ(od.get<std::uint16_t>(0xA100, 1), 0x0201);
  EXPECT_EQ(od.get<std::uint16_t>(0xA100, 2), 9);
  EXPECT_EQ(od.find(0xA100, 1)->offset + 2, od.find(0xA100, 2)->offset);
}

TEST(DictionaryDescription, ReplacingOneSubIndexOfAUniformObject_KeepsTheOthers) {
  DictionaryBuilder b;
  b.uniform(0x2000, ObjectCode::array, "words", 3, {.type = DataType::unsigned16, .value = {1}});
  b.sub(0x2000, 2, {.type = DataType::unsigned32, .value = {9}});
  ObjectDictionary od(b.build(), 1);
  EXPECT_EQ(od.get<std::uint8_t>(0x2000, 0), 3);
  EXPECT_EQ(od.get<std::uint16_t>(0x2000, 1), 1);
  EXPECT_EQ(od.get<std::uint32_t>(0x2000, 2), 9U);
  EXPECT_EQ(od.get<std::uint16_t>(0x2000, 3), 1);
}

TEST(DictionaryDescription, NodeId_IsAddedToTheDefaultsThatAskForIt) {
  DictionaryBuilder b;
  b.variable(0x1014, {.value = little_endian(0x80, 4), .adds_node_id = true});
  b.variable(0x2000, {.value = little_endian(0x180, 4), .adds_node_id = true});
  ObjectDictionary od(b.build(), 0x7F);
  EXPECT_EQ(od.get<std::uint32_t>(0x1014, 0), 0xFFU);
  EXPECT_EQ(od.get<std::uint32_t>(0x2000, 0), 0x1FFU);
  od.reset_communication(1);
  EXPECT_EQ(od.get<std::uint32_t>(0x1014, 0), 0x81U);
  EXPECT_EQ(od.get<std::uint32_t>(0x2000, 0), 0x1FFU);
  od.reset(2);
  EXPECT_EQ(od.get<std::uint32_t>(0x2000, 0), 0x182U);
}

TEST(DictionaryDescription, AddedAgain_ReplacesTheEarlierOne) {
  DictionaryBuilder b;
  b.variable(0x2000, {.type = DataType::unsigned8, .value = {1}});
  b.variable(0x2000, {.type = DataType::unsigned16, .value = {2}});
  ObjectDictionary od(b.build(), 1);
  EXPECT_EQ(od.find(0x2000, 0)->description->length, 2);
}

TEST(ObjectDictionary, SignedValuesOfOddLengths_AreExtended) {
  DictionaryBuilder b;
  b.variable(0x2000, {.type = DataType::integer24, .value = {0xFE, 0xFF, 0xFF}});
  b.variable(0x2001, {.type = DataType::integer56});
  ObjectDictionary od(b.build(), 1);
  EXPECT_EQ(od.get<std::int32_t>(0x2000, 0), -2);
  EXPECT_EQ(od.get<std::uint32_t>(0x2000, 0), 0xFFFFFEU);
  od.set(0x2001, 0, std::int64_t{-5});
  EXPECT_EQ(od.get<std::int64_t>(0x2001, 0), -5);
}

TEST(ObjectDictionary, RealValues_HaveLimits) {
  DictionaryBuilder b;
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v); };
  b.variable(0x2000, {.type = DataType::real32, .limits = {.low = bits(-1.5), .high = bits(2.5)}});
  ObjectDictionary od(b.build(), 1);
  const auto write = [&](float value) {
    return od.write(0x2000, 0, little_endian(std::bit_cast<std::uint32_t>(value), 4), {});
  };
  EXPECT_EQ(write(2.5F), AbortCode::none);
  EXPECT_EQ(od.get<float>(0x2000, 0), 2.5F);
  EXPECT_EQ(write(2.75F), AbortCode::value_too_high);
  EXPECT_EQ(write(-1.75F), AbortCode::value_too_low);
}

TEST(ObjectDictionary, Booleans_AreZeroOrOne) {
  DictionaryBuilder b;
  b.variable(0x2000, {.type = DataType::boolean});
  ObjectDictionary od(b.build(), 1);
  EXPECT_EQ(od.write(0x2000, 0, Bytes{1}, {}), AbortCode::none);
  EXPECT_EQ(od.write(0x2000, 0, Bytes{2}, {}), AbortCode::value_too_high);
}

TEST(ObjectDictionary, Strings_KeepTheirDefaultUntilWritten) {
  DictionaryBuilder b;
  b.variable(0x1008, {.type = DataType::visible_string, .value = text("old")});
  const auto description = b.build();
  ObjectDictionary first(description, 1);
  ObjectDictionary second(description, 2);
  EXPECT_EQ(first.write(0x1008, 0, text("a longer one"), {}), AbortCode::none);
  const auto value = first.read(0x1008, 0, {});
  EXPECT_EQ(Bytes(value->begin(), value->end()), text("a longer one"));
  const auto other = second.read(0x1008, 0, {});
  EXPECT_EQ(Bytes(other->begin(), other->end()), text("old"));
  first.reset_communication(1);
  const auto again = first.read(0x1008, 0, {});
  EXPECT_EQ(Bytes(again->begin(), again->end()), text("old"));
}

struct Handler : ObjectHandler, WriteObserver {
  AbortCode before_read(ObjectDictionary& d, const Entry& e, can::Time) override {
    d.set(e, ++reads);
    return reads < 3 ? AbortCode::none : AbortCode::hardware_error;
  }
  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t> v,
                         can::Time) override {
    return v[0] == 13 ? AbortCode::local_control : AbortCode::none;
  }
  void after_write(ObjectDictionary&, const Entry&, can::Time) override { ++writes; }
  void object_written(const Entry& entry, can::Time) override { observed = entry.index; }
  std::uint8_t reads = 0;
  int writes = 0;
  int observed = 0;
};

TEST(ObjectDictionary, Handler_IsAskedBeforeAndToldAfter) {
  DictionaryBuilder b;
  b.variable(0x2000, {.type = DataType::unsigned8});
  b.variable(0x2001, {.type = DataType::unsigned8});
  NodeDictionary od(b.build(), 1);
  Handler handler;
  od.attach(0x2000, 0x2000, handler);
  od.set_write_observer(&handler);
  EXPECT_EQ(od.read(0x2000, 0, {})->front(), 1);
  EXPECT_EQ(od.read(0x2000, 0, {})->front(), 2);
  EXPECT_EQ(od.read(0x2000, 0, {}).error(), AbortCode::hardware_error);
  EXPECT_EQ(od.write(0x2000, 0, Bytes{13}, {}), AbortCode::local_control);
  EXPECT_EQ(handler.writes, 0);
  EXPECT_EQ(handler.observed, 0);
  EXPECT_EQ(od.write(0x2000, 0, Bytes{14}, {}), AbortCode::none);
  EXPECT_EQ(handler.writes, 1);
  EXPECT_EQ(handler.observed, 0x2000);
  EXPECT_EQ(od.write(0x2001, 0, Bytes{13}, {}), AbortCode::none);
  EXPECT_EQ(handler.writes, 1);
}

constexpr std::uint32_t multiplexer(std::uint16_t index, std::uint8_t sub) {
  return std::uint32_t{index} << 8 | std::uint32_t{sub} << 24;
}

// The second call of each finds what the first one remembered.
TEST(ObjectDictionary, ReadShort_GivesPresentValuesOfUpToFourBytes_AsOftenAsAsked) {
  DictionaryBuilder b;
  b.uniform(0x2000, ObjectCode::array, "words", 200, {.type = DataType::unsigned16});
  b.variable(0x2001, {.value = {1, 2, 3, 4}});
  b.variable(0x2002, {.type = DataType::unsigned64});
  b.variable(0x2003, {.type = DataType::visible_string, .value = {'a'}});
  b.variable(0x2004, {.access = Access::write_only});
  b.variable(0x2005, {.type = DataType::unsigned24, .value = {1, 2, 3}});
  ObjectDictionary od(b.build(), 1);
  for (unsigned turn = 0; turn < 3; ++turn) {
    for (std::uint16_t value = 7; value < 9; ++value) {
      od.set(0x2000, 200, value);
      EXPECT_EQ(od.read_short(multiplexer(0x2000, 200)).number, value);
      EXPECT_EQ(od.read_short(multiplexer(0x2000, 200)).length, 2);
    }
    EXPECT_EQ(od.read_short(multiplexer(0x2001, 0)).number, 0x04030201U);
    EXPECT_EQ(od.read_short(multiplexer(0x2005, 0)).number, 0x030201U);
    EXPECT_EQ(od.read_short(multiplexer(0x2005, 0)).length, 3);
    for (const std::uint32_t other :
         {multiplexer(0x2000, 201), multiplexer(0x2001, 1), multiplexer(0x2002, 0), multiplexer(0x2003, 0),
          multiplexer(0x2004, 0), multiplexer(0x2999, 0), multiplexer(0xFFFF, 0xFF), multiplexer(0, 0)}) {
      EXPECT_EQ(od.read_short(other).length, 0) << std::hex << other;
    }
  }
}

TEST(ObjectDictionary, ReadShort_LeavesObjectsWithAHandlerToIt_AlsoOneThatCameLater) {
  DictionaryBuilder b;
  b.variable(0x2001, {.value = {1, 2, 3, 4}});
  NodeDictionary od(b.build(), 1);
  EXPECT_EQ(od.read_short(multiplexer(0x2001, 0)).length, 4);
  struct Silent final : ObjectHandler {
  } handler;
  od.attach(0x2001, 0x2001, handler);
  EXPECT_EQ(od.read_short(multiplexer(0x2001, 0)).length, 0);
}

TEST(IdentifierTable, WhatNoFrameCanHave_IsNotFound) {
  IdentifierTable table;
  EXPECT_EQ(table.first(0xFFFF'FFFF), nullptr);
  table.build(std::vector<IdentifierTable::Route>{{0x181, ServiceKind::rpdo, 3}});
  EXPECT_EQ(table.first(0xFFFF'FFFF), nullptr);
  ASSERT_NE(table.first(0x181), nullptr);
  EXPECT_EQ(table.first(0x181)->number, 3);
}

TEST(IdentifierTable, ALargeOne_FindsEveryRoute_AlsoWhereIdentifiersEndAlike) {
  const auto base = [](std::uint32_t i) { return IdentifierTable::key(0x100 + i, false, false); };
  const auto base_and_remote = [](std::uint32_t i) {
    return IdentifierTable::key(0x100 + i / 2, false, i % 2 != 0);
  };
  const auto ends_alike = [](std::uint32_t i) { return IdentifierTable::key(i << 11 | 0x123, true, false); };
  const auto mixed = [&](std::uint32_t i) { return i % 3 == 0 ? ends_alike(i) : base(i); };
  constexpr std::uint32_t none = 1'700;
  for (const std::uint32_t count : {254U, 600U, 1'500U}) {
    for (const auto& key_of :
         {std::function<std::uint32_t(std::uint32_t)>(base), {base_and_remote}, {ends_alike}, {mixed}}) {
      std::vector<IdentifierTable::Route> routes;
      for (std::uint32_t i = 0; i < count; ++i)
        routes.push_back({key_of(i), ServiceKind::rpdo, static_cast<std::uint16_t>(i)});
      IdentifierTable table;
      table.build(routes);
      for (std::uint32_t i = 0; i < count; ++i) {
        const IdentifierTable::Slot* const found = table.first(key_of(i));
        ASSERT_NE(found, nullptr) << i;
        EXPECT_EQ(found->number, i);
        EXPECT_EQ(found->found, ServiceKind::rpdo);
      }
      EXPECT_EQ(table.first(key_of(none)), nullptr);
    }
  }
}

TEST(CobIds, RestrictedIdentifiers_AreThoseOfCia301) {
  const auto restricted = [](std::uint32_t id) {
    return id == 0 || (id >= 0x001 && id <= 0x07F) || (id >= 0x101 && id <= 0x180) ||
           (id >= 0x581 && id <= 0x5FF) || (id >= 0x601 && id <= 0x67F) || (id >= 0x6E0 && id <= 0x6FF) ||
           (id >= 0x701 && id <= 0x77F) || (id >= 0x780 && id <= 0x7FF);
  };
  for (std::uint32_t id = 0; id <= 0x7FF; ++id) EXPECT_EQ(is_restricted_identifier(id), restricted(id)) << id;
}

RC_GTEST_PROP(TimerQueue, TimersComeInOrderOfDeadline, (const std::vector<std::uint8_t>& moves)) {
  can::Alarm alarm;
  TimerQueue queue(alarm);
  constexpr std::size_t count = 12;
  RC_ASSERT(queue.add(count) == 0U);
  std::vector<can::Time> expected(count, can::never);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const auto number = static_cast<TimerQueue::Number>(moves[i] % count);
    const can::Time deadline = moves[i] % 7 == 0
                                   ? can::never
                                   : can::Time(can::Duration(moves[i] * 31 % 50 + static_cast<int>(i) % 5));
    queue.set(number, deadline);
    expected[number] = deadline;
    RC_ASSERT(queue.next() == *std::ranges::min_element(expected));
    RC_ASSERT(alarm.deadline() == queue.next());
  }
  while (queue.next() != can::never) {
    const auto earliest = std::ranges::min_element(expected);  // the first of equals
    RC_ASSERT(queue.pop() == static_cast<TimerQueue::Number>(earliest - expected.begin()));
    *earliest = can::never;
  }
  RC_ASSERT(std::ranges::all_of(expected, [](can::Time t) { return t == can::never; }));
}

RC_GTEST_PROP(IdentifierTable, EveryRouteIsFoundAndNoOther, (const std::vector<std::uint16_t>& ids)) {
  std::vector<IdentifierTable::Route> routes;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    routes.push_back({ids[i] & 0x7FFU, ServiceKind::rpdo, static_cast<std::uint16_t>(i)});
  }
  IdentifierTable table;
  table.build(routes);
  for (std::uint32_t id = 0; id <= 0x7FF; ++id) {
    std::vector<std::uint16_t> found;
    table.for_each(id, [&](ServiceKind, std::uint16_t number) { found.push_back(number); });
    std::vector<std::uint16_t> expected;
    for (const auto& route : routes) {
      if (route.key == id) expected.push_back(route.number);
    }
    RC_ASSERT(found == expected);
  }
}

}  // namespace
}  // namespace canopus::canopen::object_dictionary_test
