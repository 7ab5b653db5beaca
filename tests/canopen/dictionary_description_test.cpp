// What nodes of one kind share: how objects are found, and how descriptions that differ in defaults stay one.

#include "canopus/canopen/dictionary/dictionary_description.hpp"

#include <set>
#include <string>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/node/node.hpp"

namespace canopus::canopen::dictionary_description_test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::ElementsAre;

DictionaryBuilder some_objects() {
  DictionaryBuilder builder;
  builder.variable(0x1008, {.name = "Name", .type = DataType::visible_string, .value = text("pump")});
  builder.variable(0x1014, {.name = "COB-ID EMCY", .value = {0x80}, .adds_node_id = true});
  builder.variable(0x1017, {.name = "Heartbeat", .type = DataType::unsigned16, .value = {1, 2}});
  builder.variable(0x2000, {.name = "Speed", .value = {1, 2, 3, 4}});
  builder.variable(0x2001, {.name = "Title", .type = DataType::visible_string, .value = text("old")});
  return builder;
}

Bytes bytes_of(const ObjectDictionary& dictionary, std::uint16_t index) {
  const auto bytes = dictionary.bytes(*dictionary.find(index, 0));
  return {bytes.begin(), bytes.end()};
}

RC_GTEST_PROP(DictionaryDescription, FindsWhatThereIs_AndNothingElse, ()) {
  const auto indexes = *rc::gen::container<std::set<std::uint16_t>>(rc::gen::arbitrary<std::uint16_t>());
  DictionaryBuilder builder;
  for (const std::uint16_t index : indexes) builder.variable(index, {.name = std::to_string(index)});
  const auto description = builder.build();
  std::size_t position = 0;
  for (unsigned index = 0; index <= 0xFFFF; ++index) {
    const ObjectDescription* const object = description->find(static_cast<std::uint16_t>(index));
    RC_ASSERT((object != nullptr) == indexes.contains(static_cast<std::uint16_t>(index)));
    if (object == nullptr) continue;
    RC_ASSERT(object->index == index);
    RC_ASSERT(description->name(*object) == std::to_string(index));
    RC_ASSERT(description->position(*object) == position++);
  }
}

TEST(DictionaryDescription, FindsEveryOneOfManyThousand) {
  DictionaryBuilder builder;
  for (unsigned index = 0x1400; index < 0x5400; ++index)
    builder.variable(static_cast<std::uint16_t>(index), {});
  const auto description = builder.build();
  for (unsigned index = 0; index <= 0xFFFF; ++index) {
    const auto* const object = description->find(static_cast<std::uint16_t>(index));
    ASSERT_EQ(object != nullptr, index >= 0x1400 && index < 0x5400) << index;
  }
}

