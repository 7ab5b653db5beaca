#include "canopus/module/memory/buffer_memory.hpp"

#include <gtest/gtest.h>

namespace canopus::module::buffer_memory_test {
namespace {

constexpr Modes mode_a = 1;
constexpr Modes mode_b = 2;
constexpr std::array<std::uint16_t, 2> choices{10, 20};

// A map with everything a row can say. 0..3 are two words each, as on an FX module: FROM and TO reach
// different ones.
constexpr std::array table = std::to_array<BufferRow>({
    {0, 3, "received", WordAccess::read, 0},
    {0, 3, "to send", WordAccess::write, 7},
    {10, 10, "choice", WordAccess::read_write, 10, one_of(choices), Stored::yes},
    {11, 11, "signed", WordAccess::read_write, 0, between(-60, 60), Stored::yes, mode_a},
    {11, 11, "signed, other mode", WordAccess::read_write, 5, any_value, Stored::no, mode_b},
    {12, 12, "read only", WordAccess::read, 3},
    {20, 26, "blocks", WordAccess::read_write, 0xFFFF, any_value, Stored::yes, mode_a, "", 3, true},
    {21, 27, "blocks", WordAccess::read_write, 0, between(0, 8), Stored::no, mode_a, "", 3},
});

class BufferMemoryTest : public testing::Test {
 protected:
  BufferMemoryTest() { memory_.select_mode(mode_a); }
  WriteResult write(BufferAddress address, std::uint16_t value) { return memory_.write(address, value, {}); }
  std::uint16_t read(BufferAddress address) { return memory_.program_read(address, {}); }

