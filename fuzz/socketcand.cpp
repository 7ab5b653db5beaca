// Any bytes from a socketcand client, in chunks the input chooses: answers stay well formed, memory bounded.

#include <algorithm>
#include <array>
#include <chrono>
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
  void filtered_frame(const canopus::can::Frame& frame, canopus::can::Time when) override {
    std::array<char, canopus::link::socketcand_max_message> text;
    const auto size =
        canopus::link::write_socketcand_frame(text, frame, when, canopus::link::SocketcandData::apart);
    message({text.data(), size});
  }
  canopus::can::Time now() const override { return time; }
  unsigned frames = 0;
  canopus::can::Time time{};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Ends ends;
  canopus::link::SocketcandSession session("line1", ends, ends);
  session.start();
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  if (size > 0 && (data[0] & 1) != 0) session.receive("< open line1 >< rawmode >");
  if (size > 0 && (data[0] & 3) == 2) session.receive("< open line1 >< subscribe 0 2000 123 >");
  while (!rest.empty()) {
    const std::size_t chunk =
        std::min<std::size_t>(rest.size(), 1 + static_cast<unsigned char>(rest[0]) % 64U);
    session.receive(rest.substr(0, chunk));
    rest.remove_prefix(chunk);
    if (session.waiting()) session.resume();
    // The bus goes on: what the client sent comes as a frame of another node, too, and jobs are due.
    ends.time += std::chrono::milliseconds(chunk);
    canopus::can::Frame frame{.identifier = 0x123,
                              .dlc = static_cast<std::uint8_t>(std::min<std::size_t>(8, chunk))};
    std::copy_n(data, std::min<std::size_t>(frame.dlc, size), frame.data.begin());
    session.filter(frame, ends.time);
    if (session.alarm() <= ends.time) session.tick(ends.time);
  }
  return 0;
}
