// ME3CAN1-Q modules in a rack and on the simulated bus: addressing, two modules with each other, bus errors.

#include "canopus/sim/bus/bus.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"
#include "canopus/plc/melsec/session.hpp"
#include "canopus/plc/rack/rack.hpp"

#include "scenarios/scenario.hpp"

namespace canopus::scenario::me3can1_q_bus_test {
namespace {

using module::me3can1_q::Me3can1Q;

// A Q CPU with modules at heads of 32 points, all on one bus of 250 kbit/s.
class Plant {
 public:
  struct Slot {
    RamMemory memory;
    sim::Port* port = nullptr;
    std::unique_ptr<Me3can1Q> module;
    std::uint16_t head = 0;
  };

  Slot& add(std::uint16_t head,
            const std::vector<std::pair<module::BufferAddress, std::uint16_t>>& words = {},
            const std::vector<std::tuple<std::uint16_t, std::uint8_t, Bytes>>& objects = {},
            bool in_rack = true) {
    Slot& slot = *slots_.emplace_back(std::make_unique<Slot>());
    slot.port = &bus_.add_port("port" + std::to_string(slots_.size()));
    slot.module = std::make_unique<Me3can1Q>(*slot.port, slot.memory);
    slot.head = head;
    for (const auto& [address, value] : words) EXPECT_TRUE(slot.module->preset_word(address, value));
    for (const auto& [index, sub, value] : objects) {
      EXPECT_EQ(slot.module->preset_object(index, sub, value), canopen::AbortCode::none) << std::hex << index;
    }
    timeline_.add(*slot.module);
    slot.port->connect(*slot.module);
    if (in_rack) {
      EXPECT_TRUE(rack_.insert(head, *slot.module));
    }
    return slot;
  }
  void power_on() { rack_.power_on(timeline_.now()); }
  /// One in a rack of its own.
  void power_on(Slot& slot) { slot.module->power_on(timeline_.now()); }
  void power_off(Slot& slot) { slot.module->power_off(timeline_.now()); }
  void run(can::Duration duration) { timeline_.run_until(timeline_.now() + duration); }

  std::uint16_t g(const Slot& slot, module::BufferAddress address) {
    std::uint16_t word = 0;
    EXPECT_TRUE(rack_.read_buffer(slot.head, address, {&word, 1}, timeline_.now()));
    return word;
  }
  void g(const Slot& slot, module::BufferAddress address, std::uint16_t value) {
    EXPECT_TRUE(rack_.write_buffer(slot.head, address, {&value, 1}, timeline_.now()));
  }
  bool x(std::uint32_t number) {
    std::uint8_t bit = 0;
    EXPECT_TRUE(rack_.read_bits(plc::Device::x, number, {&bit, 1}, timeline_.now()));
    return bit != 0;
  }
  void y(std::uint32_t number, bool on) {
    const std::uint8_t bit = on ? 1 : 0;
    EXPECT_TRUE(rack_.write_bits(plc::Device::y, number, {&bit, 1}, timeline_.now()));
  }
  void exchange(const Slot& slot) {
    y(slot.head + 1U, true);
    run(1ms);
    EXPECT_TRUE(x(slot.head + 1U));
    y(slot.head + 1U, false);
  }
  plc::Rack& rack() { return rack_; }
  can::Time now() const { return timeline_.now(); }

