// Error counters on a real bus, and where a user looks for the cause of an error [ME3CAN1-Q 8.1].

#include <algorithm>

#include <gtest/gtest.h>

#include "scenarios/me3can1_q/rack_bench.hpp"

namespace canopus::scenario::me3can1_q_error_counters_test {
namespace {

CANOPUS_OF_BOTH_MODULES(ErrorCounters);

using module::LedPattern;

// --- error counters on a real bus, and where they are shown

TEST_P(ErrorCounters, S81_CountersAndTheirIndications) {
  spec("ME3-CNT-003", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.error_counters(95, 0);
  s.expect(35, 95).expect_bit(25, 1, false);
  EXPECT_EQ(led(s, "CAN ERR"), LedPattern::off);
  for (const auto& [transmit, receive] : {std::pair{96, 0}, std::pair{0, 96}, std::pair{127, 127}}) {
    s.error_counters(static_cast<std::uint16_t>(transmit), static_cast<std::uint16_t>(receive));
    s.expect_bit(25, 1, true).expect_bit(29, 14, false);
    EXPECT_EQ(led(s, "CAN ERR"), LedPattern::single_flash);
  }
  s.no_tx();
  s.error_counters(128, 0);
  s.expect(35, 128).expect_bit(25, 1, false).expect(29, 0x4000).expect_x(0x0F, false);
  s.tx(0x0FF, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.error_counters(256, 0);
  s.expect(35, 256)
      .expect(36, 256)
      .expect_bit(29, 3, true)
      .expect_bit(29, 14, false)
      .expect_bit(25, 1, false);
  EXPECT_EQ(led(s, "CAN ERR"), LedPattern::on);
  s.cif({0x0004, 2, 0x1000, 0});
  s.expect(1000, {0x000F, 0xB0FF});
  s.ignore_tx();
  s.error_counters(127, 0);
  s.expect_bit(29, 14, false);
  s.ignore_tx();
}

// One receiver with a fault on its line: the module, among a sender and another receiver.
struct FaultyReceiver {
  RackBench plc;
  sim::Station sender{plc.bus, plc.timeline, "sender"};
  const can::Frame frame = can::data_frame(0x123, {0x55});

  // The module reads bit 22, a data bit, wrongly in the next `count` frames.
  void disturb(std::uint64_t count) {
    ASSERT_TRUE(plc.bus.set_faults({{{.kind = sim::FaultKind::corrupt,
                                      .sender = "sender",
                                      .count = count,
                                      .receiver = "module",
                                      .bit = 22}}},
                                   1));
  }
  void send() {
    sender.port.send(frame);
    plc.run(20ms);
  }
  // How often the other receiver has heard the frame.
  [[nodiscard]] std::size_t heard() const {
    return static_cast<std::size_t>(std::ranges::count(plc.other.frames(), frame));
  }
};

TEST_P(ErrorCounters, ReceiveErrorCounter_GoesUpByEight_DownByOne_AndShowsAtMost128) {
  spec("ME3-CNT-002", "");
  FaultyReceiver bench;
  EXPECT_EQ(bench.plc.g(36), 0);
  bench.disturb(1);
  bench.send();
  // 1 for the error it saw, 8 for the answer to its error flag; then the frame came again, and well.
  EXPECT_EQ(bench.plc.g(36), 8);
  for (std::uint16_t good = 1; good <= 8; ++good) {
    bench.send();
    EXPECT_EQ(bench.plc.g(36), 8 - good);
  }
  bench.send();
  EXPECT_EQ(bench.plc.g(36), 0);
  bench.disturb(14);
  bench.send();
  EXPECT_EQ(bench.plc.g(36), 14 * 9 - 1);
  EXPECT_EQ(bench.plc.g(25) & 2, 2);
  bench.disturb(100);
  for (int frame = 0; frame < 5; ++frame) bench.send();
  EXPECT_GT(bench.plc.port.receive_error_counter(), 128);
  EXPECT_EQ(bench.plc.g(36), 128);
  EXPECT_EQ(bench.plc.g(29), 0x4000);
}

// Every frame of the module is disturbed until it is bus-off. The disturbance ends and the bus is free, but
// only a restart brings the module back; the error counter and the bit go with it.
TEST(Me3ErrorCounters, BusOffOnTheBus_IsLeftByARestartAlone) {
  RecordProperty("spec", "ME3-ERR-002 ME3-CNT-001 ME3-EMCY-009");
  RackBench plc;
  const Words heartbeat{0x0002, 0, 0x1017, 0, 2, 100};  // 1017H = 100 ms, by the CIF
  EXPECT_TRUE(plc.rack.write_buffer(0, 1000, heartbeat, plc.timeline.now()));
  plc.y(0x17, true);
  plc.run(1s);
  EXPECT_EQ(plc.g(1000), 0x0003);
  const auto heard = [&] { return plc.other.frames().size(); };
  EXPECT_GT(heard(), 5U);
  ASSERT_TRUE(plc.bus.set_faults(
      {{{.kind = sim::FaultKind::corrupt, .sender = "module", .count = 32, .bit = 22}}}, 1));
  plc.run(3s);
  EXPECT_EQ(plc.g(29), 0x0008);
  EXPECT_EQ(plc.g(35), 256);
  EXPECT_EQ(plc.g(36), 256);
  const std::size_t before = heard();
  plc.run(10s);  // 128 times 11 bits are 6 ms
  EXPECT_EQ(heard(), before);
  EXPECT_EQ(plc.g(29) & 0x4008, 0x0008);  // its queue may be full by now: bit 8
  EXPECT_EQ(plc.g(35), 256);
  plc.y(0x0F, true);
  EXPECT_EQ(plc.g(29), 0x0008);
  plc.y(0x0F, false);
  plc.y(0x02, true);
  plc.run(6100ms);
  plc.y(0x02, false);
  EXPECT_EQ(plc.g(29), 0);
  EXPECT_EQ(plc.g(35), 0);
  EXPECT_EQ(heard(), before + 1);  // the boot-up message
}

TEST_P(ErrorCounters, ErrorActiveModule_DestroysAFaultyFrame_ErrorPassiveOneDoesNot) {
  spec("ME3-CNT-004", "");
  FaultyReceiver bench;
  bench.disturb(1);
  bench.sender.port.send(bench.frame);
  bench.plc.run(300us);  // 53 bits of 4 us: the frame would be over
  EXPECT_EQ(bench.heard(), 0U);
  EXPECT_EQ(bench.sender.port.transmit_error_counter(), 8);
  bench.plc.run(20ms);
  EXPECT_EQ(bench.heard(), 1U);  // sent again
  bench.disturb(100);
  bench.send();  // destroyed until the module is error passive
  EXPECT_EQ(bench.plc.g(29), 0x4000);
  EXPECT_EQ(bench.heard(), 2U);
  const std::uint16_t before = bench.sender.port.transmit_error_counter();
  bench.sender.port.send(bench.frame);
  bench.plc.run(300us);
  EXPECT_EQ(bench.heard(), 3U);  // at once, though the module read it wrongly
  EXPECT_EQ(bench.sender.port.transmit_error_counter(), before - 1);
}

// --- troubleshooting

TEST(Me3ErrorCounters, ErrorSearch_LedsThenG29ThenAddressesThenNodes) {
  RecordProperty("spec", "ME3-DIAG-001");
  IntelligentScenario s;
  s.power_on_as(1);
  EXPECT_EQ(led(s, "ERR."), LedPattern::off);
  s.write(27, 0);  // an invalid value
  EXPECT_EQ(led(s, "ERR."), LedPattern::on);
  EXPECT_EQ(led(s, "CAN ERR"), LedPattern::blinking);
  s.expect(29, 0x0040).expect(39, 27).expect(40, 0);
  s.write(29, 0);
  EXPECT_EQ(led(s, "ERR."), LedPattern::off);
  s.set_object(0x1016, 1, 0x00020064, 4);  // a node that falls silent
  s.rx(0x702, {0x05});
  s.advance(200ms);
  EXPECT_EQ(led(s, "CAN ERR"), LedPattern::double_flash);
  s.expect(29, 0).expect_bit(402, 7, true).expect_bit(403, 7, false).expect_x(0x10, true);
  s.ignore_tx();
  s.supply_off();  // a write during initialization
  s.supply_on();
  s.write(24, 500);
  EXPECT_EQ(led(s, "ERR."), LedPattern::on);
  s.expect(29, 0x0020).expect(39, 0).expect(40, 24);
  s.wait_bit(25, 7, false);
  s.ignore_tx();
}

// Every code of table 8-5 that a slave sends arrives in G1003/G1004, and so does one that is in no table.
TEST(Me3ErrorCounters, EverySdoAbortCode_IsShownUnchanged) {
  RecordProperty("spec", "ME3-DIAG-002");
  const std::vector<std::uint32_t> codes{
      0x05030000, 0x05040000, 0x05040001, 0x05040002, 0x05040003, 0x05040004, 0x05040005,
      0x06010000, 0x06010001, 0x06010002, 0x06020000, 0x06040041, 0x06040042, 0x06040043,
      0x06040047, 0x06060000, 0x06070010, 0x06070012, 0x06070013, 0x06090011, 0x06090030,
      0x06090031, 0x06090032, 0x06090036, 0x060A0023, 0x08000000, 0x08000020, 0x08000021,
      0x08000022, 0x08000023, 0x08000024, 0x12345678, 0xFFFFFFFF};
  IntelligentScenario s;
  s.power_on_as(1);
  for (const std::uint32_t code : codes) {
    s.write(1000, {0x0004, 2, 0x1000, 0});
    s.y(0x17, true);
    s.wait_tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    s.rx(0x582, {0x80, 0x00, 0x10, 0x00, static_cast<std::uint8_t>(code & 0xFF),
                 static_cast<std::uint8_t>(code >> 8 & 0xFF), static_cast<std::uint8_t>(code >> 16 & 0xFF),
                 static_cast<std::uint8_t>(code >> 24)});
    s.wait_x(0x17, true);
    s.y(0x17, false);
    s.expect(1000, {0x000F, 0x0003, 2, static_cast<std::uint16_t>(code & 0xFFFF),
                    static_cast<std::uint16_t>(code >> 16)});
  }
  // The two codes of its own: an object too long for the command interface, and a node that cannot be.
  s.cif({0x0004, 200, 0x1000, 0});
  s.expect(1003, {0x0000, 0x5000});
  s.cif({0x0002, 0, 0x1F22, 2, 124, 1, 2, 3});
  s.expect(1000, 0x0003);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_error_counters_test
