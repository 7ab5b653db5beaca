// The text of a network file: mistakes are told with a place inside the text, and what is accepted can be put
// into the objects it is meant for.

#include "canopus/master/network_file.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string_view>

#include "input.hpp"

using namespace canopus;
using fuzz::expect;

namespace {

/// What an object of 16 bits holds in milliseconds.
bool fits(can::Duration time) {
  constexpr can::Duration most = std::chrono::milliseconds(65535);
  return time >= can::Duration{} && time <= most && time % std::chrono::milliseconds(1) == can::Duration{};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1;
  const master::NetworkReading reading = master::read_network(text, "network.toml");
  for (const text::FileError& error : reading.errors) {
    expect(!error.message.empty() && error.place.line <= lines);
    expect(text::describe(error, "network.toml").starts_with("network.toml:"));
  }
  if (!reading.errors.empty()) return 0;
  const master::NetworkFile& network = reading.network;
  expect(network.node >= 1 && network.node <= 127 && fits(network.heartbeat));
  expect(!network.boot_time || *network.boot_time >= can::Duration{});
  expect(network.nmt_inhibit_time >= can::Duration{});
  expect(network.nmt_inhibit_time / std::chrono::microseconds(100) <= 65535);
  expect(network.options.program_attempts >= 1 && network.options.program_clear_attempts >= 1);
  if (network.flying) {
    const manager::FlyingMasterTiming& timing = *network.flying;
    expect(timing.level <= 2 && fits(timing.time_out) && fits(timing.negotiation_delay));
    expect(fits(timing.priority_slot) && fits(timing.device_slot) && fits(timing.detect_cycle));
    expect(timing.priority_slot > 127 * timing.device_slot);
  }
  expect(!network.slaves.empty());
  for (const master::NetworkSlave& slave : network.slaves) {
    expect(slave.node >= 1 && slave.node <= 127 && slave.node != network.node);
    expect(fits(slave.consumer_heartbeat_time) && fits(slave.guard_time) && slave.retry_factor >= 1);
    expect(slave.program.empty() || slave.software_version.value_or(0) != 0);
    expect(slave.objects.empty() || !slave.eds.empty());
  }
  return 0;
}
