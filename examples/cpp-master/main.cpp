// A CANopen master in C++: boots the nodes it is told as CiA 302-2 says, watches them by guarding, asks each
// for its name by SDO as soon as it is booted, and says in words why a node is not.
//
//   cpp_master socketcan:can0 2 3 4
//   cpp_master socketcand:127.0.0.1:29536 2 3 4       (a bus of `canopus run`)
//
// Nothing here blocks: everything is told by a callback, on one thread.

#include <array>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/link/bus_loop.hpp"
#include "canopus/manager/configuration/master_dictionary.hpp"
#include "canopus/manager/nmt/master_node.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;

/// A node of its own with an NMT master on it.
class Master final : public manager::MasterNode,
                     private manager::MasterListener,
                     private canopen::SdoClientListener {
 public:
  Master(can::Sink& bus, std::vector<std::uint8_t> slaves)
      : MasterNode(manager::master_dictionary(), 127, bus), slaves_(std::move(slaves)) {
    master().set_listener(this);
    master().options().sdo_time_out = 1s;
    for (const std::uint8_t slave : slaves_) {
      canopen::SdoClient& client = sdo_.try_emplace(slave, bus).first->second;
      client.set_server(slave);
      alarm().add_part(client.alarm());
    }
  }

  /// Every slave was booted and told its name, or has failed.
  [[nodiscard]] bool finished() const { return answers_ == slaves_.size() || master().halted(); }
  /// True when all are booted. Prints how each one is doing.
  bool report(can::Time now) const {
    bool good = true;
    for (const std::uint8_t slave : slaves_) {
      const manager::BootRecord& record = master().boot_record(slave);
      good = good && record.step == manager::BootStep::booted;
      std::printf("%s\n", manager::explain(record, slave, now).c_str());
    }
    return good;
  }

  // can::Participant: what the loop calls.
  void receive(const can::Frame& frame, can::Time now) override {
    MasterNode::receive(frame, now);
    for (const std::uint8_t slave : slaves_) sdo_.at(slave).receive(frame, now);
  }
  void tick(can::Time now) override {
    MasterNode::tick(now);
    for (const std::uint8_t slave : slaves_) {
      if (sdo_.at(slave).deadline() <= now) sdo_.at(slave).tick(now);
    }
  }

 private:
  // manager::MasterNode: the network, as objects of CiA 302-2.
  void configure(canopen::ObjectDictionary& dictionary) override {
    dictionary.set(0x1F80, 0, 0x01U);   // NMT master; starts itself and its slaves
    dictionary.set(0x1F89, 0, 5'000U);  // mandatory slaves must be booted after 5 s
    dictionary.set(0x1017, 0, 1'000U);  // own heartbeat every second
    constexpr std::uint32_t guarded_every_500_ms = 500U << 16 | 3U << 8;
    constexpr std::uint32_t mandatory_slave = 0x0D;
    for (const std::uint8_t slave : slaves_) {
      dictionary.set(0x1F81, slave, guarded_every_500_ms | mandatory_slave);
    }
  }

  // manager::MasterListener
  void boot_went_on(std::uint8_t node, const manager::BootRecord& record, can::Time now) override {
    std::printf("%9.6f  node %u: %s\n", can::seconds(now), node, manager::describe(record).c_str());
  }
  void slave_booted(std::uint8_t node, can::Time now) override {
    sdo_.at(node).upload(0x1008, 0, *this, now);  // manufacturer device name
  }
  void error_control_event(std::uint8_t node, manager::ErrorControlEvent, can::Time now) override {
    std::printf("%9.6f  node %u is lost\n", can::seconds(now), node);
  }
  // The boot of a node waits while this program asks it something.
  bool sdo_channel_free(std::uint8_t node) override { return !sdo_.at(node).busy(); }

  // canopen::SdoClientListener
  void sdo_finished(canopen::SdoClient& client, can::Time now) override {
    ++answers_;
    const std::string name(client.data().begin(), client.data().end());
    std::printf("%9.6f  node %u is a \"%s\"\n", can::seconds(now), client.server(), name.c_str());
  }

  std::vector<std::uint8_t> slaves_;
  std::map<std::uint8_t, canopen::SdoClient> sdo_;  // by node-ID
  std::size_t answers_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::uint8_t> slaves;
  for (int i = 2; i < argc; ++i) {
    std::uint8_t node = 0;
    const char* end = argv[i] + std::strlen(argv[i]);
    const auto [rest, error] = std::from_chars(argv[i], end, node);
    if (error == std::errc{} && rest == end && node >= 1 && node <= 126) slaves.push_back(node);
  }
  if (argc < 3 || slaves.size() != static_cast<std::size_t>(argc) - 2) {
    std::fprintf(stderr, "usage: %s BUS NODE-ID (1..126)...\n", argv[0]);
    return 2;
  }
  const auto address = link::parse_bus_address(argv[1]);
  if (!address) return std::fprintf(stderr, "%s\n", address.error().c_str()), 2;
  const auto bus = link::BusLoop::open(*address, 3s);
  if (!bus) return std::fprintf(stderr, "%s\n", bus.error().c_str()), 1;

  Master master(**bus, std::move(slaves));
  (*bus)->add(master);
  master.power_on((*bus)->now());
  (*bus)->run([&] { return master.finished(); }, (*bus)->now() + 10s);
  const bool good = master.report((*bus)->now());
  (*bus)->remove(master);
  return good ? 0 : 1;
}
