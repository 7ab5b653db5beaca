// Emergency messages belong to Pre-operational and Operational: none comes before the boot-up message [RJ71CN91 1.2 NMT
// state, 1.7, App. 4].

#include "canopus/sim/bus/bus.hpp"

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_boot_up_order_test {
namespace {

using namespace rj71cn91_presets;

constexpr auto stop = module::CpuState::stop;
const can::Frame boot_up = can::data_frame(0x703, Bytes{0x00});
const Bytes me002{0x00, 0xFF, 0x81, 0x4D, 0x45, 0x30, 0x30, 0x32};

/// A node 3 whose CPU is in STOP; its boot-up message waits for an acknowledgement. `reset`: of an NMT reset, which has these
/// bytes; else of the start.
void wait_for_boot_up(IntelligentScenario& s, std::uint8_t error_behaviour, const Bytes& reset) {
  ASSERT_TRUE(s.plug_in().preset_node_id(3));
  ASSERT_EQ(s.plug_in().preset_object(0x1029, 1, Bytes{error_behaviour}), canopen::AbortCode::none);
  s.cpu(stop).supply_on();
  if (!reset.empty()) s.advance(5s).ignore_tx().rx(0x000, reset);
  s.controller().completes = false;
  s.advance(5s).tx(boot_up).no_tx().expect(603, 0x7F);
}

void acknowledge(IntelligentScenario& s) {
  s.controller().completes = true;
  s.controller().completing.push_back(boot_up);
  s.advance(0s);
}

TEST(Rj71BootUp, MessageOfStop_WaitsForIt_HoweverLongThatTakes) {
  RecordProperty("spec", "RJ71-EMCY-024 RJ71-EMCY-003 RJ71-CPU-002");
  for (const std::uint8_t behaviour : Bytes{0, 1, 2}) {
    for (const Bytes& reset : {Bytes{}, Bytes{0x82, 0x03}, Bytes{0x81, 0x00}}) {
      IntelligentScenario s(rj71cn91);
      wait_for_boot_up(s, behaviour, reset);
      acknowledge(s);
      s.tx(0x083, me002).no_tx().expect(603, behaviour == 2 ? 0x04 : 0x7F).advance(5s).no_tx();
    }
  }
}

TEST(Rj71BootUp, EveryMessage_WaitsForIt) {
  RecordProperty("spec", "RJ71-EMCY-024");
  IntelligentScenario s(rj71cn91);
  wait_for_boot_up(s, 0, {});
  s.error_counters(128, 0).advance(5s).no_tx();
  acknowledge(s);
  s.tx(0x083, {0x20, 0x81, 0x11, 0, 0, 0, 0, 0}).tx(0x083, {0x00, 0xFF, 0x91, 0x4D, 0x45, 0x30, 0x30, 0x32});
  s.no_tx();
  // The CPU stops while it waits: the state changes at once.
  IntelligentScenario running(rj71cn91);
  ASSERT_TRUE(running.plug_in().preset_node_id(3));
  running.controller().completes = false;
  running.supply_on().advance(5s).tx(boot_up).rx(0x000, {0x01, 0x03}).expect(603, 0x05);
  running.cpu(stop).no_tx().expect(603, 0x7F);
  acknowledge(running);
  running.tx(0x083, me002).no_tx();
}

TEST(Rj71BootUp, WithoutRoomForIt_NothingWaits) {
  RecordProperty("spec", "RJ71-EMCY-024");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(3);
  s.controller().accepts = false;
  s.nmt(0x82, 3).advance(20ms).no_tx();
  s.controller().accepts = true;
  s.cpu(stop).advance(10ms);
  EXPECT_FALSE(s.controller().sent.empty());
  s.ignore_tx();
}

// A controller sends what waits by priority: on the wire, too, the boot-up message is the first one.
TEST(Rj71BootUp, IsTheFirstFrameOnTheWire) {
  RecordProperty("spec", "RJ71-EMCY-024 RJ71-NMT-001");
  struct Partner : can::Listener {
    void receive(const can::Frame& frame, can::Time) override { frames.push_back(frame); }
    std::vector<can::Frame> frames;
  } partner;
  can::Timeline timeline;
  sim::Bus bus("field", 500'000, timeline);
  sim::Port& own = bus.add_port("module");
  sim::Port& other = bus.add_port("partner");
  RamMemory memory;
  const auto module = make_module(rj71cn91, own, memory);
  module->preset_bit_rate(500'000);
  module->preset_node_id(3);
  timeline.add(*module);
  own.connect(*module);
  other.connect(partner);
  module->cpu_changed(stop, timeline.now());
  module->power_on(timeline.now());
  timeline.run_until(timeline.now() + 2s);
  EXPECT_EQ(partner.frames, (std::vector<can::Frame>{boot_up, can::data_frame(0x083, me002)}));
  partner.frames.clear();
  other.send(can::data_frame(0x000, Bytes{0x81, 0x03}));
  timeline.run_until(timeline.now() + 2s);
  EXPECT_EQ(partner.frames, (std::vector<can::Frame>{boot_up, can::data_frame(0x083, me002)}));
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_boot_up_order_test
