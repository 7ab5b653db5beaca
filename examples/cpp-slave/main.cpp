// A CANopen slave in C++: any EDS file's device on a real bus, or on one of `canopus run`. Its communication is the file's;
// what it does is below: the outputs that a master writes are printed, and come back as inputs.
//
//   cpp_slave socketcan:can0 7 ../devices/io-block.eds
//   cpp_slave socketcand:127.0.0.1:29536 7 ../devices/io-block.eds       (a bus of `canopus run`)
//
// Nothing here blocks: everything is told by a callback, on one thread. Ctrl-C ends it.

#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/link/bus_loop.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;

class Slave final : public can::Participant, private canopen::NodeListener {
 public:
  Slave(const eds::DeviceFile& file, std::uint8_t node_id, can::Sink& bus)
      : node_(file.dictionary, node_id, bus) {
    node_.set_listener(this);
    alarm().add_part(node_.alarm());
  }

  void power_on(can::Time now) { node_.power_on(now); }

  // can::Participant: what the loop calls. The node has services of its own for all of it.
  void receive(const can::Frame& frame, can::Time now) override { node_.receive(frame, now); }
  void tick(can::Time now) override { node_.tick(now); }

 private:
  // canopen::NodeListener
  void nmt_state_changed(canopen::NmtState state, can::Time now) override {
    std::printf("%9.6f  %s\n", can::seconds(now),
                state == canopen::NmtState::operational       ? "Operational"
                : state == canopen::NmtState::stopped         ? "Stopped"
                : state == canopen::NmtState::pre_operational ? "Pre-operational"
                                                              : "Initialisation");
  }
  void rpdo_received(std::uint16_t, can::Time now) override { take_outputs(now); }
  void object_written(const canopen::Entry& entry, can::Time now) override {
    if (entry.index == 0x6200) take_outputs(now);
  }

  /// 6200:01 are the digital outputs, 6000:01 the inputs [CiA 401].
  void take_outputs(can::Time now) {
    const auto outputs = node_.dictionary().get<std::uint8_t>(0x6200, 1, 0);
    if (outputs == outputs_) return;
    outputs_ = outputs;
    std::printf("%9.6f  outputs %02X\n", can::seconds(now), static_cast<unsigned>(outputs));
    node_.dictionary().set(0x6000, 1, outputs);
    node_.values_changed(now);  // TPDOs that map it and are sent at each change
  }

  canopen::Node node_;
  std::uint8_t outputs_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  std::uint8_t node_id = 0;
  const char* end = argc == 4 ? argv[2] + std::strlen(argv[2]) : nullptr;
  if (argc != 4 || std::from_chars(argv[2], end, node_id).ptr != end || node_id < 1 || node_id > 127) {
    return std::fprintf(stderr, "usage: %s BUS NODE-ID (1..127) EDS-FILE\n", argv[0]), 2;
  }
  const auto address = link::parse_bus_address(argv[1]);
  if (!address) return std::fprintf(stderr, "%s\n", address.error().c_str()), 2;
  std::ifstream stream(argv[3], std::ios::binary);
  const auto read = eds::read_device_file(std::string(std::istreambuf_iterator<char>(stream), {}));
  if (!read.file) {
    std::fprintf(stderr, "%s: %s\n", argv[3],
                 read.problems.empty() ? "cannot be read" : read.problems.front().message.c_str());
    return 1;
  }
  const auto bus = link::BusLoop::open(*address, 3s);
  if (!bus) return std::fprintf(stderr, "%s\n", bus.error().c_str()), 1;

  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  Slave slave(*read.file, node_id, **bus);
  (*bus)->add(slave);
  slave.power_on((*bus)->now());
  const auto over = (*bus)->run([] { return false; }, can::never);
  (*bus)->remove(slave);
  if (over == link::BusLoop::End::lost) return std::fprintf(stderr, "%s\n", (*bus)->failure().c_str()), 1;
  return 0;
}
