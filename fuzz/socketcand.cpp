// Any bytes from a socketcand client, in chunks the input chooses: answers stay well formed, memory bounded.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "canopus/link/socketcand_session.hpp"

namespace {

struct Ends : canopus::can::Sink, canopus::link::SocketcandSession::Peer {
  bool send(const canopus::can::Frame& frame) override {
    const auto most =
        frame.extended ? canopus::can::max_extended_identifier : canopus::can::max_base_identifier;
    if (frame.identifier > most || frame.dlc > 8) std::abort();
    return ++frames % 5 != 0;
  }
  void message(std::string_view text) override {
    if (text.size() > canopus::link::socketcand_max_message || !text.starts_with("< ") ||
        !text.ends_with(" >")) {
      std::abort();
    }
  }
  unsigned frames = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Ends ends;
  canopus::link::SocketcandSession session("line1", ends, ends);
  session.start();
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  if (size > 0 && (data[0] & 1) != 0) session.receive("< open line1 >< rawmode >");
  while (!rest.empty()) {
    const std::size_t chunk =
        std::min<std::size_t>(rest.size(), 1 + static_cast<unsigned char>(rest[0]) % 64U);
    session.receive(rest.substr(0, chunk));
    rest.remove_prefix(chunk);
    if (session.waiting()) session.resume();
  }
  return 0;
}
