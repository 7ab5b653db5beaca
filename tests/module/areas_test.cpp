// Areas of the buffer memory by themselves.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/module/emergency_buffer.hpp"
#include "canopus/module/error_status.hpp"
#include "canopus/module/me3can1_q/model.hpp"
#include "canopus/module/network_variables.hpp"
#include "canopus/module/nmt_status.hpp"
#include "canopus/module/stored_settings.hpp"

namespace canopus::module {
namespace {

TEST(ErrorStatus, OfTheMe3can1Q_EachOfItsErrorBitsMakesTheSignal) {
  RecordProperty("spec", "ME3-IO-012");
  for (unsigned bit = 0; bit < 16; ++bit) {
    ErrorStatus status(me3can1_q::model.error_status);
    status.follow(bit, true);
    const bool expected = bit == 1 || (bit >= 3 && bit <= 6) || bit == 8 || bit == 15;
    EXPECT_EQ(status.any(), expected) << bit;
  }
}

TEST(NmtStatus, EveryFailureBitOfEveryNode_IsAFailure_ActivityIsNot) {
  RecordProperty("spec", "ME3-NEC-011 ME3-IO-015");
  for (std::uint8_t node = 1; node <= 127; ++node) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      NmtStatus status(400, 600);
      status.set_status(node, static_cast<std::uint16_t>(1U << bit));
      EXPECT_EQ(status.any_failure(), bit >= 2) << "node " << unsigned{node} << " bit " << bit;
      EXPECT_EQ(status.read_word(400U + node, {}), 1U << bit);
      status.set_status(node, 0x03);
      EXPECT_FALSE(status.any_failure());
    }
  }
}

TEST(NmtStatus, LifeGuarding_ComesOnTop_AndIsClearedByItsOwnRequest) {
  NmtStatus status(400, 600);
  status.set_life_guarding(5);
  status.set_status(5, 0x02);
  EXPECT_EQ(status.status(5), 0x42);
  EXPECT_TRUE(status.any_failure());
  status.clear_life_guarding(4);
  EXPECT_TRUE(status.any_failure());
  status.clear_life_guarding(5);
  EXPECT_EQ(status.status(5), 0x02);
  EXPECT_FALSE(status.any_failure());
}

constexpr ErrorStatusLayout layout{.status = 29,
                                   .setting_address = 39,
                                   .refused_address = 40,
                                   .latched = 0x8160,
                                   .sum = 0x817A,
                                   .setting_bit = 6,
                                   .refused_bit = 5};

TEST(ErrorStatus, SumSignal_IsTheBitsOfItsMask) {
  for (unsigned bit = 0; bit < 16; ++bit) {
    ErrorStatus errors(layout);
    errors.follow(bit, true);
    EXPECT_EQ(errors.any(), (layout.sum >> bit & 1U) != 0) << bit;
    errors.clear();
    EXPECT_EQ(errors.bit(bit), (layout.latched >> bit & 1U) == 0) << bit;
  }
}

TEST(ErrorStatus, FirstAddressStays_UntilItsBitIsCleared) {
  ErrorStatus errors(layout);
  errors.record(WriteResult::invalid, 21);
  errors.record(WriteResult::invalid, 27);
  errors.record(WriteResult::refused, 24);
  errors.record(WriteResult::refused, 70);
  errors.record(WriteResult::ignored, 1);
  errors.record(WriteResult::done, 2);
  EXPECT_EQ(errors.read_word(29, {}), 0x0060);
  EXPECT_EQ(errors.read_word(39, {}), 21);
  EXPECT_EQ(errors.read_word(40, {}), 24);
  errors.write_word(29, 0xFFBF, {});
  EXPECT_EQ(errors.read_word(29, {}), 0x0020);
  EXPECT_EQ(errors.read_word(39, {}), 0);
  EXPECT_EQ(errors.read_word(40, {}), 24);
  errors.record(WriteResult::invalid, 27);
  EXPECT_EQ(errors.read_word(39, {}), 27);
}

