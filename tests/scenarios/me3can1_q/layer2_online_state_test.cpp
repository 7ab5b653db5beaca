// An ME3CAN1-Q in a Layer 2 mode on the simulated bus: frames take their time, wait, and win or lose
// arbitration.

#include <gtest/gtest.h>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "scenarios/scenario.hpp"

namespace canopus::scenario::me3can1_q_layer2_bus_test {
namespace {

// Notes the identifiers it hears.
struct Listener final : can::Participant {
  void receive(const can::Frame& frame, can::Time) override { heard.push_back(frame.identifier); }
  void tick(can::Time) override {}
  std::vector<std::uint32_t> heard;
};

// A module in 11-bit mode in a rack of its own at head 0, and a listener.
class Bench {
 public:
  explicit Bench(std::uint16_t kilobits) : bus_("line", kilobits * 1000U, timeline_) {
    timeline_.add(listener_);
    partner_.connect(listener_);
    port_.connect(module_);
    EXPECT_TRUE(rack_.insert(0, module_));
    EXPECT_TRUE(module_.preset_word(21, 11));
    EXPECT_TRUE(module_.preset_word(24, kilobits));
  }
  void power_on() {
    rack_.power_on(timeline_.now());
    run(2s);
  }
  void run(can::Duration duration) { timeline_.run_until(timeline_.now() + duration); }
  void write(module::BufferAddress first, const Words& words) {
    EXPECT_TRUE(rack_.write_buffer(0, first, words, timeline_.now()));
  }
  std::uint16_t read(module::BufferAddress address) {
    std::uint16_t word = 0;
    EXPECT_TRUE(rack_.read_buffer(0, address, {&word, 1}, timeline_.now()));
    return word;
  }
  void y(std::uint32_t number, bool on) {
    const std::uint8_t bit = on ? 1 : 0;
    EXPECT_TRUE(rack_.write_bits(plc::Device::y, number, {&bit, 1}, timeline_.now()));
  }
  bool x(unsigned number) const { return (module_.inputs() >> number & 1U) != 0; }
  void stop_cpu() { rack_.set_cpu_state(module::CpuState::stop, timeline_.now()); }
  /// Transmit slots 1 to `count` of type 0 with the identifiers from 100H on, 8 bytes each.
  void transmit_slots(std::uint16_t count, std::uint16_t type) {
    for (std::uint16_t slot = 0; slot < count; ++slot) {
      write(6000 + 4U * slot, {0xFFFF, 0x5FFF, type, 0});
      write(10000 + 7U * slot, {static_cast<std::uint16_t>(0x100 + slot), 0, 8});
    }
  }
  sim::Port& port() { return port_; }
  sim::Port& partner() { return partner_; }
  const std::vector<std::uint32_t>& heard() const { return listener_.heard; }

