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
  void send_line(std::string_view line) override {
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
  bool restarts = false;
  gateway.set_restart([&restarts](std::uint32_t rate) -> std::expected<void, std::string> {
    expect(rate >= 10'000 && rate <= 1'000'000);
    restarts = !restarts;
    if (restarts) return {};
    return std::unexpected("not now");
  });
  client::GatewaySession session(gateway, ends);
  client::GatewaySession other(gateway, ends);
  can::Time now{};
  while (!input.empty()) {
    const std::uint8_t step = input.byte();
    switch (step % 8) {
      case 0:
        gateway.receive(
            input.frame(input.one_of({0x585U, 0x581U, 0x705U, 0x085U, 0x080U, 0x185U, 0x7E4U, 0x205U}),
                        (step & 0x80U) != 0),
            now);
        break;
      case 1: fuzz::pass_time(gateway, now, now + std::chrono::milliseconds(input.byte())); break;
      case 2:
        other.receive(
            input.one_of({"[1] 5 r 0x1000 0\nset rpdo 1 0x185 event 2 u8 u16\n",
                          "set tpdox 1 0x205 event 10 20 1 u8\nw p 1 1 7\n",
                          "set tpdox 2 0x206 sync2 3 1 u8\nw p 2 1 7\n",
                          "set rpdo 3 0x20000185 rtr 1 u16\nr p 3\n",
                          "set tpdo 4 0x205 rtr 1 u8\nw p 4 1 9\n",
                          "lss_switch_glob 1\nlss_inquire_addr\nlss_allnodes 5 1 1\n",
                          "lss_conf_bitrate 0 2\n", "lss_activate_bitrate 10\n_lss_slowscan 1 2 0 9 0 9\n",
                          "init 0\nset id 5\nset heartbeat 50\n"}),
            now);
        break;
      default: {
        const auto bytes = input.bytes(1 + step);
        session.receive({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, now);
        break;
      }
    }
    if (session.deadline() <= now) session.tick(now);
    if (other.deadline() <= now) other.tick(now);
  }
  return 0;
}
