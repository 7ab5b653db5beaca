#pragma once
// Devices of the interoperability tests' EDS on a simulated bus in virtual time, and a port for what is under
// test.

#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/timeline.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/device/device.hpp"

#include "paths.hpp"

namespace canopus::support {

inline std::shared_ptr<const eds::DeviceFile> interop_device_file() {
  std::ifstream stream(CANOPUS_SOURCE_DIR "/tests/interop/interop_device.eds");
  std::ostringstream text;
  text << stream.rdbuf();
  return eds::read_device_file(text.str()).file;
}

class DeviceBus {
 public:
  /// A device, switched on now. `heartbeat` in ms.
  sim::Device& device(std::uint8_t node_id, std::uint16_t heartbeat) {
    sim::Port& place = bus.add_port("device");
    devices_.push_back(std::make_unique<sim::Device>(file_, node_id, place));
    sim::Device& device = *devices_.back();
    timeline.add(device);
    place.connect(device);
    place.plug(true);
    device.power_on(timeline.now());
    device.node().dictionary().set<std::uint16_t>(0x1017, 0, heartbeat);
    const std::uint8_t bytes[] = {static_cast<std::uint8_t>(heartbeat),
                                  static_cast<std::uint8_t>(heartbeat >> 8)};
    EXPECT_EQ(device.node().dictionary().write(0x1017, 0, bytes, timeline.now()), canopen::AbortCode::none);
    return device;
  }
  /// Puts what is under test on the bus.
  void join(can::Participant& participant) {
    timeline.add(participant);
    port.connect(participant);
    port.plug(true);
    timeline.run_until(timeline.now() + std::chrono::milliseconds(1));
  }
  void run_for(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
  [[nodiscard]] can::Time now() const { return timeline.now(); }

  can::Timeline timeline;
  sim::Bus bus{"line1", 1'000'000, timeline};
  sim::Port& port = bus.add_port("tested");

 private:
  std::shared_ptr<const eds::DeviceFile> file_ = interop_device_file();
  std::vector<std::unique_ptr<sim::Device>> devices_;
};

}  // namespace canopus::support
