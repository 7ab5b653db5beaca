// Datagrams of any bytes to a port of the MELSEC protocol: each gets at most one reply, and none harms the next. One
// byte of the input is a datagram's length, 255 as often as it takes.

#include <memory>
#include <span>

#include "canopus/plc/melsec/password_guard.hpp"
#include "canopus/plc/melsec/session.hpp"

#include "memory_module.hpp"

using canopus::can::Time;
using canopus::fuzz::expect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace melsec = canopus::plc::melsec;
  if (size < 2) return 0;
  melsec::PortSettings settings{.takes_3e = (data[0] & 1U) == 0 || (data[0] & 2U) == 0,
                                .takes_1e = (data[0] & 1U) != 0};
  if ((data[0] & 4U) != 0)
    settings.code = (data[0] & 8U) != 0 ? melsec::DataCode::ascii : melsec::DataCode::binary;
  if ((data[0] & 16U) != 0) settings.remote_password = "ab";

  canopus::can::Timeline timeline;
  canopus::fuzz::MemoryModule module;
  canopus::plc::Rack rack(timeline);
  timeline.add(module);
  expect(rack.insert(0x20, module));
  rack.power_on(Time{});
  melsec::PasswordGuard guard;
  auto session = std::make_unique<melsec::Session>(rack, std::move(settings), &guard);
  std::span<const std::uint8_t> input(data + 1, size - 1);
  while (!input.empty()) {
    std::size_t length = 0;
    while (!input.empty()) {
      const std::uint8_t part = input[0];
      input = input.subspan(1);
      length += part;
      if (part != 255) break;
    }
    const auto datagram = input.first(std::min(length, input.size()));
    input = input.subspan(datagram.size());
    session->datagram(datagram, Time{});
    expect(session->output().size() <= 4096);
    expect(!session->over());
  }
  return 0;
}
