// A plant in one C++ program, in virtual time: a simulated bus, a tank that is a CANopen device (its communication comes
// from an EDS file, its behaviour from the class below), and a master that fills it. The same every time.
//
//   cpp_device ../devices/io-block.eds
//
// Output 1 of the device is the pump; its inputs are the level switches: bit 0 above a tenth, bit 1 full.

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "canopus/can/timeline.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/manager/configuration/master_dictionary.hpp"
#include "canopus/manager/nmt/master_node.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/device/device.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;

constexpr std::uint8_t tank_node = 5;

/// Fills in 8 s while the pump runs, and keeps what it has.
class Tank final : public sim::DeviceApplication {
 public:
  void start(sim::Device& device, can::Time now) override {
    switches_ = *device.process_value(0x6000, 1);
    since_ = now;
    (void)act(device, now);
  }
  bool act(sim::Device& device, can::Time now) override {
    const double filled = pump_ ? std::chrono::duration<double>(now - since_) / 8s : 0;
    level_ = std::min(1.0, level_ + filled);
    since_ = now;
    pump_ = (device.node().dictionary().get<std::uint8_t>(0x6200, 1, 0) & 1) != 0;
    alarm_ = pump_ ? now + 10ms : can::never;
    const std::uint64_t switches = (level_ >= 0.1 ? 1U : 0U) | (level_ >= 1 ? 2U : 0U);
    return device.put(switches_, switches);
  }
  /// Due every 10 ms while the pump runs.
  [[nodiscard]] can::Alarm& alarm() noexcept override { return alarm_; }

 private:
  canopen::Entry switches_;
  double level_ = 0;
  bool pump_ = false;
  can::Time since_{};
  can::Alarm alarm_;
};

/// Boots the tank [CiA 302-2], turns the pump on by SDO, and off again when the tank says that it is full.
class Master final : public manager::MasterNode,
                     private manager::MasterListener,
                     private canopen::SdoClientListener {
 public:
  explicit Master(can::Sink& bus) : MasterNode(manager::master_dictionary(), 127, bus), sdo_(bus) {
    master().set_listener(this);
    sdo_.set_server(tank_node);
    alarm().add_part(sdo_.alarm());
  }
  [[nodiscard]] bool finished() const { return finished_; }

  void receive(const can::Frame& frame, can::Time now) override {
    MasterNode::receive(frame, now);
    sdo_.receive(frame, now);
    if (frame.identifier != 0x180 + tank_node) return;  // its TPDO1: the level switches
    std::printf("%9.6f  level switches %02X\n", can::seconds(now), static_cast<unsigned>(frame.data[0]));
    if ((frame.data[0] & 2) != 0) pump(false, now);
  }
  void tick(can::Time now) override {
    MasterNode::tick(now);
    if (sdo_.deadline() <= now) sdo_.tick(now);
  }

 private:
  void configure(canopen::ObjectDictionary& dictionary) override {
    dictionary.set(0x1F80, 0, 0x01U);  // NMT master
    constexpr std::uint32_t slave = 0x05;
    dictionary.set(0x1F81, tank_node, slave);
  }
  void slave_booted(std::uint8_t, can::Time now) override {
    std::printf("%9.6f  the tank is booted\n", can::seconds(now));
    pump(true, now);
  }
  bool sdo_channel_free(std::uint8_t) override { return !sdo_.busy(); }
  void pump(bool on, can::Time now) {
    std::printf("%9.6f  pump %s\n", can::seconds(now), on ? "on" : "off");
    on_ = on;
    sdo_.download(0x6200, 1, {{static_cast<std::uint8_t>(on ? 1 : 0)}}, *this, now);
  }
  void sdo_finished(canopen::SdoClient&, can::Time) override { finished_ = !on_; }

  canopen::SdoClient sdo_;
  bool on_ = false;
  bool finished_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: %s EDS-FILE\n", argv[0]), 2;
  std::ifstream stream(argv[1], std::ios::binary);
  const auto read = eds::read_device_file(std::string(std::istreambuf_iterator<char>(stream), {}));
  if (!read.file) {
    std::fprintf(stderr, "%s: %s\n", argv[1],
                 read.problems.empty() ? "cannot be read" : read.problems.front().message.c_str());
    return 1;
  }
  can::Timeline timeline;
  sim::Bus bus("line1", 125'000, timeline);
  can::Port& master_port = bus.add_port("master");
  can::Port& tank_port = bus.add_port("tank");

  Master master(master_port);
  sim::Device tank(read.file, tank_node, tank_port);
  tank.set_application(std::make_unique<Tank>());
  timeline.add(master, "master");
  master_port.connect(master);
  timeline.add(tank, "tank");
  tank_port.connect(tank);
  tank.power_on(timeline.now());
  timeline.run_until(timeline.now() + 10ms);  // its boot-up message is on the bus before the master resets it
  master.power_on(timeline.now());
  while (!master.finished() && timeline.now() < can::Time{} + 30s) timeline.run_until(timeline.now() + 100ms);
  std::printf("%9.6f  %llu frames on the bus\n", can::seconds(timeline.now()),
              static_cast<unsigned long long>(bus.load(timeline.now()).frames));
  return master.finished() ? 0 : 1;
}