 private:
  can::Timeline timeline_;
  sim::Bus bus_{"line", 250'000, timeline_};
  std::vector<std::unique_ptr<Slot>> slots_;
  plc::Rack rack_{timeline_};
};

TEST(Me3Rack, S01_HeadAddress) {
  RecordProperty("spec", "ME3-SYS-002 ME3-SYS-003");
  Plant plant;
  Plant::Slot& slot = plant.add(0x40);
  RamMemory memory;
  FreeBus controller;
  Me3can1Q other(controller, memory);
  EXPECT_FALSE(plant.rack().insert(0x50, other));  // 32 points: 40H to 5FH
  EXPECT_EQ(plant.rack().module_at(0x40), slot.module.get());
  plant.power_on();
  EXPECT_FALSE(plant.x(0x40));
  plant.run(1s);
  EXPECT_TRUE(plant.x(0x40));
  for (std::uint32_t number = 0; number < 0x80; ++number)
    EXPECT_EQ(plant.x(number), number == 0x40) << number;
  slot.module->receive(can::data_frame(0x085, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0}), plant.now());
  EXPECT_TRUE(plant.x(0x51));
  plant.y(0x42, true);
  EXPECT_EQ(plant.g(slot, 25) & 0x80, 0x80);
}

TEST(Me3Rack, S02_BufferMemory_OfTheHeadAddress) {
  RecordProperty("spec", "ME3-SYS-004 ME3-SYS-005");
  Plant plant;
  Plant::Slot& slot = plant.add(0x30);
  Plant::Slot& other = plant.add(0x50);
  plant.power_on();
  plant.run(1s);
  plant.g(slot, 70, 0x8001);
  EXPECT_EQ(plant.g(slot, 70), 0x8001);
  EXPECT_EQ(slot.module->program_read(70, plant.now()), 0x8001);
  EXPECT_EQ(plant.g(slot, 11), 0);
  // The device U3\G70, by MC protocol (0401/0080, 1401/0080), is the same word, and of no other module.
  const auto u3_g70 = [&](const Bytes& command, const Bytes& data) {
    Bytes request{0x50, 0x00, 0x00, 0xFF, 0xFF, 0x03, 0x00, static_cast<std::uint8_t>(19 + data.size()),
                  0x00, 0x10, 0x00};
    request.insert(request.end(), command.begin(), command.end());
    const Bytes device{0x80, 0x00, 0x00, 0x00, 70,   0x00, 0x00, 0xAB,
                       0x00, 0x00, 0x03, 0x00, 0xF8, 0x01, 0x00};
    request.insert(request.end(), device.begin(), device.end());
    request.insert(request.end(), data.begin(), data.end());
    plc::melsec::Session session(plant.rack());
    std::ranges::copy(request, session.space().begin());
    session.received(request.size());
    EXPECT_EQ(session.process(plant.now()), 1U);
    const auto answer = session.output();
    EXPECT_EQ(answer[9] | answer[10] << 8, 0);  // end code
    return answer.size() >= 13 ? answer[11] | answer[12] << 8 : 0;
  };
  u3_g70({0x01, 0x14}, {0x34, 0x12});
  EXPECT_EQ(plant.g(slot, 70), 0x1234);
  EXPECT_EQ(plant.g(other, 70), 500);
  plant.g(slot, 70, 0x8001);
  EXPECT_EQ(u3_g70({0x01, 0x04}, {}), 0x8001);
}

Bytes u32(std::uint32_t value) {
  return {static_cast<std::uint8_t>(value & 0xFF), static_cast<std::uint8_t>(value >> 8 & 0xFF),
          static_cast<std::uint8_t>(value >> 16 & 0xFF), static_cast<std::uint8_t>(value >> 24)};
}

TEST(Me3OnABus, MasterAndSlave_BootAndExchangeProcessData) {
  Plant plant;
  Plant::Slot& master = plant.add(0x00, {{27, 1}},
                                  {{0x1F80, 0, u32(1)},
                                   {0x1F81, 2, u32(0x0D)},
                                   {0x1F84, 2, u32(0x195)},
                                   {0x1F85, 2, u32(0x71)},
                                   {0x1F86, 2, u32(0xED63)},
                                   {0x1F89, 0, u32(10000)},
                                   {0x1016, 1, u32(0x000200C8)},
                                   {0x1400, 1, u32(0x182)}});
  Plant::Slot& slave = plant.add(0x20, {{27, 2}}, {{0x1017, 0, Bytes{100, 0}}, {0x1400, 1, u32(0x181)}});
  plant.power_on();
  plant.run(4s);
  EXPECT_EQ(plant.g(master, 25), 0x8201);
  EXPECT_EQ(plant.g(slave, 25) & 0x0301, 0x0201);
  EXPECT_EQ(plant.g(master, 601), 5);
  EXPECT_EQ(plant.g(master, 602), 5);
  EXPECT_EQ(plant.g(master, 402), 0x0002);

  plant.g(slave, 13000, 0x1234);
  plant.g(slave, 13003, 0x5678);
  plant.exchange(slave);
  plant.run(10ms);
  plant.exchange(master);
  EXPECT_EQ(plant.g(master, 10000), 0x1234);
  EXPECT_EQ(plant.g(master, 10003), 0x5678);
  plant.g(master, 13001, 0xBEEF);
  plant.exchange(master);
  plant.run(10ms);
  plant.exchange(slave);
  EXPECT_EQ(plant.g(slave, 10001), 0xBEEF);

  // The slave restarts: its heartbeat goes missing, it boots again.
  plant.y(0x22, true);
  plant.run(1s);
  EXPECT_TRUE(plant.x(0x10));
  EXPECT_EQ(plant.g(master, 402) & 0x80, 0x80);
  EXPECT_TRUE(plant.x(0x11));  // the emergency of the restart
  plant.exchange(master);
  EXPECT_EQ(plant.g(master, 751), 0x6200);
  plant.run(5200ms);
  EXPECT_TRUE(plant.x(0x22));
  plant.y(0x22, false);
  plant.run(5s);
  EXPECT_EQ(plant.g(slave, 25) & 0x0301, 0x0201);
  EXPECT_EQ(plant.g(master, 602), 5);
}

TEST(Me3OnABus, AloneOnTheBus_CountsUpByEightToErrorPassive_AndDownByOnePerGoodFrame) {
  RecordProperty("spec", "ME3-CNT-001");
  Plant plant;
  Plant::Slot& one = plant.add(0x00, {{27, 1}}, {{0x1017, 0, Bytes{100, 0}}});
  plant.power_on();
  std::uint16_t before = 0;
  std::vector<std::uint16_t> seen;
  for (int step = 0; step < 40'000 && seen.size() < 16; ++step) {
    plant.run(50us);
    const std::uint16_t counter = plant.g(one, 35);
    if (counter != before) seen.push_back(counter);
    before = counter;
  }
  EXPECT_EQ(seen, (Words{8, 16, 24, 32, 40, 48, 56, 64, 72, 80, 88, 96, 104, 112, 120, 128}));
  EXPECT_EQ(plant.g(one, 29), 0x4000);
  plant.run(10s);
  EXPECT_EQ(plant.g(one, 35), 128);  // no node acknowledges: not bus-off

  Plant::Slot& two = plant.add(0x20, {{27, 2}}, {}, false);  // in a rack of its own
  plant.power_on(two);
  plant.run(1500ms);
  before = plant.g(one, 35);
  EXPECT_LT(before, 128);
  EXPECT_EQ(plant.g(one, 29), 0);
  plant.run(100ms);
  EXPECT_EQ(plant.g(one, 35), before - 1);
  plant.run(1s);
  EXPECT_EQ(plant.g(one, 35), before - 11);
  plant.run(60s);
  EXPECT_EQ(plant.g(one, 35), 0);
}

// Off, in its start and in a restart it is as if it were not on the wire: nobody else is there who could acknowledge.
// The frame that one's controller keeps sending until somebody does is its heartbeat.
TEST(Me3OnABus, WithoutSupplyAndWhileItStarts_ItAcknowledgesNothing) {
  Plant plant;
  Plant::Slot& one = plant.add(0x00, {{27, 1}}, {{0x1017, 0, Bytes{100, 0}}});
  Plant::Slot& two = plant.add(0x20, {{27, 2}}, {}, false);
  const auto nobody_acknowledges = [&](can::Duration duration) {
    const std::uint64_t before = one.port->counters().transmitted;
    plant.run(duration);
    return one.port->counters().transmitted == before;
  };
  plant.power_on();
  EXPECT_TRUE(nobody_acknowledges(3s));  // it is off
  EXPECT_EQ(one.port->error_state(), can::ErrorState::error_passive);
  plant.power_on(two);
  EXPECT_TRUE(nobody_acknowledges(999ms));  // it starts
  EXPECT_FALSE(nobody_acknowledges(5ms));
  plant.power_off(two);
  plant.run(1ms);  // a frame that has been acknowledged may end
  EXPECT_TRUE(nobody_acknowledges(1s));
}

TEST(Me3OnABus, InARestart_ItSaysSoAndIsSilent) {
  Plant plant;
  Plant::Slot& one = plant.add(0x00, {{27, 1}});
  Plant::Slot& two = plant.add(0x20, {{27, 2}}, {{0x1017, 0, Bytes{100, 0}}}, false);
  plant.power_on();
  plant.power_on(two);
  plant.run(2s);
  ASSERT_EQ(plant.g(one, 29), 0);
  plant.y(0x02, true);  // one restarts
  plant.run(1ms);
  EXPECT_NE(two.module->signals()->inputs() >> 0x11 & 1U, 0U);  // its emergency message
  const std::uint64_t sent = two.port->counters().transmitted;
  plant.y(0x02, false);
  plant.run(5990ms);
  EXPECT_EQ(two.port->counters().transmitted, sent);
  EXPECT_EQ(two.port->error_state(), can::ErrorState::error_passive);
  plant.run(20ms);
  EXPECT_GT(two.port->counters().transmitted, sent);
}

TEST(Me3OnABus, WrongBaudRate_DrivesTheCountersUp) {
  RecordProperty("spec", "ME3-BAUD-006");
  Plant plant;
  Plant::Slot& one = plant.add(0x00, {{27, 1}}, {{0x1017, 0, Bytes{10, 0}}});
  plant.add(0x40, {{27, 3}}, {{0x1017, 0, Bytes{10, 0}}});
  // Two on each side, so that neither is silenced before the other has met errors.
  Plant::Slot& wrong = plant.add(0x20, {{27, 2}, {24, 500}}, {{0x1017, 0, Bytes{10, 0}}});
  plant.add(0x60, {{27, 4}, {24, 500}}, {{0x1017, 0, Bytes{10, 0}}});
  plant.power_on();
  std::uint16_t highest_of_wrong = 0, highest_of_one = 0;
  unsigned shown_by_wrong = 0, shown_by_one = 0;
  for (int moment = 0; moment < 1200; ++moment) {
    plant.run(1ms);
    highest_of_wrong = std::max({highest_of_wrong, plant.g(wrong, 35), plant.g(wrong, 36)});
    highest_of_one = std::max({highest_of_one, plant.g(one, 35), plant.g(one, 36)});
    shown_by_wrong |= plant.g(wrong, 29);
    shown_by_one |= plant.g(one, 29);
  }
  // Both sides destroy each other's frames; who is bus-off first depends on the rates and on who has more to send.
  constexpr unsigned passive_or_bus_off = 0x4008;
  EXPECT_GE(highest_of_wrong, 128);
  EXPECT_GE(highest_of_one, 128);
  EXPECT_NE(shown_by_wrong & passive_or_bus_off, 0U);
  EXPECT_NE(shown_by_one & passive_or_bus_off, 0U);
  EXPECT_EQ(plant.g(wrong, 37), 5000);
}

TEST(Me3OnABus, S82_ExchangingFasterThanTheBusCarries_OverflowsTheQueue) {
  RecordProperty("spec", "ME3-DX-011");
  Plant plant;
  Plant::Slot& one = plant.add(0x00, {{27, 1}, {24, 10}});
  plant.add(0x20, {{27, 2}, {24, 10}});
  plant.power_on();
  plant.run(2s);
  one.module->receive(can::data_frame(0x000, {0x01, 0x01}), plant.now());
  EXPECT_EQ(plant.g(one, 29), 0);
  for (std::uint16_t i = 1; i <= 500; ++i) {
    for (module::BufferAddress word = 13000; word < 13016; ++word) plant.g(one, word, i);
    plant.exchange(one);
  }
  EXPECT_EQ(plant.g(one, 29) & 0x0100, 0x0100);
  EXPECT_TRUE(plant.x(0x0F));
  plant.run(60s);
  EXPECT_EQ(plant.g(one, 29) & 0x0100, 0x0100);
  plant.y(0x0F, true);
  EXPECT_EQ(plant.g(one, 29), 0);
  EXPECT_FALSE(plant.x(0x0F));
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_bus_test