RC_GTEST_PROP(EmergencyBuffer, KeepsTheFirstOnesAndTheLastOnes, ()) {
  const auto count = *rc::gen::inRange<std::uint16_t>(0, 100);
  EmergencyBuffer buffer(750, 11, 11);
  for (std::uint16_t i = 1; i <= count; ++i) buffer.record({.node_id = 1, .code = i});
  buffer.refresh();
  for (std::uint16_t i = 0; i < 22; ++i) {
    const bool in_stack = i < 11;
    const int newest_in_ring_start = count > 22 ? count - 11 : 11;
    const int expected = in_stack ? i + 1 : newest_in_ring_start + (i - 11) + 1;
    const std::uint16_t shown = buffer.read_word(751U + 5U * i, {});
    RC_ASSERT(shown == (expected <= count ? expected : 0));
  }
}

TEST(NetworkVariables, Places) {
  const auto place = [](std::uint16_t index, std::uint8_t sub) { return variable_place(index, sub, 2048); };
  EXPECT_EQ(place(0xA4C0, 1)->offset, 0);
  EXPECT_EQ(place(0xA4C8, 0x10)->offset, 2047);
  EXPECT_FALSE(place(0xA4C8, 0x11));
  EXPECT_FALSE(place(0xA4C0, 0));
  EXPECT_FALSE(place(0xA4C0, 0xFF));
  EXPECT_EQ(place(0xA581, 1)->offset, 508);
  EXPECT_EQ(place(0xA682, 4)->offset, 2044);
  EXPECT_FALSE(place(0xA682, 5));
  EXPECT_EQ(place(0xA100, 1)->direction, VariableDirection::input);
  EXPECT_FALSE(place(0x9FFF, 1));
  EXPECT_FALSE(place(0xA080, 1));
  EXPECT_FALSE(place(0xA700, 1));
}

RC_GTEST_PROP(StoredSettings, Words_ComeBack, (const std::map<std::uint16_t, std::uint16_t>& words)) {
  StoredWords stored;
  for (const auto& [address, value] : words) stored[address] = value;
  RC_ASSERT(decode_words(encode_words(stored)) == stored);
}

// Whatever the bytes are: an answer, never a crash.
RC_GTEST_PROP(StoredSettings, AnyBytes_AreAnswered, (const std::vector<std::uint8_t>& bytes)) {
  canopen::DictionaryBuilder builder;
  builder.variable(
      0x1017, {.name = "Producer heartbeat time", .type = canopen::DataType::unsigned16, .stored = true});
  canopen::ObjectDictionary dictionary(builder.build(), 1);
  static_cast<void>(apply_objects(bytes, dictionary));
  RC_ASSERT(decode_words(bytes).has_value() == (bytes.size() % 4 == 0));
}

TEST(StoredSettings, Objects_AreIndexSubLengthAndValue) {
  canopen::DictionaryBuilder builder;
  builder.variable(0x1017, {.name = "stored", .type = canopen::DataType::unsigned16, .stored = true});
  builder.variable(0x1006, {.name = "not stored", .type = canopen::DataType::unsigned32});
  const auto description = builder.build();
  canopen::ObjectDictionary dictionary(description, 1);
  dictionary.set<std::uint16_t>(0x1017, 0, 1000);
  dictionary.set<std::uint32_t>(0x1006, 0, 7);
  const std::vector<std::uint8_t> bytes = encode_objects(dictionary);
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{0x17, 0x10, 0x00, 0x02, 0x00, 0xE8, 0x03}));
  canopen::ObjectDictionary other(description, 1);
  EXPECT_TRUE(apply_objects(bytes, other));
  EXPECT_EQ(other.get<std::uint16_t>(0x1017, 0), 1000);
  EXPECT_FALSE(apply_objects(std::span(bytes).first(6), other));
  EXPECT_FALSE(apply_objects(std::vector<std::uint8_t>{0x17, 0x10, 0x00, 0x01, 0x00, 0xE8}, other));
  EXPECT_TRUE(apply_objects(std::vector<std::uint8_t>{0x99, 0x10, 0x00, 0x01, 0x00, 0xE8}, other));
}

}  // namespace
}  // namespace canopus::module
