// Whatever the PLC and the bus do to an ME3CAN1-Q: it answers, its time moves on, and a power cycle brings it
// back.

#include <random>

#include <gtest/gtest.h>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"

#include "scenarios/scenario.hpp"

namespace canopus::scenario::me3can1_q_random_test {
namespace {

class RandomAccess : public testing::TestWithParam<unsigned> {};

TEST_P(RandomAccess, NeverBreaksTheModule) {
  std::mt19937 random(GetParam());
  const auto below = [&](std::uint32_t limit) { return static_cast<std::uint32_t>(random() % limit); };
  RamMemory memory;
  FreeBus bus;
  module::me3can1_q::Me3can1Q module(bus, memory, {.restart_time = 100ms, .power_on_time = 10ms});
  can::Time now{};
  const auto run_to = [&](can::Time end) {
    for (unsigned ticks = 0; module.deadline() <= end; ++ticks) {
      ASSERT_LT(ticks, 100'000U) << "the deadline does not move on";
      now = std::max(now, module.deadline());
      module.tick(now);
    }
    now = end;
  };
  module.power_on(now);
  const std::vector<module::BufferAddress> words{20, 21, 22, 24, 25, 27, 29,  50,
                                                 51, 52, 58, 59, 70, 71, 400, 750};
  const std::vector<std::uint16_t> commands{0x0000, 0x0002, 0x0004, 0x0006, 0x0008,
                                            0x000A, 0x000C, 0xFFFF, 0x1234};
  const std::vector<std::uint16_t> indexes{0x1000, 0x1003, 0x1005, 0x1006, 0x1008, 0x1010, 0x1011,
                                           0x1012, 0x1015, 0x1016, 0x1017, 0x1018, 0x1028, 0x1029,
                                           0x1400, 0x1600, 0x1800, 0x1A00, 0x1F22, 0x1F25, 0x1F80,
                                           0x1F81, 0x1F82, 0x1F83, 0x1F89, 0xA100, 0xA580};
  for (int step = 0; step < 3000 && !HasFatalFailure(); ++step) {
    switch (below(10)) {
      case 0:
        module.write_word(words[below(static_cast<std::uint32_t>(words.size()))],
                          static_cast<std::uint16_t>(random()), now);
        break;
      case 1: module.write_word(below(65536), static_cast<std::uint16_t>(random()), now); break;
      case 2: {  // a command that means something
        module.write_word(1000, commands[below(static_cast<std::uint32_t>(commands.size()))], now);
        module.write_word(1001, static_cast<std::uint16_t>(below(4) == 0 ? below(130) : 0), now);
        module.write_word(1002, indexes[below(static_cast<std::uint32_t>(indexes.size()))], now);
        module.write_word(1003, static_cast<std::uint16_t>(below(130)), now);
        module.write_word(1004, static_cast<std::uint16_t>(below(6)), now);
        module.write_word(1005, static_cast<std::uint16_t>(random()), now);
        module.set_output(0x17, true, now);
        break;
      }
      case 3: module.set_output(below(40), below(2) == 0, now); break;
      case 4: {
        can::Frame frame{
            .identifier = below(0x800), .remote = below(8) == 0, .dlc = static_cast<std::uint8_t>(below(9))};
        if (below(2) == 0)
          frame.identifier = std::array{0x000U, 0x080U, 0x100U, 0x67FU, 0x582U, 0x702U, 0x27FU}[below(7)];
        if (!frame.remote) {
          for (std::size_t i = 0; i < frame.length(); ++i)
            frame.data[i] = static_cast<std::uint8_t>(random());
        }
        module.receive(frame, now);
        break;
      }
      case 5: run_to(now + std::chrono::milliseconds(below(300))); break;
      case 6: run_to(now + std::chrono::microseconds(below(3000))); break;
      case 7: {
        bus.transmit_errors = static_cast<std::uint16_t>(below(10) == 0 ? below(257) : 0);
        module.controller_changed(now);
        bus.accepts = below(20) != 0;
        break;
      }
      case 8:
        if (below(20) == 0) {
          module.power_off(now);
          module.power_on(now);
        }
        module.cpu_changed(below(2) == 0 ? module::CpuState::run : module::CpuState::stop, now);
        break;
      default: static_cast<void>(module.program_read(below(65536), now)); break;
    }
    bus.sent.clear();
    for (const auto frames = std::exchange(bus.completing, {}); const can::Frame& frame : frames) {
      module.transmitted(frame, now);
    }
  }
  // With new flash memory content it is as good as new.
  module.power_off(now);
  memory.blobs.clear();
  bus.transmit_errors = 0;
  bus.accepts = true;
  module.power_on(now);
  run_to(now + 1s);
  EXPECT_EQ(module.program_read(25, now) & 0xFF7F, 0x0100);
  EXPECT_EQ(module.program_read(21, now), 405);
  EXPECT_EQ(module.program_read(29, now), 0);
}

// The same in the Layer 2 modes, with settings that are mostly good.
class RandomLayer2 : public testing::TestWithParam<unsigned> {};

TEST_P(RandomLayer2, NeverBreaksTheModule) {
  std::mt19937 random(GetParam());
  const auto below = [&](std::uint32_t limit) { return static_cast<std::uint32_t>(random() % limit); };
  RamMemory memory;
  FreeBus bus;
  module::me3can1_q::Me3can1Q module(bus, memory, {.restart_time = 100ms, .power_on_time = 10ms});
  const bool extended = GetParam() % 2 == 0;
  ASSERT_TRUE(module.preset_word(21, extended ? 29 : 11));
  can::Time now{};
  const auto run_to = [&](can::Time end) {
    for (unsigned ticks = 0; module.deadline() <= end; ++ticks) {
      ASSERT_LT(ticks, 100'000U) << "the deadline does not move on";
      now = std::max(now, module.deadline());
      module.tick(now);
    }
    now = end;
  };
  module.power_on(now);
  constexpr std::array<std::uint16_t, 8> likely{0, 1, 4, 0x0181, 0x5FFF, 0x6FFF, 0x7FFF, 0xFFFF};
  const auto value = [&] {
    return static_cast<std::uint16_t>(below(8) == 0 ? random() : likely[below(likely.size())]);
  };
  unsigned times_online = 0;
  for (int step = 0; step < 3000 && !HasFatalFailure(); ++step) {
    switch (below(10)) {
      case 0: module.write_word(6000 + below(170), value(), now); break;
      case 1: module.write_word(10000 + below(300), value(), now); break;
      case 2: module.write_word(8350 + below(130), value(), now); break;
      case 3: {  // a slot that is good
        const module::BufferAddress slot = below(42);
        module.write_word(6000 + 4 * slot, 0xFFFF, now);
        module.write_word(6001 + 4 * slot, likely[4 + below(4)], now);
        module.write_word(6002 + 4 * slot, static_cast<std::uint16_t>(below(5)), now);
        module.write_word(6003 + 4 * slot, static_cast<std::uint16_t>(below(3)), now);
        module.write_word(10000 + 7 * slot, 0x0181, now);
        module.write_word(10001 + 7 * slot, 0, now);
        module.write_word(10002 + 7 * slot, static_cast<std::uint16_t>(below(9)), now);
        break;
      }
      case 4:
        module.write_word(1000, static_cast<std::uint16_t>(below(3) == 0 ? random() : 0x000C), now);
        for (module::BufferAddress i = 1001; i < 1009; ++i) module.write_word(i, value(), now);
        module.set_output(0x17, true, now);
        break;
      case 5: {
        can::Frame frame{.identifier = 0x180 + below(3),
                         .extended = below(8) == 0 ? !extended : extended,
                         .remote = below(3) == 0,
                         .dlc = static_cast<std::uint8_t>(below(16))};
        for (std::size_t i = 0; i < frame.length(); ++i) frame.data[i] = static_cast<std::uint8_t>(below(2));
        for (std::uint32_t i = below(4) == 0 ? 20 : 1; i > 0; --i) module.receive(frame, now);
        break;
      }
      case 6: run_to(now + std::chrono::milliseconds(below(50))); break;
      case 7:
        bus.transmit_errors = static_cast<std::uint16_t>(below(10) == 0 ? below(257) : 0);
        bus.accepts = below(10) != 0;
        module.controller_changed(now);
        break;
      case 8: module.set_output(std::array{0x01U, 0x03U, 0x04U, 0x0FU}[below(4)], below(2) == 0, now); break;
      default:
        if (below(8) == 0) {  // settings that make no sense are thrown away
          module.set_output(0x03, false, now);
          for (module::BufferAddress slot = 0; slot < 42; ++slot) {
            module.write_word(6000 + 4 * slot, 0xFFFF, now);
            module.write_word(6001 + 4 * slot, 0xFFFF, now);
          }
          for (module::BufferAddress i = 8450; i < 8478; i += 7) {
            module.write_word(i, 0xFFFF, now);
            module.write_word(i + 1, 0xFFFF, now);
          }
        }
        if (below(20) == 0) {
          module.power_off(now);
          module.power_on(now);
        }
        module.cpu_changed(below(2) == 0 ? module::CpuState::run : module::CpuState::stop, now);
        break;
    }
    const bool online = (module.inputs() >> 3 & 1U) != 0;
    times_online += online ? 1 : 0;
    // One format, no more than 8 bytes, nothing while offline.
    for (const can::Frame& frame : bus.sent) {
      EXPECT_EQ(frame.extended, extended);
      EXPECT_LE(frame.dlc, 8);
      EXPECT_LE(frame.identifier, extended ? can::max_extended_identifier : can::max_base_identifier);
    }
    bus.sent.clear();
    for (const auto frames = std::exchange(bus.completing, {}); const can::Frame& frame : frames) {
      module.transmitted(frame, now);
    }
  }
  EXPECT_GT(times_online, 100U);
  module.power_off(now);
  memory.blobs.clear();
  bus.transmit_errors = 0;
  module.power_on(now);
  run_to(now + 1s);
  EXPECT_EQ(module.program_read(25, now), 0);
  EXPECT_EQ(module.program_read(21, now), extended ? 29 : 11);
  EXPECT_EQ(module.program_read(29, now), 0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomLayer2, testing::Range(1U, 11U));

INSTANTIATE_TEST_SUITE_P(Seeds, RandomAccess, testing::Range(1U, 21U));

}  // namespace
}  // namespace canopus::scenario::me3can1_q_random_test
