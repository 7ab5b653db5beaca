// The Layer 2 engine by itself: what the modules' rules change, with the layout of the FX3U-CAN.

#include "canopus/module/layer2/layer2.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace canopus::module::layer2_test {
namespace {

using namespace std::chrono_literals;

// Every frame is sent at once.
struct OpenController final : can::Controller {
  bool send(const can::Frame& frame) override {
    sent.push_back(frame);
    return true;
  }
  std::uint16_t transmit_error_counter() const override { return 0; }
  std::uint16_t receive_error_counter() const override { return 0; }
  can::ErrorState error_state() const override { return can::ErrorState::error_active; }
  std::uint32_t bit_rate() const override { return 250'000; }
  void restart(std::uint32_t) override {}
  std::uint32_t transmit_overflows() const override { return 0; }
  std::vector<can::Frame> sent;
};

constexpr std::array table = std::to_array<BufferRow>({
    {.first = 100, .last = 393, .name = "slots", .access = WordAccess::read_write, .initial = 0xFFFF},
    {.first = 401, .last = 442, .name = "errors", .access = WordAccess::read_write},
    {.first = 1100, .last = 1267, .name = "parameters", .access = WordAccess::read_write, .initial = 0xFFFF},
    {.first = 1270, .last = 1272, .name = "RTR", .access = WordAccess::read},
    {.first = 1280, .last = 1282, .name = "triggers", .access = WordAccess::read_write},
    {.first = 1900, .last = 1927, .name = "stop", .access = WordAccess::read_write, .initial = 0xFFFF},
});
constexpr Layer2Layout layout{.error_codes = 401,
                              .parameters = 1100,
                              .rtr_flags = 1270,
                              .trigger_flags = 1280,
                              .stop_messages = 1900,
                              .process_data = 100};

struct Bench {
  explicit Bench(const Layer2Rules& rules, bool extended = false)
      : layer2(layout, rules, memory, controller) {
    memory.select_mode(every_mode);
    for (BufferAddress slot = 0; slot < layer2_slots; ++slot) memory.set_word(102 + 7 * slot, 0);
    layer2.start(extended);
  }
  WriteResult write(BufferAddress address, std::uint16_t value) { return memory.write(address, value, {}); }
  /// Transmit slot n (from 0).
  void transmits(BufferAddress slot, std::uint16_t b, std::uint16_t type, std::uint16_t identifier,
                 std::uint16_t form) {
    const std::array<std::uint16_t, 4> parameters{0xFFFF, b, type, 1};
    for (BufferAddress i = 0; i < 4; ++i)
      EXPECT_EQ(write(1100 + 4 * slot + i, parameters[i]), WriteResult::done);
    const std::array<std::uint16_t, 7> block{identifier, 0, form, 0x2211, 0x4433, 0x6655, 0x8877};
    for (BufferAddress i = 0; i < 7; ++i) EXPECT_EQ(write(100 + 7 * slot + i, block[i]), WriteResult::done);
  }
  void receives(BufferAddress slot, std::uint16_t identifier) {
    const std::array<std::uint16_t, 4> parameters{identifier, 0, 0, 0};
    for (BufferAddress i = 0; i < 4; ++i) write(1100 + 4 * slot + i, parameters[i]);
  }