TEST(DictionaryDescription, WithOtherDefaults_SharesEverythingElse) {
  const auto base = some_objects().build();
  const DictionaryDescription::Change changes[] = {{base->find(0x2000, 0), {9, 8, 7, 6}},
                                                   {base->find(0x2001, 0), text("a longer title")},
                                                   {base->find(0x1014, 0), {0x85, 0, 0, 0}}};
  const auto other = base->with(changes);
  EXPECT_EQ(other->find(0x2000), base->find(0x2000));
  EXPECT_EQ(other->find(0x2000, 0).description, base->find(0x2000, 0).description);
  EXPECT_EQ(other->name(other->find(0x2000, 0)).data(), base->name(base->find(0x2000, 0)).data());

  const ObjectDictionary before(base, 3);
  const ObjectDictionary after(other, 3);
  EXPECT_THAT(bytes_of(before, 0x2000), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(bytes_of(after, 0x2000), ElementsAre(9, 8, 7, 6));
  EXPECT_EQ(bytes_of(before, 0x2001), text("old"));
  EXPECT_EQ(bytes_of(after, 0x2001), text("a longer title"));
  EXPECT_THAT(bytes_of(before, 0x1014), ElementsAre(0x83, 0, 0, 0));
  EXPECT_THAT(bytes_of(after, 0x1014), ElementsAre(0x85, 0, 0, 0)) << "the node-ID is not added to it";
  EXPECT_THAT(bytes_of(after, 0x1017), ElementsAre(1, 2));
  EXPECT_EQ(bytes_of(after, 0x1008), text("pump"));
}

TEST(DictionaryDescription, WithOtherDefaultsTwice_TheLastOneCounts) {
  const auto base = some_objects().build();
  const DictionaryDescription::Change first[] = {{base->find(0x2000, 0), {9, 0, 0, 0}},
                                                 {base->find(0x1017, 0), {5, 0}}};
  const DictionaryDescription::Change second[] = {{base->find(0x2000, 0), {10, 0, 0, 0}},
                                                  {base->find(0x2000, 0), {11, 0, 0, 0}}};
  const ObjectDictionary dictionary(base->with(first)->with(second), 1);
  EXPECT_EQ(dictionary.get<std::uint32_t>(0x2000, 0), 11U);
  EXPECT_EQ(dictionary.get<std::uint16_t>(0x1017, 0), 5);
}

TEST(DictionaryDescription, OtherDefaults_ComeBackWithEachReset_OfTheirPart) {
  const auto base = some_objects().build();
  const DictionaryDescription::Change changes[] = {{base->find(0x2000, 0), {9, 0, 0, 0}},
                                                   {base->find(0x1017, 0), {5, 0}}};
  ObjectDictionary dictionary(base->with(changes), 1);
  dictionary.set(0x2000, 0, 1U);
  dictionary.set(0x1017, 0, std::uint16_t{1});
  dictionary.reset_communication(1);
  EXPECT_EQ(dictionary.get<std::uint32_t>(0x2000, 0), 1U);
  EXPECT_EQ(dictionary.get<std::uint16_t>(0x1017, 0), 5);
  dictionary.reset(1);
  EXPECT_EQ(dictionary.get<std::uint32_t>(0x2000, 0), 9U);
}

TEST(DictionaryDescription, OneDefault_IsWhatABlockOfAllHas) {
  DictionaryBuilder builder = some_objects();
  builder.uniform(0x2100, ObjectCode::array, "Words", 3,
                  {.type = DataType::unsigned16, .value = {0xFF, 0xFF}, .adds_node_id = true});
  builder.variable(0x2200, {.type = DataType::unsigned24, .value = {1, 2, 3}});
  const auto base = builder.build();
  const DictionaryDescription::Change changes[] = {{base->find(0x2100, 2), {7, 0}}};
  for (const auto& description : {base, base->with(changes)}) {
    const ObjectDictionary dictionary(description, 0x7F);
    for (const ObjectDescription& object : description->objects()) {
      for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
        const Entry entry = description->find(object, static_cast<std::uint8_t>(sub));
        const auto expected = entry.description->length != 0 ? dictionary.get<std::uint64_t>(entry) : 0;
        EXPECT_EQ(description->default_value(entry, 0x7F), expected) << object.index << ":" << sub;
      }
    }
  }
}

TEST(DictionaryDescription, RefusesAWriteAsADictionaryDoes) {
  DictionaryBuilder builder;
  builder.variable(0x2000, {.type = DataType::unsigned8, .access = Access::read_only});
  builder.variable(0x2001, {.type = DataType::boolean});
  builder.variable(0x2002, {.type = DataType::integer16, .limits = {.low = ~std::uint64_t{9}, .high = 5}});
  const auto description = builder.build();
  const auto check = [&](std::uint16_t index, const Bytes& value) {
    return description->check_write(description->find(index, 0), value);
  };
  EXPECT_EQ(check(0x2000, {1}), AbortCode::write_of_read_only);
  EXPECT_EQ(check(0x2001, {2}), AbortCode::value_too_high);
  EXPECT_EQ(check(0x2001, {1}), AbortCode::none);
  EXPECT_EQ(check(0x2002, {0xF6, 0xFF}), AbortCode::none);
  EXPECT_EQ(check(0x2002, {0xF5, 0xFF}), AbortCode::value_too_low);
  EXPECT_EQ(check(0x2002, {6, 0}), AbortCode::value_too_high);
  EXPECT_EQ(check(0x2002, {6}), AbortCode::length_too_low);
  EXPECT_EQ(check(0x2002, {6, 0, 0}), AbortCode::length_too_high);
}

struct CountingObserver final : WriteObserver {
  void object_written(const Entry&, can::Time) override { ++written; }
  int written = 0;
};

