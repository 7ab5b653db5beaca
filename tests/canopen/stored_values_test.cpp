// The bytes of stored values, written by hand: index, sub-index, length and value, little-endian.

#include "canopus/canopen/dictionary/stored_values.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::canopen::stored_values_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

bool any(const Entry&) { return true; }

std::shared_ptr<const DictionaryDescription> description() {
  DictionaryBuilder builder;
  builder.variable(0x1006, {.name = "period", .type = DataType::unsigned32});
  builder.variable(0x1017, {.name = "heartbeat", .type = DataType::unsigned16});
  builder.variable(0x2000, {.name = "text", .type = DataType::octet_string});
  return builder.build();
}

TEST(StoredValues, AreIndexSubLengthAndValue) {
  Bytes image;
  append_stored_value(image, StoredLength::two_bytes, 0x1017, 0, Bytes{0xE8, 0x03});
  append_stored_value(image, StoredLength::two_bytes, 0x2000, 5, {});
  EXPECT_EQ(image, (Bytes{0x17, 0x10, 0x00, 0x02, 0x00, 0xE8, 0x03, 0x00, 0x20, 0x05, 0x00, 0x00}));
  StoredValueReader reader(image, StoredLength::two_bytes);
  const auto first = reader.next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->index, 0x1017);
  EXPECT_EQ(first->sub, 0);
  EXPECT_EQ(Bytes(first->bytes.begin(), first->bytes.end()), (Bytes{0xE8, 0x03}));
  const auto second = reader.next();
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ(second->index, 0x2000);
  EXPECT_EQ(second->sub, 5);
  EXPECT_TRUE(second->bytes.empty());
  EXPECT_FALSE(reader.next());
  EXPECT_TRUE(reader.intact());
}

TEST(StoredValues, LengthInFourBytes) {
  Bytes image;
  append_stored_value(image, StoredLength::four_bytes, 0x1017, 0, Bytes{0xE8, 0x03});
  append_stored_value(image, StoredLength::four_bytes, 0x2000, 5, Bytes(65536, 0x5A));
  EXPECT_EQ(Bytes(image.begin(), image.begin() + 16),
            (Bytes{0x17, 0x10, 0x00, 0x02, 0x00, 0x00, 0x00, 0xE8, 0x03, 0x00, 0x20, 0x05, 0x00, 0x00, 0x01,
                   0x00}));
  EXPECT_TRUE(are_stored_values(image, StoredLength::four_bytes));
  image.pop_back();
  EXPECT_FALSE(are_stored_values(image, StoredLength::four_bytes));
  EXPECT_FALSE(are_stored_values(Bytes{0x17, 0x10, 0x00, 0xFF, 0xFF, 0xFF, 0xFF}, StoredLength::four_bytes));
}

TEST(StoredValues, LongestValue_HasALengthOf65535) {
  Bytes image;
  append_stored_value(image, StoredLength::two_bytes, 0x2000, 0,
                      Bytes(longest_stored_value(StoredLength::two_bytes), 0x5A));
  EXPECT_EQ(Bytes(image.begin(), image.begin() + 6), (Bytes{0x00, 0x20, 0x00, 0xFF, 0xFF, 0x5A}));
  EXPECT_TRUE(are_stored_values(image, StoredLength::two_bytes));
  image.pop_back();
  EXPECT_FALSE(are_stored_values(image, StoredLength::two_bytes));
}

struct StoredValuesApplied : testing::Test {
  bool apply(const Bytes& image, bool (*wanted)(const Entry&) = any) {
    return apply_stored_values(image, StoredLength::two_bytes, dictionary, wanted);
  }
  int heartbeat() { return dictionary.get<std::uint16_t>(0x1017, 0); }
  Bytes text() {
    const auto bytes = dictionary.bytes(dictionary.description().find(0x2000, 0));
    return {bytes.begin(), bytes.end()};
  }
  ObjectDictionary dictionary{description(), 1};
};

TEST_F(StoredValuesApplied, EachGoesToItsObject) {
  EXPECT_TRUE(apply({0x17, 0x10, 0x00, 0x02, 0x00, 0xE8, 0x03, 0x00, 0x20, 0x00, 0x03, 0x00, 1, 2, 3}));
  EXPECT_EQ(heartbeat(), 1000);
  EXPECT_EQ(text(), (Bytes{1, 2, 3}));
}

TEST_F(StoredValuesApplied, ObjectThatIsGone_IsLeftOut) {
  EXPECT_TRUE(apply({0x99, 0x10, 0x00, 0x01, 0x00, 0xE8, 0x17, 0x10, 0x00, 0x02, 0x00, 0xE8, 0x03}));
  EXPECT_EQ(heartbeat(), 1000);
}

TEST_F(StoredValuesApplied, ObjectThatIsNotWanted_IsLeftOut) {
  EXPECT_TRUE(apply({0x17, 0x10, 0x00, 0x02, 0x00, 0xE8, 0x03, 0x00, 0x20, 0x00, 0x01, 0x00, 7},
                    [](const Entry& entry) { return entry.index == 0x2000; }));
  EXPECT_EQ(heartbeat(), 0);
  EXPECT_EQ(text(), Bytes{7});
}

TEST_F(StoredValuesApplied, ValueOfAnotherLength_IsLeftOut_AndReported) {
  EXPECT_FALSE(apply({0x17, 0x10, 0x00, 0x01, 0x00, 0xE8, 0x00, 0x20, 0x00, 0x01, 0x00, 7}));
  EXPECT_EQ(heartbeat(), 0);
  EXPECT_EQ(text(), Bytes{7});
}

TEST_F(StoredValuesApplied, CutAnywhere_PutsNothingIn) {
  const Bytes whole{0x00, 0x20, 0x00, 0x01, 0x00, 7, 0x17, 0x10, 0x00, 0x02, 0x00, 0xE8, 0x03};
  for (std::size_t length = 1; length < whole.size(); ++length) {
    if (length == 6) continue;  // the first value alone
    EXPECT_FALSE(apply({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)})) << length;
    EXPECT_TRUE(text().empty()) << length;
  }
}

// Whatever the bytes are: an answer, never a crash.
RC_GTEST_PROP(StoredValuesProperty, AnyBytes_AreAnswered, (const Bytes& bytes)) {
  ObjectDictionary dictionary(description(), 1);
  for (const StoredLength form : {StoredLength::two_bytes, StoredLength::four_bytes}) {
    if (apply_stored_values(bytes, form, dictionary, any)) RC_ASSERT(are_stored_values(bytes, form));
  }
}

}  // namespace
}  // namespace canopus::canopen::stored_values_test
