// Writes to devices and modules by whoever is not on their bus, and nothing else: what follows from them in time comes by itself.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"
#include "canopus/plant/volatile_memory.hpp"

#include "sim/bus_station.hpp"
#include "support/device_bus.hpp"

namespace canopus::plant::writes_from_outside_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

class WritesFromOutside : public ::testing::Test {
 protected:
  /// Operational, with heartbeats every second.
  sim::Device& operational_device() {
    sim::Device& device = bus_.device(5, 1000);
    device.node().command(canopen::NmtCommand::start, bus_.now());
    bus_.run_for(1ms);
    listener_.heard.clear();
    return device;
  }
  /// The moments at which the bus carried this identifier, in ms.
  std::vector<std::int64_t> moments_of(std::uint32_t identifier) const {
    std::vector<std::int64_t> moments;
    for (const sim::Heard& heard : listener_.heard) {
      if (heard.frame.identifier == identifier) moments.push_back(heard.at.time_since_epoch() / 1ms);
    }
    return moments;
  }

  support::DeviceBus bus_;
  sim::Station listener_{bus_.bus, bus_.timeline, "listener"};
};

TEST_F(WritesFromOutside, AHeartbeatTimeInTheDictionary_CountsFromTheWriteOn) {
  sim::Device& device = operational_device();
  const std::array<std::uint8_t, 2> time{10, 0};
  ASSERT_EQ(device.node().dictionary().write(0x1017, 0, time, bus_.now()), canopen::AbortCode::none);
  bus_.run_for(35ms);
  EXPECT_EQ(moments_of(0x705).size(), 3U);
}

TEST_F(WritesFromOutside, AnNmtCommand_StartsWhatRunsInThatState) {
  sim::Device& device = operational_device();
  device.node().command(canopen::NmtCommand::reset_communication, bus_.now());
  bus_.run_for(5ms);
  EXPECT_EQ(moments_of(0x705).size(), 1U) << "boot-up";
}

TEST_F(WritesFromOutside, AForcedValue_IsReleasedAtItsEnd) {
  sim::Device& device = operational_device();
  const auto entry = device.process_value(0x6000, 1);
  ASSERT_TRUE(entry);
  device.force(*entry, 7, bus_.now() + 20ms, bus_.now());
  bus_.run_for(19ms);
  EXPECT_EQ(device.forced().size(), 1U);
  bus_.run_for(1ms);
  EXPECT_TRUE(device.forced().empty());
}

TEST_F(WritesFromOutside, AMovingValueThatIsWritten_MovesOnAtTheNextSample) {
  sim::Device& device = operational_device();
  device.node().command(canopen::NmtCommand::enter_pre_operational, bus_.now());
  ASSERT_EQ(device.add_behaviour({.kind = sim::Behaviour::Kind::counter,
                                  .index = 0x6000,
                                  .sub = 1,
                                  .low = 1,
                                  .high = 200,
                                  .period = 100s}),
            std::nullopt);
  bus_.port.send(can::data_frame(0x000, {0x01, 0x05}));
  bus_.run_for(50ms);
  const auto value = [&] { return device.node().dictionary().get<std::uint8_t>(0x6000, 1); };
  const std::uint8_t moving = value();
  const std::array<std::uint8_t, 1> other{static_cast<std::uint8_t>(moving + 100)};
  ASSERT_EQ(device.node().dictionary().write(0x6000, 1, other, bus_.now()), canopen::AbortCode::none);
  bus_.run_for(11ms);
  EXPECT_EQ(value(), moving);
}

/// A module on a bus and on the timeline, without a rack.
struct ModuleOnBus {
  ModuleOnBus() {
    timeline.add(module, "module");
    port.connect(module);
  }
  can::Timeline timeline;
  sim::Bus bus{"line1", 250'000, timeline};
  sim::Station other{bus, timeline, "other"};  // acknowledges
  can::Port& port = bus.add_port("module");
  VolatileMemory memory;
  module::me3can1_q::Me3can1Q module{port, memory};
};

TEST_F(WritesFromOutside, TheSupplyOfAModule_EndsItsInitialization) {
  ModuleOnBus on;
  on.module.power_on(on.timeline.now());
  on.timeline.run_until(on.timeline.now() + 1100ms);
  EXPECT_EQ(on.module.node().state(), canopen::NmtState::pre_operational);
}

TEST_F(WritesFromOutside, ASignalToAModule_IsAnsweredInItsTime) {
  ModuleOnBus on;
  on.module.power_on(on.timeline.now());
  on.timeline.run_until(on.timeline.now() + 2s);
  constexpr unsigned save = 0x1F;  // Y1F, X1F [ME3CAN1-Q Tab. 3-3]
  on.module.write_word(22, 0x0001, on.timeline.now());
  const std::uint32_t writes = on.module.flash_writes();
  on.module.set_output(save, true, on.timeline.now());
  on.timeline.run_until(on.timeline.now() + 200ms);
  EXPECT_NE(on.module.inputs() >> save & 1U, 0U);
  EXPECT_GT(on.module.flash_writes(), writes);
}

}  // namespace
}  // namespace canopus::plant::writes_from_outside_test
