// Areas of the buffer memory by themselves.

#include <array>
#include <optional>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/module/canopen/emergency_buffer.hpp"
#include "canopus/module/canopen/network_variables.hpp"
#include "canopus/module/canopen/nmt_status.hpp"
#include "canopus/module/memory/error_status.hpp"
#include "canopus/module/models/me3can1_q/me3can1_q.hpp"
#include "canopus/module/storage/stored_settings.hpp"

namespace canopus::module::areas_test {
namespace {

constexpr std::array table =
    std::to_array<BufferRow>({{.first = 0, .last = 1000, .name = "words", .access = WordAccess::read_write}});

constexpr std::array every_error{
    ModuleError::hardware,      ModuleError::bus_off,       ModuleError::flash,
    ModuleError::refused_write, ModuleError::invalid_value, ModuleError::queue_overflow,
    ModuleError::node_failure,  ModuleError::error_passive, ModuleError::message_slot};

TEST(ErrorStatus, OfTheMe3can1Q_EachOfItsErrorBitsMakesTheSignal) {
  RecordProperty("spec", "ME3-IO-012");
  std::uint16_t bits_with_signal = 0;
  std::uint16_t bits_without = 0;
  for (const ModuleError error : every_error) {
    BufferMemory memory(table);
    ErrorStatus status(me3can1_q::model.error_status, memory);
    status.follow(error, true);
    std::uint16_t& bits = status.any() ? bits_with_signal : bits_without;
    bits = static_cast<std::uint16_t>(bits | status.read_word(29, {}));
  }
  EXPECT_EQ(bits_with_signal, 1U << 1 | 1U << 3 | 1U << 4 | 1U << 5 | 1U << 6 | 1U << 8 | 1U << 15);
  EXPECT_EQ(bits_without, 1U << 14);
}

constexpr NmtStatusLayout one_node_per_word{.error_control = 401, .state = 601, .clear_node = 400};

TEST(NmtStatus, EveryFailureBitOfEveryNode_IsAFailure_ActivityIsNot) {
  RecordProperty("spec", "ME3-NEC-011 ME3-IO-015");
  for (std::uint8_t node = 1; node <= 127; ++node) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      BufferMemory memory(table);
      NmtStatus status(one_node_per_word, memory);
      status.set_status(node, static_cast<std::uint16_t>(1U << bit));
      EXPECT_EQ(status.any_failure(), bit >= 2) << "node " << unsigned{node} << " bit " << bit;
      EXPECT_EQ(status.read_word(400U + node, {}), 1U << bit);
      status.set_status(node, 0x03);
      EXPECT_FALSE(status.any_failure());
    }
  }
}

TEST(NmtStatus, LifeGuarding_ComesOnTop_AndIsClearedByItsOwnRequest) {
  BufferMemory memory(table);
  NmtStatus status(one_node_per_word, memory);
  status.set_guarding_master(5, manager::error_control::life_guarding);
  status.set_status(5, 0x02);
  EXPECT_EQ(status.status(5), 0x42);
  EXPECT_TRUE(status.any_failure());
  status.clear_life_guarding(4);
  EXPECT_TRUE(status.any_failure());
  status.clear_life_guarding(5);
  EXPECT_EQ(status.status(5), 0x02);
  EXPECT_FALSE(status.any_failure());
}

TEST(NmtStatus, TwoNodesPerWord_TheOddOneIsLow_AndTheLastHighByteIsEmpty) {
  BufferMemory memory(table);
  NmtStatus status(NmtStatusLayout{.error_control = 900, .error_control_nodes_per_word = 2, .state = 601},
                   memory);
  for (std::uint8_t node = 1; node <= 127; ++node) status.set_status(node, node);
  status.set_state(127, 5);
  memory.select_mode(every_mode);
  EXPECT_EQ(memory.peek(900, {}), 0x0201);
  EXPECT_EQ(memory.peek(962, {}), 0x7E7D);
  EXPECT_EQ(memory.peek(963, {}), 0x007F);
  EXPECT_EQ(memory.peek(964, {}), 0);
  EXPECT_EQ(memory.peek(727, {}), 5);
}

TEST(NmtStatus, WithoutWords_StillKnowsAFailure) {
  BufferMemory memory({});
  NmtStatus status(std::nullopt, memory);
  status.set_status(64, 0x80);
  EXPECT_TRUE(status.any_failure());
  EXPECT_EQ(status.status(64), 0x80);
  status.hold_clear(true);
  EXPECT_TRUE(status.held_clear(64));  // all nodes are meant
}