  BufferMemory memory_{table};
};

TEST_F(BufferMemoryTest, FromAndToOfOneNumber_MayBeDifferentWords) {
  EXPECT_EQ(write(2, 0x1234), WriteResult::done);
  EXPECT_EQ(read(2), 0);
  EXPECT_EQ(memory_.written(2), 0x1234);
  memory_.set_word(2, 0x5678);
  EXPECT_EQ(read(2), 0x5678);
  EXPECT_EQ(memory_.written(2), 0x1234);
  EXPECT_EQ(memory_.written(3), 7);
}

TEST_F(BufferMemoryTest, OrdinaryWord_IsOneWord) {
  EXPECT_EQ(write(11, 5), WriteResult::done);
  EXPECT_EQ(read(11), 5);
  EXPECT_EQ(memory_.written(11), 5);
  memory_.set_word(11, 6);
  EXPECT_EQ(read(11), 6);
  EXPECT_EQ(memory_.written(11), 6);
}

TEST(ValueRangeTest, FromZeroOn_IsUnsigned_BelowZeroSigned) {
  for (const int good : {0, 1, 40'000}) {
    EXPECT_TRUE(between(0, 40'000).contains(static_cast<std::uint16_t>(good))) << good;
  }
  EXPECT_FALSE(between(0, 40'000).contains(40'001));
  EXPECT_TRUE(between(-60, 60).contains(0xFFC4));
  EXPECT_FALSE(between(-60, 60).contains(0xFFC3));
  EXPECT_FALSE(between(0, 60).contains(0xFFFF));
}

TEST_F(BufferMemoryTest, ValuesOutOfRange_AreInvalid_AndChangeNothing) {
  EXPECT_EQ(write(10, 20), WriteResult::done);
  EXPECT_EQ(write(10, 15), WriteResult::invalid);
  EXPECT_EQ(read(10), 20);
  EXPECT_EQ(write(11, 60), WriteResult::done);
  EXPECT_EQ(write(11, 0xFFC4), WriteResult::done);  // -60
  EXPECT_EQ(write(11, 61), WriteResult::invalid);
  EXPECT_EQ(write(11, 0xFFC3), WriteResult::invalid);
  EXPECT_EQ(read(11), 0xFFC4);
}

TEST_F(BufferMemoryTest, SystemAreaAndReadOnlyWords_IgnoreWrites) {
  for (const BufferAddress address : {4U, 9U, 12U, 13U, 22U, 25U, 28U, 1000U, 65535U}) {
    EXPECT_EQ(write(address, 1), WriteResult::ignored) << address;
  }
  EXPECT_EQ(read(12), 3);
  EXPECT_EQ(read(4), 0);
  EXPECT_EQ(read(65535), 0);
}

TEST_F(BufferMemoryTest, RepeatedBlocks_HaveARowPerKindOfWord) {
  for (const BufferAddress address : {20U, 23U, 26U}) EXPECT_EQ(read(address), 0xFFFF);
  for (const BufferAddress address : {21U, 24U, 27U}) {
    EXPECT_EQ(read(address), 0);
    EXPECT_EQ(write(address, 9), WriteResult::invalid);
    EXPECT_EQ(write(address, 8), WriteResult::done);
  }
}

TEST_F(BufferMemoryTest, ConfigurationWhileOnline_IsRefused) {
  memory_.set_online(true);
  EXPECT_EQ(write(23, 1), WriteResult::refused);
  EXPECT_EQ(read(23), 0xFFFF);
  EXPECT_EQ(write(24, 1), WriteResult::done);
  memory_.set_online(false);
  EXPECT_EQ(write(23, 1), WriteResult::done);
}

TEST_F(BufferMemoryTest, SelectingAMode_StartsAllWordsAnew) {
  write(10, 20);
  write(11, 9);
  memory_.select_mode(mode_b);
  EXPECT_EQ(read(10), 10);
  EXPECT_EQ(read(11), 5);
  EXPECT_EQ(write(11, 1000), WriteResult::done);
  EXPECT_EQ(read(20), 0);
  EXPECT_EQ(write(20, 1), WriteResult::ignored);
}

TEST_F(BufferMemoryTest, StoredWords_AreThoseOfTheMode_OthersAreKept) {
  StoredWords words{{11, 1}, {99, 2}};
  memory_.select_mode(mode_b);
  write(10, 20);
  memory_.collect_stored(words);
  EXPECT_EQ(words, (StoredWords{{10, 20}, {11, 1}, {99, 2}}));
  memory_.select_mode(mode_a);
  EXPECT_TRUE(memory_.apply_stored(words));
  EXPECT_EQ(read(10), 20);
  EXPECT_EQ(read(11), 1);
  memory_.restore_initial();
  EXPECT_EQ(read(10), 10);
  EXPECT_EQ(read(11), 0);
}

TEST_F(BufferMemoryTest, StoredValueThatNoWordAccepts_IsReported_AndNothingIsPutIn) {
  EXPECT_FALSE(memory_.apply_stored({{10, 11}, {11, 4}}));
  EXPECT_EQ(read(10), 10);
  EXPECT_EQ(read(11), 0);
}

TEST_F(BufferMemoryTest, Check_KnowsTheRowsOfEveryMode) {
  EXPECT_EQ(memory_.check(11, 1000, mode_b), WriteResult::done);
  EXPECT_EQ(memory_.check(11, 1000, mode_a), WriteResult::invalid);
  EXPECT_EQ(memory_.check(12, 0, mode_a), WriteResult::ignored);
  EXPECT_EQ(memory_.check(22, 0, mode_a), WriteResult::ignored);
}

// An area sees accesses after the table's check.
TEST_F(BufferMemoryTest, Area_SeesCheckedAccessesOnly) {
  struct : BufferArea {
    std::uint16_t read_word(BufferAddress address, can::Time) const override {
      return static_cast<std::uint16_t>(address + 1);
    }
    WriteResult write_word(BufferAddress, std::uint16_t value, can::Time) override {
      last = value;
      return value == 1 ? WriteResult::invalid : WriteResult::done;
    }
    std::uint16_t last = 0;
  } area;
  memory_.attach(10, 13, area);
  EXPECT_EQ(read(10), 11);
  EXPECT_EQ(read(13), 0);  // no row: system area all the same
  EXPECT_EQ(write(10, 15), WriteResult::invalid);
  EXPECT_EQ(area.last, 0);
  EXPECT_EQ(write(10, 20), WriteResult::done);
  EXPECT_EQ(area.last, 20);
  EXPECT_EQ(write(11, 1), WriteResult::invalid);
  EXPECT_EQ(write(12, 5), WriteResult::ignored);
  EXPECT_EQ(area.last, 1);
}

}  // namespace
}  // namespace canopus::module::buffer_memory_test
