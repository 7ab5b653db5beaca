// Values that are a state, a choice or bits, in words.

#include "canopus/trace/decode/value_words.hpp"

#include <bit>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::trace::value_words_test {
namespace {

using ::testing::ElementsAre;

std::shared_ptr<const canopen::DictionaryDescription> device_of_profile(std::uint32_t device_type) {
  canopen::DictionaryBuilder builder;
  builder.variable(
      0x1000, {.value = {static_cast<std::uint8_t>(device_type), static_cast<std::uint8_t>(device_type >> 8),
                         static_cast<std::uint8_t>(device_type >> 16), 0}});
  return builder.build();
}
const auto drive = device_of_profile(0x00020192);

std::string state(std::uint16_t index, std::uint64_t value, std::uint8_t sub = 0) {
  return std::string(value_words(drive.get(), index, sub, value).state);
}

TEST(ValueWords, Statusword_IsTheStateOfTheDrive) {
  EXPECT_EQ(state(0x6041, 0x0000), "not ready to switch on");
  EXPECT_EQ(state(0x6041, 0x0240), "switch on disabled");
  EXPECT_EQ(state(0x6041, 0x0231), "ready to switch on");
  EXPECT_EQ(state(0x6041, 0x0233), "switched on");
  EXPECT_EQ(state(0x6041, 0x1637), "operation enabled");
  EXPECT_EQ(state(0x6041, 0x0217), "quick stop active");
  EXPECT_EQ(state(0x6041, 0x021F), "fault reaction active");
  EXPECT_EQ(state(0x6041, 0x0218), "fault");
}

TEST(ValueWords, Statusword_NamesItsBits) {
  EXPECT_THAT(value_words(drive.get(), 0x6041, 0, 0x0637).bits,
              ElementsAre("ready to switch on", "switched on", "operation enabled", "voltage enabled",
                          "quick stop", "remote", "target reached"));
  EXPECT_THAT(value_words(drive.get(), 0x6041, 0, 0x8880).bits,
              ElementsAre("warning", "internal limit active", "manufacturer bit 15"));
  EXPECT_EQ(value_words(drive.get(), 0x6041, 0, 0x0008).text(), "fault");
}

TEST(ValueWords, Controlword_IsTheCommand) {
  EXPECT_EQ(state(0x6040, 0x06), "shutdown");
  EXPECT_EQ(state(0x6040, 0x07), "switch on, or disable operation");
  EXPECT_EQ(state(0x6040, 0x1F), "enable operation");
  EXPECT_EQ(state(0x6040, 0x00), "disable voltage");
  EXPECT_EQ(state(0x6040, 0x02), "quick stop");
  EXPECT_EQ(state(0x6040, 0x80), "fault reset");
  EXPECT_THAT(value_words(drive.get(), 0x6040, 0, 0x010F).bits,
              ElementsAre("switch on", "enable voltage", "quick stop", "enable operation", "halt"));
}

TEST(ValueWords, ModesOfOperation_AreNamed) {
  EXPECT_EQ(state(0x6060, 1), "profile position");
  EXPECT_EQ(state(0x6061, 8), "cyclic synchronous position");
  EXPECT_EQ(state(0x6060, 0xFF), "mode of the manufacturer") << "-1";
  EXPECT_EQ(state(0x6060, 5), "") << "reserved";
  EXPECT_THAT(value_words(drive.get(), 0x6502, 0, 0x25).bits,
              ElementsAre("profile position", "profile velocity", "homing"));
}

TEST(ValueWords, ObjectsOfADrive_HaveNoWordsInAnotherDevice) {
  EXPECT_TRUE(value_words(device_of_profile(0x000F0191).get(), 0x6041, 0, 0x0637).empty());
  EXPECT_TRUE(value_words(nullptr, 0x6041, 0, 0x0637).empty());
  EXPECT_TRUE(value_words(drive.get(), 0x6064, 0, 0x0637).empty()) << "a position";
  EXPECT_EQ(value_unit(device_of_profile(0x191).get(), 0x6077, 0), "");
}

TEST(ValueWords, ErrorRegister_NamesItsBits) {
  EXPECT_THAT(value_words(nullptr, 0x1001, 0, 0x91).bits,
              ElementsAre("generic", "communication", "manufacturer"));
  EXPECT_EQ(value_words(nullptr, 0x1001, 0, 0x11).text(), "generic, communication");
  EXPECT_EQ(value_words(nullptr, 0x1001, 0, 0).text(), "no error");
}

TEST(ValueWords, StatesOfNodes_AreThoseOfNmt) {
  EXPECT_EQ(state(0x1F82, 0x05, 3), "operational");
  EXPECT_EQ(state(0x1F82, 0x7F, 3), "pre-operational");
  EXPECT_EQ(state(0x1F82, 0x04, 3), "stopped");
  EXPECT_EQ(state(0x1F82, 0x01, 3), "node missing");
  EXPECT_EQ(state(0x1F82, 0x00, 3), "state unknown");
  EXPECT_EQ(state(0x1F82, 0x05, 0), "") << "the number of sub-indexes";
  EXPECT_EQ(state(0x1029, 2, 1), "to stopped");
  EXPECT_EQ(state(0x1F51, 1, 1), "started");
}

TEST(ValueWords, Units_AreThoseOfTheStandards) {
  EXPECT_EQ(value_unit(nullptr, 0x1017, 0), "ms");
  EXPECT_EQ(value_unit(drive.get(), 0x6077, 0), "x 0.1 %");
  EXPECT_EQ(value_unit(drive.get(), 0x6075, 0), "mA");
  EXPECT_EQ(value_unit(drive.get(), 0x6068, 0), "ms");
  EXPECT_EQ(value_unit(drive.get(), 0x6064, 0), "") << "the device's own";
}

RC_GTEST_PROP(ValueWordsProperties, EveryValueOfEveryObject_HasAsManyBitNamesAsBits,
              (std::uint16_t index, std::uint8_t sub, std::uint64_t value)) {
  const auto word = value & 0xFFFF;
  for (const std::uint16_t object : {index, std::uint16_t{0x6040}, std::uint16_t{0x6041}}) {
    const ValueWords words = value_words(drive.get(), object, sub, word);
    if (object == 0x6040 || object == 0x6041)
      RC_ASSERT(words.bits.size() == static_cast<std::size_t>(std::popcount(word)));
    (void)words.text();
  }
}

}  // namespace
}  // namespace canopus::trace::value_words_test