  BufferMemory memory{table};
  OpenController controller;
  Layer2 layer2;
};

TEST(Layer2, ErrorsKeepOffline_OrLeaveTheSlotOut) {
  for (const bool keep : {true, false}) {
    Bench b({.errors_keep_offline = keep});
    b.transmits(0, 0x5FFF, 0, 0xFFFF, 1);
    b.transmits(1, 0x5FFF, 0, 0x0102, 1);
    EXPECT_EQ(b.layer2.go_online({}), 100U);  // FFFFH is no 11-bit identifier
    EXPECT_EQ(b.layer2.online(), !keep);
    b.layer2.snapshot();
    b.layer2.exchange();
    EXPECT_EQ(b.controller.sent.size(), keep ? 0U : 1U);
  }
}

TEST(Layer2, RtrLimit_MayBeASettingError) {
  for (const bool error : {true, false}) {
    Bench b({.rtr_limit_is_error = error});
    for (BufferAddress slot = 0; slot < 30; ++slot)
      b.transmits(slot, 0x7FFF, 4, static_cast<std::uint16_t>(0x100 + slot), 1);
    EXPECT_EQ(b.layer2.go_online({}), error ? std::optional<BufferAddress>(1101U + 4 * 28) : std::nullopt);
    EXPECT_TRUE(b.layer2.online());
    EXPECT_EQ(b.memory.word(1101 + 4 * 27), 0x7FFF);
    EXPECT_EQ(b.memory.word(1101 + 4 * 28), 0x5FFF);
  }
}

TEST(Layer2, FrameWord_MayBeConfiguration) {
  for (const bool configuration : {true, false}) {
    Bench b({.frame_word_is_configuration = configuration});
    b.transmits(0, 0x5FFF, 0, 0x0123, 1);
    b.receives(1, 0x0181);
    b.layer2.go_online({});
    EXPECT_EQ(b.write(102, 2), configuration ? WriteResult::refused : WriteResult::done);
    EXPECT_EQ(b.memory.word(102), configuration ? 1 : 2);
    EXPECT_EQ(b.write(102, b.memory.word(102)), WriteResult::done);  // changes nothing
    EXPECT_EQ(b.write(103, 5), WriteResult::done);
    b.layer2.receive(can::data_frame(0x181, {1}), {});
    b.layer2.snapshot();
    b.layer2.exchange();
    EXPECT_EQ(b.memory.word(109), 0x0301);
    EXPECT_EQ(b.write(109, 0), WriteResult::done);
    EXPECT_EQ(b.memory.word(109), 0x0001);
    b.layer2.go_offline();
    EXPECT_EQ(b.write(102, 3), WriteResult::done);
  }
}

TEST(Layer2, HighWordOfABaseIdentifier_MayNotMatter) {
  for (const bool ignored : {true, false}) {
    Bench b({.base_high_word_ignored = ignored});
    b.transmits(0, 0x5FFF, 0, 0x0123, 0);
    EXPECT_EQ(b.write(101, 0x4321), ignored ? WriteResult::done : WriteResult::invalid);
    EXPECT_EQ(b.write(101, 0xFFFF), WriteResult::done);
    EXPECT_EQ(b.layer2.go_online({}), ignored ? std::nullopt : std::optional<BufferAddress>(101U));
    b.layer2.snapshot();
    b.layer2.exchange();
    if (ignored) {
      EXPECT_EQ(b.controller.sent.at(0), can::data_frame(0x123));
    }
  }
}

TEST(Layer2, EveryTransmitSlot_MayBeSentOnGoingOnline) {
  for (const bool sends : {true, false}) {
    Bench b({.sends_when_online = sends});
    for (std::uint16_t type = 0; type <= 4; ++type)
      b.transmits(type, 0x5FFF, type, static_cast<std::uint16_t>(0x100 + type), 1);
    b.layer2.go_online({});
    EXPECT_EQ(b.controller.sent.size(), sends ? 5U : 0U);
    if (sends) {
      EXPECT_EQ(b.controller.sent.at(1), can::data_frame(0x101, {0x11}));
    }
  }
}

TEST(Layer2, ReceiveWords_MayBeClearedOnGoingOnline) {
  for (const bool clears : {true, false}) {
    Bench b({.clears_receive_words = clears});
    b.receives(0, 0x0181);
    b.transmits(1, 0x5FFF, 0, 0x0123, 1);
    b.layer2.go_online({});
    b.layer2.receive(can::data_frame(0x181, {1}), {});
    b.layer2.snapshot();
    b.layer2.exchange();
    b.layer2.go_offline();
    b.layer2.go_online({});
    EXPECT_EQ(b.memory.word(102), clears ? 0 : 0x0301);
    EXPECT_EQ(b.memory.word(107), 0x0123);
  }
}

TEST(Layer2, TransmitIdentifiers_MayHaveToBeUnique) {
  for (const bool unique : {true, false}) {
    Bench b({.unique_transmit_identifiers = unique});
    b.transmits(0, 0x5FFF, 0, 0x0123, 1);
    b.transmits(1, 0x5FFF, 0, 0x0124, 1);
    b.transmits(2, 0x5FFF, 0, 0x0123, 1);
    EXPECT_EQ(b.layer2.go_online({}), unique ? std::optional<BufferAddress>(114U) : std::nullopt);
  }
}

TEST(Layer2, RemoteFrames_MayHaveToBeOfATypeThatLooksForNoChange) {
  for (const bool rule : {true, false}) {
    for (const std::uint16_t type : std::initializer_list<std::uint16_t>{0, 1, 2, 3, 4}) {
      Bench b({.remote_frames_have_no_changes = rule});
      b.transmits(0, 0x5FFF, type, 0x0123, 0x8001);
      const bool wrong = rule && (type == 1 || type == 3);
      EXPECT_EQ(b.layer2.go_online({}), wrong ? std::optional<BufferAddress>(1102U) : std::nullopt) << type;
    }
  }
}

TEST(Layer2, CycleUnit_IsARule) {
  Bench b({.cycle_unit = 3ms});
  b.transmits(0, 0x5FFF, 2, 0x0123, 1);
  b.layer2.go_online(can::Time(1s));
  EXPECT_EQ(b.layer2.deadline(), can::Time(1003ms));
  b.layer2.tick(can::Time(1003ms));
  EXPECT_EQ(b.layer2.deadline(), can::Time(1006ms));
  EXPECT_EQ(b.controller.sent.size(), 1U);
}

TEST(Layer2, TriggersWithoutARequestSignal_AreSentWhenWritten) {
  Bench b({});  // a module without signals asks for the trigger with every write
  b.transmits(41, 0x5FFF, 4, 0x0123, 1);
  b.layer2.go_online({});
  b.write(1282, 0x0200);
  b.layer2.request_trigger(true);
  EXPECT_TRUE(b.layer2.trigger_done());
  EXPECT_EQ(b.memory.word(1282), 0);
  EXPECT_EQ(b.controller.sent.size(), 1U);
}

TEST(Layer2, ReceiveProcessing_TakesSoManyMessagesAtOnce) {
  Bench b({.message_time = 1ms, .waiting_messages = 3});
  b.receives(0, 0x0181);
  b.receives(1, 0x0182);
  b.layer2.go_online({});
  const auto receive = [&](std::uint32_t identifier, can::Duration at) {
    b.layer2.receive(can::data_frame(identifier), can::Time(at));
  };
  for (int i = 0; i < 10; ++i) receive(0x183, 0ms);  // nobody's
  for (int i = 0; i < 3; ++i) receive(0x181, 0ms);
  EXPECT_FALSE(b.layer2.any_slot_error());
  receive(0x182, 999us);
  EXPECT_EQ(b.memory.word(401), 0);
  EXPECT_EQ(b.memory.word(402), slot_error::receive_overflow);
  EXPECT_TRUE(b.layer2.any_slot_error());
  b.write(402, 0);
  receive(0x182, 1ms);
  EXPECT_FALSE(b.layer2.any_slot_error());
  receive(0x182, 1ms);
  EXPECT_TRUE(b.layer2.any_slot_error());
}

}  // namespace
}  // namespace canopus::module::layer2_test
