#pragma once
// A module in a rack and on a bus with another station, and its LEDs.

#include <string_view>

#include <gtest/gtest.h>

#include "canopus/plc/rack/rack.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "scenarios/me3can1_q/scenario.hpp"
#include "sim/bus_station.hpp"

namespace canopus::scenario {

/// An ME3CAN1-Q two seconds after its supply came.
struct RackBench {
  can::Timeline timeline;
  sim::Bus bus{"line", 250'000, timeline};
  sim::Station other{bus, timeline, "other"};  // acknowledges
  sim::Port& port = bus.add_port("module");
  RamMemory memory;
  module::me3can1_q::Me3can1Q module{port, memory};
  plc::Rack rack{timeline};

  RackBench() {
    timeline.add(module);
    port.connect(module);
    EXPECT_TRUE(rack.insert(0x00, module));
    rack.power_on(timeline.now());
    timeline.run_until(timeline.now() + 2s);
  }
  std::uint16_t g(module::BufferAddress address) { return module.program_read(address, timeline.now()); }
  void g(module::BufferAddress address, std::uint16_t value) {
    EXPECT_TRUE(rack.write_buffer(0, address, {&value, 1}, timeline.now()));
  }
  void y(std::uint32_t number, bool on) {
    const std::uint8_t bit = on ? 1 : 0;
    EXPECT_TRUE(rack.write_bits(plc::Device::y, number, {&bit, 1}, timeline.now()));
  }
  void run(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
};

}  // namespace canopus::scenario