constexpr std::array some_errors = std::to_array<ErrorRow>({
    {.error = ModuleError::refused_write, .bit = 5, .latched = true, .signal = true},
    {.error = ModuleError::invalid_value, .bit = 6, .latched = true, .signal = true},
    {.error = ModuleError::hardware, .bit = 1, .signal = true},
    {.error = ModuleError::queue_overflow, .bit = 8, .latched = true},
    {.error = ModuleError::error_passive, .bit = 14},
});
constexpr ErrorStatusLayout layout{
    .status = 29, .invalid_address = 39, .refused_address = 40, .errors = some_errors};

TEST(ErrorStatus, RowsSayWhichBit_WhatStays_AndWhatMakesTheSignal) {
  for (const ErrorRow& row : some_errors) {
    SCOPED_TRACE(unsigned{row.bit});
    BufferMemory memory(table);
    ErrorStatus errors(layout, memory);
    errors.follow(row.error, true);
    EXPECT_EQ(errors.read_word(29, {}), 1U << row.bit);
    EXPECT_EQ(errors.any(), row.signal);
    errors.clear();
    EXPECT_EQ(errors.has(row.error), !row.latched);
    EXPECT_EQ(errors.read_word(29, {}), row.latched ? 0U : 1U << row.bit);
  }
}

TEST(ErrorStatus, GeneralErrorBit_IsOnWhileTheSignalIs) {
  ErrorStatusLayout general = layout;
  general.general_error_bit = 0;
  BufferMemory memory(table);
  ErrorStatus errors(general, memory);
  errors.follow(ModuleError::error_passive, true);
  EXPECT_EQ(errors.read_word(29, {}), 1U << 14);
  errors.raise(ModuleError::invalid_value);
  EXPECT_EQ(errors.read_word(29, {}), 1U << 14 | 1U << 6 | 1U << 0);
  errors.write_word(29, 0, {});
  EXPECT_EQ(errors.read_word(29, {}), 1U << 14);
}

TEST(ErrorStatus, WithoutWords_StillKnowsItsErrors) {
  BufferMemory memory({});
  ErrorStatus errors(std::nullopt, memory);
  EXPECT_TRUE(errors.follow(ModuleError::bus_off, true));
  EXPECT_TRUE(errors.has(ModuleError::bus_off));
  EXPECT_FALSE(errors.any());
  EXPECT_TRUE(errors.raise(ModuleError::queue_overflow));
  EXPECT_FALSE(errors.raise(ModuleError::queue_overflow));
  errors.reset();
  EXPECT_FALSE(errors.has(ModuleError::bus_off));
}

TEST(ErrorStatus, FirstAddressStays_UntilItsBitIsCleared) {
  BufferMemory memory(table);
  ErrorStatus errors(layout, memory);
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
  const auto stack = *rc::gen::inRange<std::uint16_t>(1, 12);
  const auto ring = *rc::gen::inRange<std::uint16_t>(1, 12);
  BufferMemory memory(table);
  EmergencyBuffer buffer(EmergencyBufferLayout{.first = 750, .stack = stack, .ring = ring}, memory);
  for (std::uint16_t i = 1; i <= count; ++i) buffer.record({.node_id = 1, .code = i});
  buffer.refresh();
  for (std::uint16_t i = 0; i < stack + ring; ++i) {
    const bool in_stack = i < stack;
    const int newest_in_ring_start = count > stack + ring ? count - ring : stack;
    const int expected = in_stack ? i + 1 : newest_in_ring_start + (i - stack) + 1;
    const std::uint16_t shown = buffer.read_word(751U + 5U * i, {});
    RC_ASSERT(shown == (expected <= count ? expected : 0));
  }
}

TEST(EmergencyBuffer, WithoutALayout_KeepsNothing) {
  BufferMemory memory({});
  EmergencyBuffer buffer(std::nullopt, memory);
  buffer.record({.node_id = 1, .code = 0x1000});
  buffer.refresh();
  EXPECT_TRUE(buffer.empty());
}

TEST(NetworkVariables, ValueMask) {
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
  RC_ASSERT(decode_words(bytes).has_value() == (bytes.size() % 4 == 0));
}

}  // namespace
}  // namespace canopus::module::areas_test
