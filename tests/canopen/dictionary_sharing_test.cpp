// Sub-indexes that are described alike have one description. Whatever is shared, each has its own value, name, limits
// and default.

#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/dictionary/object_dictionary.hpp"

namespace canopus::canopen::dictionary_sharing_test {
namespace {

constexpr DataType types[] = {DataType::unsigned8,  DataType::unsigned16, DataType::unsigned32,
                              DataType::unsigned64, DataType::unsigned24, DataType::visible_string};
constexpr const char* names[] = {"", "COB-ID", "Type", "Highest sub-index supported"};

/// One of few kinds, so that many objects are alike.
EntrySpec any_spec() {
  EntrySpec spec{.name = *rc::gen::elementOf(std::vector<std::string>(std::begin(names), std::end(names))),
                 .type = types[*rc::gen::inRange<std::size_t>(0, std::size(types))]};
  const auto kind = *rc::gen::inRange(0, 6);
  if (kind == 0) spec.access = Access::read_only;
  if (kind == 1) spec.limits = {.low = 1, .high = 5};
  if (kind == 2) spec.limits = {.low = {}, .high = 5};
  spec.stored = kind == 3;
  spec.adds_node_id = kind == 4 && byte_length(spec.type) != 0;
  const std::size_t length = spec.type == DataType::visible_string ? 3 : byte_length(spec.type);
  for (std::size_t i = 0; i < length; ++i) spec.value.push_back(*rc::gen::inRange<std::uint8_t>(0, 200));
  return spec;
}

using Place = std::pair<std::uint16_t, std::uint8_t>;

RC_GTEST_PROP(DictionarySharing, EverySubIndexIsAsItWasDescribed, ()) {
  DictionaryBuilder builder;
  std::map<Place, EntrySpec> described;
  std::map<std::uint16_t, std::string> object_names;
  std::uint16_t index = 0x1FF0;  // over the end of the communication profile
  const int objects = *rc::gen::inRange(1, 40);
  for (int i = 0; i < objects; ++i, ++index) {
    object_names[index] = names[*rc::gen::inRange<std::size_t>(0, std::size(names))];
    const auto form = *rc::gen::inRange(0, 3);
    if (form == 0) {
      EntrySpec spec = any_spec();
      object_names[index] = spec.name;
      builder.variable(index, spec);
      described[{index, std::uint8_t{0}}] = spec;
    } else if (form == 1) {
      const EntrySpec spec = any_spec();
      const auto count = *rc::gen::inRange<std::uint8_t>(1, 5);
      builder.uniform(index, ObjectCode::array, object_names[index], count, spec);
      for (std::uint8_t sub = 1; sub <= count; ++sub) described[{index, sub}] = spec;
    } else {
      builder.object(index, ObjectCode::record, object_names[index]);
      for (const std::uint8_t sub :
           *rc::gen::container<std::set<std::uint8_t>>(rc::gen::inRange<std::uint8_t>(0, 6))) {
        const EntrySpec spec = any_spec();
        builder.sub(index, sub, spec);
        described[{index, sub}] = spec;
      }
    }
  }
  const auto description = builder.build();
  constexpr std::uint8_t node_id = 3;
  ObjectDictionary dictionary(description, node_id);
  bool any_stored = false;
  for (const auto& [object, name] : object_names)
    RC_ASSERT(description->name(*description->find(object)) == name);
  for (const auto& [place, spec] : described) {
    const Entry entry = description->find(place.first, place.second);
    RC_ASSERT(static_cast<bool>(entry));
    RC_ASSERT(description->name(entry) == spec.name);
    RC_ASSERT(entry.description->type == spec.type);
    RC_ASSERT(entry.description->access == spec.access);
    RC_ASSERT(entry.description->stored == spec.stored);
    RC_ASSERT(description->limits(entry) == spec.limits);
    any_stored = any_stored || spec.stored;
    if (spec.type == DataType::visible_string) {
      RC_ASSERT(std::ranges::equal(dictionary.bytes(entry), spec.value));
    } else {
      const unsigned unused = 64U - 8U * byte_length(spec.type);
      const std::uint64_t value =
          can::load_value(spec.value.data(), static_cast<unsigned>(spec.value.size()));
      const std::uint64_t expected = (value + (spec.adds_node_id ? node_id : 0)) << unused >> unused;
      RC_ASSERT(dictionary.get<std::uint64_t>(entry) == expected);
      RC_ASSERT(description->default_value(entry, node_id) == expected);
      const unsigned length = byte_length(spec.type);
      if (length == 2 || length == 4 || length == 8) RC_ASSERT(entry.offset % length == 0U);
    }
  }
  RC_ASSERT(description->marks_stored() == any_stored);
  // Each has a place of its own: all are written, then all are read.
  std::uint8_t mark = 0;
  for (const auto& [place, spec] : described) {
    const std::size_t length = spec.type == DataType::visible_string ? 2 : byte_length(spec.type);
    dictionary.assign(description->find(place.first, place.second),
                      std::vector<std::uint8_t>(length, ++mark));
  }
  mark = 0;
  for (const auto& [place, spec] : described) {
    const std::size_t length = spec.type == DataType::visible_string ? 2 : byte_length(spec.type);
    const auto bytes = dictionary.bytes(description->find(place.first, place.second));
    RC_ASSERT(std::ranges::equal(bytes, std::vector<std::uint8_t>(length, ++mark)));
  }
  // What is not described is not there.
  for (const auto& [object, name] : object_names) {
    for (unsigned sub = 1; sub <= 7; ++sub) {
      const auto number = static_cast<std::uint8_t>(sub);
      RC_ASSERT(static_cast<bool>(description->find(object, number)) == described.contains({object, number}));
    }
  }
}

TEST(DictionarySharing, ObjectsThatAreAlike_HaveOneDescription_AndPlacesOfTheirOwn) {
  DictionaryBuilder builder;
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
    const auto index = static_cast<std::uint16_t>(0x1400 + pdo);
    builder.object(index, ObjectCode::record, "RPDO " + std::to_string(pdo));
    builder.sub(index, 1, {.name = "COB-ID", .value = {static_cast<std::uint8_t>(pdo)}});
    builder.sub(index, 2, {.name = "Type", .type = DataType::unsigned8});
  }
  builder.variable(0x2000, {.name = "Speed"}).variable(0x2001, {.name = "Current"});
  const auto description = builder.build();
  ObjectDictionary dictionary(description, 1);
  for (std::uint16_t pdo = 1; pdo < 4; ++pdo) {
    const Entry first = description->find(0x1400, 1);
    const Entry entry = description->find(static_cast<std::uint16_t>(0x1400 + pdo), 1);
    EXPECT_EQ(entry.description, first.description);
    EXPECT_NE(entry.offset, first.offset);
    EXPECT_EQ(dictionary.get<std::uint32_t>(entry), pdo);
  }
  EXPECT_EQ(description->find(0x2000, 0).description, description->find(0x2001, 0).description);
  EXPECT_EQ(description->name(description->find(0x2000, 0)), "Speed");
  EXPECT_EQ(description->name(description->find(0x2001, 0)), "Current");
}

TEST(DictionarySharing, NamesOfAnyLength) {
  DictionaryBuilder builder;
  const std::size_t lengths[] = {0, 1, 127, 128, 16'383, 16'384, 100'000};
  std::uint16_t index = 0x2000;
  for (const std::size_t length : lengths) {
    builder.object(index, ObjectCode::record, std::string(length, 'o'));
    builder.sub(index, 1, {.name = std::string(length, 'e')});
    ++index;
  }
  const auto description = builder.build();
  index = 0x2000;
  for (const std::size_t length : lengths) {
    EXPECT_EQ(description->name(*description->find(index)), std::string(length, 'o'));
    EXPECT_EQ(description->name(description->find(index, 1)), std::string(length, 'e'));
    ++index;
  }
}

TEST(DictionarySharing, ObjectsOfARange) {
  DictionaryBuilder builder;
  constexpr std::uint16_t indexes[] = {0x1000, 0x1400, 0x1401, 0x15FF, 0x1600, 0xFFFF};
  for (const std::uint16_t index : indexes) builder.variable(index, {});
  const auto description = builder.build();
  const auto range = [&](std::uint16_t first, std::uint16_t last) {
    std::vector<unsigned> found;
    for (const ObjectDescription& object : description->objects(first, last)) found.push_back(object.index);
    return found;
  };
  using Indexes = std::vector<unsigned>;
  EXPECT_EQ(range(0x1400, 0x15FF), (Indexes{0x1400, 0x1401, 0x15FF}));
  EXPECT_EQ(range(0, 0xFFFF).size(), 6U);
  EXPECT_EQ(range(0x1601, 0xFFFE), Indexes{});
  EXPECT_EQ(range(0xFFFF, 0xFFFF), Indexes{0xFFFF});
}

}  // namespace
}  // namespace canopus::canopen::dictionary_sharing_test
