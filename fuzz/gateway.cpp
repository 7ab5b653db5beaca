// Any bytes from a client of the ASCII gateway, and any frames of its bus, in turn: answers stay lines, frames well formed.

#include "canopus/client/gateway/gateway.hpp"

#include <string_view>

#include "canopus/client/gateway/gateway_session.hpp"

#include "input.hpp"

using namespace canopus;
using fuzz::expect;

namespace {

struct Ends : can::Sink, client::GatewaySession::Peer {
  bool send(const can::Frame& frame) override {
    fuzz::expect_well_formed(frame);
    return ++frames % 7 != 0;
  }
  void say(std::string_view line) override {
    expect(line.ends_with("\r\n"));
    line.remove_suffix(2);
    for (const char c : line) expect(c != '\r' && c != '\n' && c != '\x1B');
  }
  unsigned frames = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  Ends ends;
  client::Gateway gateway(ends, 0, "1");
  client::GatewaySession session(gateway, ends);
  client::GatewaySession other(gateway, ends);
  can::Time now{};
  while (!input.empty()) {
    const std::uint8_t step = input.byte();
    switch (step % 8) {
      case 0:
        gateway.receive(input.frame(input.one_of({0x585U, 0x581U, 0x705U, 0x085U, 0x080U, 0x185U})), now);
        break;
      case 1: fuzz::pass_time(gateway, now, now + std::chrono::milliseconds(input.byte())); break;
      case 2: other.receive("[1] 5 r 0x1000 0\nset rpdo 1 0x185 event 2 u8 u16\n", now); break;
      default: {
        const auto bytes = input.bytes(1 + step);
        session.receive({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, now);
        break;
      }
    }
    if (session.deadline() <= now) session.tick(now);
  }
  return 0;
}
