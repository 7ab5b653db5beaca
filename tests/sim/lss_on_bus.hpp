#pragma once
// Simulated devices as LSS slaves on the simulated bus, and an LSS master beside them.

#include <fstream>
#include <iterator>
#include <list>
#include <map>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "canopus/lss/lss_master.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/device/device.hpp"

#include "bus_station.hpp"
#include "paths.hpp"

namespace canopus::sim {

using namespace std::chrono_literals;
using lss::LssAddress;
using lss::LssMaster;
using lss::LssResult;
using lss::LssSlave;
using testing::Contains;
using testing::ElementsAre;
using testing::Not;

inline constexpr std::uint8_t unconfigured = 0xFF;

/// The example I/O block with this LSS address in 1018H.
inline std::shared_ptr<const eds::DeviceFile> io_block(const LssAddress& address) {
  static const auto file = [] {
    std::ifstream stream(CANOPUS_SOURCE_DIR "/examples/devices/io-block.eds", std::ios::binary);
    return eds::read_device_file(std::string(std::istreambuf_iterator<char>(stream), {})).file;
  }();
  const std::uint32_t parts[] = {address.vendor, address.product, address.revision, address.serial};
  std::vector<canopen::DictionaryDescription::Change> changes;
  for (std::uint8_t i = 0; i < 4; ++i) {
    changes.push_back({file->dictionary->find(0x1018, static_cast<std::uint8_t>(i + 1)),
                       canopen::little_endian(parts[i], 4)});
  }
  auto copy = std::make_shared<eds::DeviceFile>(*file);
  copy->dictionary = file->dictionary->with(changes);
  return copy;
}

struct Store final : canopen::ParameterStore {
  std::vector<std::uint8_t> load() override { return image; }
  canopen::AbortCode save(std::span<const std::uint8_t> bytes) override {
    if (broken) return canopen::AbortCode::hardware_error;
    image.assign(bytes.begin(), bytes.end());
    return canopen::AbortCode::none;
  }
  std::vector<std::uint8_t> image;
  bool broken = false;
};

inline constexpr LssAddress address{0x00000071, 0x0000ED63, 0x00010000, 0x12345678};

/// Devices on a bus, and an LSS master that is a station of it and writes down what is on the wire.
class LssOnBus : public testing::Test, public lss::LssMasterListener {
 protected:
  struct Seat {
    Seat(Bus& bus, can::Timeline& timeline, const LssAddress& own, std::uint8_t node_id, std::uint32_t rate,
         Store* store)
        : port(bus.add_port("device")) {
      if (rate != bus.bit_rate()) port.restart(rate);
      device = std::make_unique<Device>(io_block(own), node_id, port);
      device->enable_lss(port, store);
      timeline.add(*device);
      port.connect(*device);
      device->power_on(timeline.now());
    }
    Port& port;
    std::unique_ptr<Device> device;
  };

  LssOnBus() {
    station.on_receive = [this](const can::Frame& frame, can::Time now) { master.receive(frame, now); };
  }
  virtual ~LssOnBus() = default;

  Seat& add(const LssAddress& own, std::uint8_t node_id = unconfigured, std::uint32_t rate = 250'000,
            Store* store = nullptr) {
    return seats.emplace_back(bus, timeline, own, node_id, rate, store);
  }
  void lss_finished(LssMaster&, LssResult result, can::Time) override { latest = result; }

  /// One service of the master, until its end.
  template <typename Service>
  std::optional<LssResult> service(Service begin) {
    latest.reset();
    EXPECT_TRUE(begin(timeline.now()));
    for (unsigned i = 0; i < 2'000'000 && !latest; ++i) {
      timeline.run_until(std::min(master.deadline(), timeline.now() + 100us));
      if (master.deadline() <= timeline.now()) master.tick(timeline.now());
    }
    return latest;
  }
  std::optional<LssResult> select(const LssAddress& whom) {
    return service([&](can::Time now) { return master.select(whom, now); });
  }
  std::optional<LssResult> switch_all(bool configuration) {
    return service([&](can::Time now) { return master.switch_global(configuration, now); });
  }
  std::optional<LssResult> set_node_id(std::uint8_t id) {
    return service([&](can::Time now) { return master.configure_node_id(id, now); });
  }
  std::optional<LssResult> set_bit_rate(std::uint8_t index) {
    return service([&](can::Time now) { return master.configure_bit_timing(index, now); });
  }
  std::optional<LssResult> activate(std::chrono::milliseconds delay) {
    return service([&](can::Time now) { return master.activate_bit_timing(delay, now); });
  }
  std::optional<LssResult> store() {
    return service([&](can::Time now) { return master.store(now); });
  }
  std::optional<LssResult> fastscan() {
    return service([&](can::Time now) { return master.fastscan(now); });
  }
  void run_for(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
  /// A power cut of this device.
  void cut(Seat& seat, can::Duration pause = 1s) {
    seat.device->power_off();
    run_for(pause);
    seat.device->power_on(timeline.now());
    run_for(5ms);
  }
  /// Everything heard with this identifier since the last call of forget().
  [[nodiscard]] std::size_t heard(std::uint32_t identifier) const {
    return static_cast<std::size_t>(
        std::ranges::count(station.frames(), identifier, [](const can::Frame& f) { return f.identifier; }));
  }
  void forget() { station.heard.clear(); }

  can::Timeline timeline;
  Bus bus{"field", 250'000, timeline};
  Station station{bus, timeline, "master"};
  LssMaster master{station.port, *this};
  std::list<Seat> seats;
  std::optional<LssResult> latest;
};

}  // namespace canopus::sim
