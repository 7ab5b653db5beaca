// What CPU errors, a CPU reset and several CPUs do to a module in its rack.

#include <algorithm>

#include <gtest/gtest.h>

#include "canopus/module/models/me3can1_q/buffer_table.hpp"
#include "canopus/plc/melsec/session.hpp"

#include "scenarios/me3can1_q/rack_bench.hpp"

namespace canopus::scenario::me3can1_q_rack_fault_test {
namespace {

TEST(Me3RackFault, CpuErrorInARack_StopsTheCpu_AndIsToldByTheModule) {
  RecordProperty("spec", "ME3-EMCY-007");
  RackBench plc;
  plc.rack.fail_cpu(plc.timeline.now());
  EXPECT_EQ(plc.rack.cpu_state(), module::CpuState::stop);
  const auto& objects = plc.module.node().dictionary();
  EXPECT_EQ(objects.get<std::uint32_t>(0x1003, 1) & 0xFFFF, 0xFF00U);
  EXPECT_EQ(objects.get<std::uint8_t>(0x1003, 0), 1);
}

// Words that a program can write get other values; G70 is saved. A CPU reset brings every word back to its
// default, or to what is saved.
TEST(Me3RackFault, CpuReset_BringsEveryWordToItsDefault_OrItsSavedValue) {
  RecordProperty("spec", "ME3-SYS-018");
  RackBench plc;
  std::map<module::BufferAddress, std::uint16_t> before;
  for (const auto& row : module::me3can1_q::buffer_table) {
    if ((row.modes & module::me3can1_q::canopen_405) == 0) continue;
    for (auto address = row.first; address <= row.last; address += row.stride)
      before[address] = plc.g(address);
  }
  plc.g(70, 1234);
  plc.g(22, 1);
  plc.y(0x1F, true);
  plc.run(1s);
  plc.y(0x1F, false);
  for (const auto& [address, value] : before) {
    if (address == 22 || address == 29) continue;
    plc.g(address, address == 21 ? 29 : address == 24 ? 500 : address == 27 ? 5 : 60);
  }
  EXPECT_EQ(plc.g(13000), 60);
  EXPECT_EQ(plc.g(71), 60);
  plc.g(27, 200);  // G29.6, G39
  EXPECT_NE(plc.g(29), 0);
  plc.rack.reset_cpu(plc.timeline.now());
  plc.run(2s);
  before[70] = 1234;
  for (const auto& [address, value] : before) EXPECT_EQ(plc.g(address), value) << "G" << address;
}

// MC protocol requests name the CPU they are for: 03FFH and 03E0H are the control CPU, 03E1H to 03E3H CPUs 2
// to 4.
TEST(Me3RackFault, OnlyTheControlCpu_WritesTheModule) {
  RecordProperty("spec", "ME3-SYS-008");
  RackBench plc;
  // 1401/0080: G70 = `value` of the module in slot 0, through the CPU with this module I/O number.
  const auto write_g70 = [&](std::uint16_t cpu, std::uint8_t value) {
    const Bytes request{0x50,
                        0x00,
                        0x00,
                        0xFF,
                        static_cast<std::uint8_t>(cpu & 0xFF),
                        static_cast<std::uint8_t>(cpu >> 8),
                        0x00,
                        0x15,
                        0x00,
                        0x10,
                        0x00,
                        0x01,
                        0x14,
                        0x80,
                        0x00,
                        0x00,
                        0x00,
                        0x46,
                        0x00,
                        0x00,
                        0xAB,
                        0x00,
                        0x00,
                        0x00,
                        0x00,
                        0xF8,
                        0x01,
                        0x00,
                        value,
                        0x00};
    plc::melsec::Session session(plc.rack);
    std::ranges::copy(request, session.space().begin());
    session.received(request.size());
    EXPECT_EQ(session.process(plc.timeline.now()), 1U);
    return session.output()[9] | session.output()[10] << 8;  // end code
  };
  EXPECT_EQ(write_g70(0x03FF, 11), 0);
  EXPECT_EQ(plc.g(70), 11);
  EXPECT_EQ(write_g70(0x03E0, 12), 0);
  EXPECT_EQ(plc.g(70), 12);
  for (const std::uint16_t other : Words{0x03E1, 0x03E2, 0x03E3}) {
    EXPECT_EQ(write_g70(other, 13), 0xC05F);
    EXPECT_EQ(plc.g(70), 12);
  }
}

// No way in or out while the rack has supply.
TEST(Me3RackFault, NoModuleChange_WhileTheRackIsOn) {
  RecordProperty("spec", "ME3-SYS-007");
  RackBench plc;
  RamMemory memory;
  FreeBus controller;
  module::me3can1_q::Me3can1Q other(controller, memory);
  plc.timeline.add(other);
  EXPECT_FALSE(plc.rack.insert(0x40, other));
  EXPECT_EQ(plc.rack.module_at(0x40), nullptr);
  plc.rack.power_off(plc.timeline.now());
  EXPECT_TRUE(plc.rack.insert(0x40, other));
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_rack_fault_test
