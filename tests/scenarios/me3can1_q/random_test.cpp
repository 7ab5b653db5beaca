// Whatever the PLC and the bus do to an ME3CAN1-Q: it answers, its time moves on, and a power cycle brings it
// back.

#include <random>

#include <gtest/gtest.h>

#include "scenarios/scenario.hpp"

namespace canopus::scenario {
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
      default: static_cast<void>(module.read_word(below(65536), now)); break;
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
  EXPECT_EQ(module.read_word(25, now) & 0xFF7F, 0x0100);
  EXPECT_EQ(module.read_word(21, now), 405);
  EXPECT_EQ(module.read_word(29, now), 0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomAccess, testing::Range(1U, 21U));

}  // namespace
}  // namespace canopus::scenario