// Whatever the object: what the short way does not take, it leaves as it was.
TEST(ObjectDictionary, TheShortWayOfAWrite_DoesTheSameAsTheLongOne_OrNothing) {
  struct Refusing final : ObjectHandler {
    AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>,
                           can::Time) override {
      return AbortCode::general;
    }
  } handler;
  DictionaryBuilder builder;
  const DataType types[] = {DataType::boolean,    DataType::unsigned8,  DataType::integer16,
                            DataType::unsigned24, DataType::unsigned32, DataType::unsigned64,
                            DataType::real32,     DataType::domain};
  const Access accesses[] = {Access::read_only, Access::write_only, Access::read_write, Access::constant,
                             Access::read_write_output};
  std::uint16_t index = 0x2000;
  for (const DataType type : types) {
    for (const Access access : accesses) {
      builder.variable(index++, {.type = type, .access = access});
      builder.uniform(index++, ObjectCode::array, "alike", 3, {.type = type, .access = access});
      builder.variable(index++, {.type = type, .access = access, .limits = {.low = {}, .high = 3}});
      builder.variable(index++, {.type = type, .access = access});
    }
  }
  const auto description = builder.build();
  unsigned short_ones = 0;
  for (std::uint16_t object = 0x1FFF; object <= index; ++object) {
    for (std::uint8_t sub = 0; sub <= 4; ++sub) {
      for (std::uint8_t length = 0; length <= 4; ++length) {
        NodeDictionary brief(description, 1);
        NodeDictionary full(description, 1);
        CountingObserver brief_observer;
        CountingObserver full_observer;
        brief.set_write_observer(&brief_observer);
        full.set_write_observer(&full_observer);
        for (NodeDictionary* dictionary : {&brief, &full}) {
          for (std::uint16_t i = 0x2003; i < index; i = static_cast<std::uint16_t>(i + 4))
            dictionary->attach(i, i, handler);
        }
        const std::uint32_t number = 0x81828382 & (length == 0 ? 0 : ~0U >> (32 - 8 * length));
        const bool taken =
            brief.write_short(std::uint32_t{object} << 8 | std::uint32_t{sub} << 24, {number, length}, {});
        if (!taken) {
          EXPECT_EQ(brief_observer.written, 0);
          const ObjectDictionary untouched(description, 1);
          EXPECT_TRUE(std::ranges::equal(brief.block(), untouched.block()));
          continue;
        }
        ++short_ones;
        EXPECT_EQ(full.write(object, sub, can::little_endian(number, length), {}), AbortCode::none);
        EXPECT_EQ(brief_observer.written, full_observer.written);
        EXPECT_TRUE(std::ranges::equal(brief.block(), full.block())) << object << ":" << int{sub};
      }
    }
  }
  // 5 types of 1 to 4 bytes without BOOLEAN, 3 accesses: a VAR, and three members of an array
  EXPECT_EQ(short_ones, 5U * 3U * 4U);
}

TEST(Node, ListsTheIdentifiersThatItWants) {
  struct Nowhere final : can::Sink {
    bool send(const can::Frame&) override { return true; }
  } nowhere;
  DictionaryBuilder builder;
  builder.variable(0x1005, {.value = {0x80}});
  builder.sub(0x1400, 1, {.value = {0x85, 0x03}}).sub(0x1400, 2, {.type = DataType::unsigned8, .value = {1}});
  builder.sub(0x1401, 1, {.value = {0x86, 0x03, 0x00, 0x20}});  // a 29-bit identifier is none of them
  builder.sub(0x1800, 1, {.value = {0x85, 0x01}})
      .sub(0x1800, 2, {.type = DataType::unsigned8, .value = {0xFE}});
  builder.sub(0x1A00, 1, {.value = {0x20, 0x00, 0x00, 0x20}})
      .sub(0x1A00, 0, {.type = DataType::unsigned8, .value = {1}});
  builder.variable(0x2000, {.tpdo_mappable = true});
  Node node(builder.build(), 5, nowhere);
  EXPECT_THAT(node.wanted_identifiers(), testing::IsEmpty());
  node.power_on({});
  EXPECT_THAT(node.wanted_identifiers(), ElementsAre(0x000, 0x080, 0x185, 0x385, 0x605, 0x705));
  std::vector<std::uint32_t> asked;
  for (std::uint32_t identifier = 0; identifier <= can::max_base_identifier; ++identifier) {
    if (node.wants(identifier)) asked.push_back(identifier);
  }
  EXPECT_EQ(node.wanted_identifiers(), asked);
}

}  // namespace
}  // namespace canopus::canopen::dictionary_description_test
