#include "canopus/canopen/pdo/pdo_mapping.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen::pdo_mapping_test {
namespace {

struct PdoMappingTest : testing::Test, Conversation {
  AbortCode map(std::uint16_t mapping, std::uint8_t sub, std::uint32_t value) {
    return write(mapping, sub, value, sub == 0 ? 1 : 4);
  }
};

TEST_F(PdoMappingTest, EntriesOfAValidPdo_CannotBeChanged) {
  set_up(0x1800, {0x60000108}, 0xFE);
  EXPECT_EQ(map(0x1A00, 0, 0), AbortCode::device_state);
  EXPECT_EQ(map(0x1A00, 1, 0x60000208), AbortCode::device_state);
}

TEST_F(PdoMappingTest, EntriesOfASwitchedOnMapping_CannotBeChanged) {
  map(0x1A00, 1, 0x60000108);
  map(0x1A00, 0, 1);
  EXPECT_EQ(map(0x1A00, 1, 0x60000208), AbortCode::unsupported_access);
  EXPECT_EQ(map(0x1A00, 0, 0), AbortCode::none);
  EXPECT_EQ(map(0x1A00, 1, 0x60000208), AbortCode::none);
}

TEST_F(PdoMappingTest, WhatCannotBeMapped_IsRefused) {
  EXPECT_EQ(map(0x1A00, 1, 0x50000008), AbortCode::no_object);
  EXPECT_EQ(map(0x1A00, 1, 0x60000908), AbortCode::no_sub_index);
  EXPECT_EQ(map(0x1A00, 1, 0x20040008), AbortCode::not_mappable);
  EXPECT_EQ(map(0x1A00, 1, 0x62000108), AbortCode::not_mappable) << "an output, for RPDOs only";
  EXPECT_EQ(map(0x1600, 1, 0x60000108), AbortCode::not_mappable) << "an input, for TPDOs only";
  EXPECT_EQ(map(0x1A00, 1, 0x60000110), AbortCode::not_mappable) << "longer than the object";
  EXPECT_EQ(map(0x1A00, 1, 0x00050008), AbortCode::not_mappable) << "a dummy in a TPDO";
  EXPECT_EQ(map(0x1600, 1, 0x00050010), AbortCode::not_mappable) << "a dummy of the wrong length";
}

TEST_F(PdoMappingTest, MoreThan64Bits_AreRefused) {
  map(0x1A00, 1, 0x65000040);
  map(0x1A00, 2, 0x60000108);
  EXPECT_EQ(map(0x1A00, 0, 2), AbortCode::mapping_length);
  EXPECT_EQ(map(0x1A00, 0, 1), AbortCode::none);
}

TEST_F(PdoMappingTest, CountBeyondTheEntries_IsRefused) {
  EXPECT_EQ(map(0x1A00, 0, 9), AbortCode::mapping_length);
  EXPECT_EQ(map(0x1A00, 0, 0x41), AbortCode::invalid_value);
  EXPECT_EQ(map(0x1A00, 0, 1), AbortCode::no_object) << "an entry that is 0";
}

TEST_F(PdoMappingTest, NeighboursInFrameAndBlock_AreOneCopy) {
  map(0x1A00, 1, 0x64010110);
  map(0x1A00, 2, 0x64010210);
  map(0x1A00, 3, 0x64010310);
  map(0x1A00, 4, 0x64010410);
  map(0x1A00, 0, 4);
  CopyPlan plan;
  plan.compile(node.dictionary(), 0x1A00);
  EXPECT_EQ(plan.step_count(), 1U);
  EXPECT_EQ(plan.length(), 8);
}

TEST_F(PdoMappingTest, DefaultMappingWithMissingObjects_LeavesTheirBitsUnused) {
  node.dictionary().set(0x1A00, 1, 0x50000008U);
  node.dictionary().set(0x1A00, 2, 0x60000108U);
  node.dictionary().set(0x1A00, 0, std::uint8_t{2});
  CopyPlan plan;
  plan.compile(node.dictionary(), 0x1A00);
  node.dictionary().set(0x6000, 1, std::uint8_t{0xAB});
  EXPECT_EQ(plan.length(), 2);
  EXPECT_EQ(plan.gather(node.dictionary().block().data()), 0xAB00U);
}

// Of every length, at every place in block and frame: what lies beside them stays as it is.
TEST_F(PdoMappingTest, OneCopyOfAnyLength_TouchesItsBytesAlone) {
  ObjectDictionary& dictionary = node.dictionary();
  for (unsigned dummies = 0; dummies < 8; ++dummies) {
    for (unsigned length = 1; length + dummies <= 8; ++length) {
      for (unsigned first = 1; first + length <= 9; ++first) {
        for (unsigned i = 0; i < dummies + length; ++i) {
          const std::uint32_t mapped = i < dummies ? 0x00050008 : 0x62000008 | (first + i - dummies) << 8;
          dictionary.set(0x1600, static_cast<std::uint8_t>(i + 1), mapped);
        }
        dictionary.set(0x1600, 0, static_cast<std::uint8_t>(dummies + length));
        CopyPlan plan;
        plan.compile(dictionary, 0x1600);
        ASSERT_TRUE(plan.is_single());
        for (std::uint8_t& byte : dictionary.block()) byte = 0xA5;
        plan.scatter(0x8877665544332211, dictionary.block().data());
        std::vector<std::uint8_t> expected(dictionary.block().size(), 0xA5);
        const std::uint32_t place =
            dictionary.description().find(0x6200, static_cast<std::uint8_t>(first)).offset;
        for (unsigned i = 0; i < length; ++i)
          expected[place + i] = static_cast<std::uint8_t>(0x11 * (dummies + i + 1));
        ASSERT_TRUE(std::ranges::equal(dictionary.block(), expected))
            << dummies << ' ' << length << ' ' << first;
        const unsigned above = 64 - 8 * (dummies + length);
        ASSERT_EQ(plan.gather(dictionary.block().data()),
                  0x8877665544332211 << above >> above >> 8 * dummies << 8 * dummies);
      }
    }
  }
}

TEST_F(PdoMappingTest, CommunicationParameters_ObeyTheCobIdRules) {
  set_up(0x1800, {0x60000108}, 0xFE);
  EXPECT_EQ(write(0x1800, 1, 0x40000186, 4), AbortCode::invalid_value) << "another identifier while valid";
  EXPECT_EQ(write(0x1800, 1, 0xC0000186, 4), AbortCode::none);
  EXPECT_EQ(write(0x1800, 1, 0x40000605, 4), AbortCode::invalid_value) << "restricted";
  EXPECT_EQ(write(0x1800, 1, 0x40001186, 4), AbortCode::invalid_value) << "29-bit identifier without bit 29";
  EXPECT_EQ(write(0x1800, 1, 0x40000187, 4), AbortCode::none);
}

TEST_F(PdoMappingTest, TransmissionTypes_AreChecked) {
  EXPECT_EQ(write(0x1800, 2, 0xF1, 1), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1800, 2, 0xFB, 1), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1800, 2, 0xFC, 1), AbortCode::none);
  EXPECT_EQ(write(0x1800, 1, 0xC0000185, 4), AbortCode::none);
  EXPECT_EQ(write(0x1800, 2, 0xFD, 1), AbortCode::invalid_value) << "no RTR";
  EXPECT_EQ(write(0x1400, 2, 0xFC, 1), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1400, 2, 0xF0, 1), AbortCode::none);
}

TEST_F(PdoMappingTest, InhibitTimeAndStartValue_CannotBeChangedWhileValid) {
  set_up(0x1800, {0x60000108}, 0xFE);
  EXPECT_EQ(write(0x1800, 3, 10, 2), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1800, 6, 1, 1), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1801, 3, 10, 2), AbortCode::none);
  EXPECT_EQ(write(0x1801, 6, 241, 1), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1801, 6, 240, 1), AbortCode::none);
}

}  // namespace
}  // namespace canopus::canopen::pdo_mapping_test