 private:
  can::Timeline timeline_;
  sim::Bus bus_;
  sim::Port& port_ = bus_.add_port("module");
  sim::Port& partner_ = bus_.add_port("partner");
  Listener listener_;
  RamMemory memory_;
  module::me3can1_q::Me3can1Q module_{port_, memory_};
  can::Timeline::Handle handle_ = timeline_.add(module_);
  plc::Rack rack_{timeline_};
};

TEST(Me3Layer2Bus, GoingOffline_TakesWaitingFramesBack) {
  RecordProperty("spec", "ME3-L2-009");
  Bench b(250);
  b.power_on();
  b.transmit_slots(42, 0);
  b.y(0x03, true);
  b.y(0x01, true);
  b.run(2300us);  // 1 ms to X01, then two frames of 0.5 ms and the beginning of a third
  b.y(0x03, false);
  EXPECT_FALSE(b.x(0x03));
  b.run(1s);
  EXPECT_EQ(b.heard(), (std::vector<std::uint32_t>{0x100, 0x101, 0x102}));  // the third was completed
  EXPECT_EQ(b.partner().receive_error_counter(), 0);
  EXPECT_EQ(b.read(29), 0);
  b.y(0x03, true);
  b.y(0x01, false);
  b.y(0x01, true);
  b.run(1s);
  EXPECT_EQ(b.heard().size(), 45U);
}

TEST(Me3Layer2Bus, GoingOffline_WithoutAPartner_EndsTheRepetitions) {
  RecordProperty("spec", "ME3-L2-009");
  Bench b(250);
  b.partner().plug(false);
  b.power_on();
  b.transmit_slots(2, 0);
  b.y(0x03, true);
  b.y(0x01, true);
  b.run(1s);
  EXPECT_EQ(b.read(35), 128);  // no node acknowledges
  b.y(0x03, false);
  b.run(1s);
  b.partner().plug(true);
  b.run(1s);
  EXPECT_TRUE(b.heard().empty());
}

TEST(Me3Layer2Bus, Trigger_X04ComesWhenTheLastMessageIsInTheBuffer) {
  RecordProperty("spec", "ME3-IO-011");
  Bench b(10);
  b.port().set_transmit_queue(sim::TransmitOrder::identifier, 4);
  b.power_on();
  b.transmit_slots(10, 4);
  b.y(0x03, true);
  b.write(8400, {0x03FF});
  b.y(0x04, true);
  EXPECT_EQ(b.read(8400), 0x03F0);  // four buffers
  EXPECT_FALSE(b.x(0x04));
  b.run(30ms);  // two frames of 11 to 14 ms have gone
  EXPECT_EQ(b.read(8400), 0x03C0);
  EXPECT_FALSE(b.x(0x04));
  b.run(1s);
  EXPECT_EQ(b.read(8400), 0);
  EXPECT_TRUE(b.x(0x04));
  EXPECT_EQ(b.heard(), (std::vector<std::uint32_t>{0x100, 0x101, 0x102, 0x103, 0x104, 0x105, 0x106, 0x107,
                                                   0x108, 0x109}));
  EXPECT_EQ(b.read(29), 0);
  b.y(0x04, false);
  EXPECT_FALSE(b.x(0x04));
}

TEST(Me3Layer2Bus, S52_RunToStopMessages_GoInTheirOrder_AlthoughY03GoesOffWithTheCpu) {
  RecordProperty("spec", "ME3-L2-040");
  Bench b(250);
  b.power_on();
  for (std::uint16_t message = 0; message < 4; ++message) {
    b.write(8450 + 7U * message, {static_cast<std::uint16_t>(0x400 - message), 0, 1});
  }
  b.y(0x03, true);
  b.run(1s);
  b.stop_cpu();
  EXPECT_FALSE(b.x(0x03));
  b.run(1s);
  EXPECT_EQ(b.heard(), (std::vector<std::uint32_t>{0x400, 0x3FF, 0x3FE, 0x3FD}));
}

// Other messages that wait, and would win arbitration against a later message of the four, do not change
// their order.
TEST(Me3Layer2Bus, RunToStopMessages_KeepTheirOrder_AmongOtherMessages) {
  RecordProperty("spec", "ME3-L2-040");
  Bench b(250);
  b.power_on();
  for (std::uint16_t message = 0; message < 4; ++message) {
    b.write(8450 + 7U * message, {static_cast<std::uint16_t>(0x400 - message), 0, 1});
  }
  b.transmit_slots(3, 0);
  b.y(0x03, true);
  b.y(0x01, true);
  b.run(1100us);  // the first of the three is on its way
  b.stop_cpu();
  b.run(1s);
  std::vector<std::uint32_t> stop_messages;
  for (const std::uint32_t identifier : b.heard()) {
    if (identifier > 0x300) stop_messages.push_back(identifier);
  }
  EXPECT_EQ(stop_messages, (std::vector<std::uint32_t>{0x400, 0x3FF, 0x3FE, 0x3FD}));
  EXPECT_EQ(b.heard().front(), 0x100U);
}

TEST(Me3Layer2Bus, S55_FramesWithoutDataAt1MbitPerSecond_OverflowASlot) {
  RecordProperty("spec", "ME3-L2-039 ME3-ERR-008");
  for (const std::uint8_t dlc : Bytes{8, 0}) {
    Bench b(1000);
    b.power_on();
    b.write(6000, {0x0181, 0, 0, 0});
    b.y(0x03, true);
    for (int i = 0; i < 100; ++i) b.partner().send({.identifier = 0x181, .dlc = dlc});
    b.run(1s);
    EXPECT_EQ(b.read(5001), dlc == 0 ? 0x2000 : 0);
    EXPECT_EQ(b.read(29), dlc == 0 ? 0x8000 : 0);
    EXPECT_EQ(b.x(0x0F), dlc == 0);
  }
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_layer2_bus_test
