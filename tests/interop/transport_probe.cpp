// Joins a bus, sends a frame of every kind, then asks the other side (identifier 7F0H) to do the same, and prints what it
// sends, hears and is told. For the checks of tests/interop, whose other side is python-can.
//
// usage: transport_probe ADDRESS FRAMES [SECONDS]    ends when so many frames are heard and its own are complete

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "canopus/link/bus_client.hpp"

namespace {

using namespace canopus;

void print(const char* what, const can::Frame& frame) {
  fmt::print("{} {}{} {:X} {} ", what, frame.extended ? 'X' : 'B', frame.remote ? 'R' : 'D', frame.identifier,
             frame.dlc);
  for (const std::uint8_t byte : frame.bytes()) fmt::print("{:02x}", byte);
  fmt::print("\n");
}

struct Probe : link::BusClientListener {
  void frame_received(const can::Frame& frame) override {
    ++heard;
    print("heard", frame);
  }
  void frame_received_at(const can::Frame& frame,
                         std::optional<std::chrono::nanoseconds> received_at) override {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    if (received_at && std::chrono::abs(now - *received_at) < std::chrono::seconds(60)) ++timed;
    frame_received(frame);
  }
  void frame_sent(const can::Frame& frame) override {
    ++sent;
    print("sent", frame);
  }
  void controller_changed(const link::ControllerStatus& status) override {
    fmt::print("status {} tec {} rec {} rate {} sample {}\n", static_cast<int>(status.state),
               status.transmit_errors, status.receive_errors, status.bit_rate, status.sample_point);
  }
  void bus_interrupted(const std::string& reason) override { fmt::print("interrupted: {}\n", reason); }
  void bus_resumed() override { fmt::print("resumed\n"); }
  void bus_complains(std::string_view text) override { fmt::print("complaint: {}\n", text); }
  void bus_lost(const std::string& reason) override {
    fmt::print("lost: {}\n", reason);
    lost = true;
  }

  unsigned heard = 0, sent = 0, timed = 0;
  bool lost = false;
};

}  // namespace

int main(int count, char** words) {
  if (count < 3) return 2;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const auto address = link::parse_bus_address(words[1]);
  if (!address) return fmt::print("{}\n", address.error()), 2;
  boost::asio::io_context io;
  const auto bit_rate = static_cast<std::uint32_t>(count > 4 ? std::atoi(words[4]) : 0);
  auto bus = link::open_bus(
      io, *address, {.keep_trying = true, .retry = std::chrono::milliseconds(200), .bit_rate = bit_rate});
  if (!bus) return fmt::print("{}\n", bus.error()), 1;
  fmt::print("joined\n");
  Probe probe;
  (*bus)->set_user(&probe);
  probe.controller_changed((*bus)->status());
  unsigned expected = 0;
  const auto send = [&](const can::Frame& frame) { expected += (*bus)->send(frame) ? 1 : 0; };
  for (std::uint8_t length = 0; length <= 8; ++length) {
    for (const bool extended : {false, true}) {
      can::Frame frame{
          .identifier = (extended ? 0x1ABCDE0U : 0x200U) + length, .extended = extended, .dlc = length};
      for (std::uint8_t i = 0; i < length; ++i) frame.data[i] = static_cast<std::uint8_t>(0xF0 + i);
      send(frame);
      if (std::getenv("PROBE_WITHOUT_REMOTE") == nullptr) {
        send({.identifier = (extended ? 0x1ABCDF0U : 0x210U) + length,
              .extended = extended,
              .remote = true,
              .dlc = length});
      }
    }
  }
  send(can::data_frame(0x7F0));
  const auto wanted = static_cast<unsigned>(std::atoi(words[2]));
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::seconds(count > 3 ? std::atoi(words[3]) : 60);
  while ((probe.heard < wanted || probe.sent < expected) && !probe.lost &&
         std::chrono::steady_clock::now() < end) {
    if (io.stopped()) io.restart();
    io.run_one_until(end);
  }
  (*bus)->set_user(nullptr);
  const bool closed = (*bus)->close(std::chrono::seconds(2));
  fmt::print("heard {} timed {} sent {} of {} closed {}\n", probe.heard, probe.timed, probe.sent, expected,
             closed);
  return probe.heard >= wanted && probe.sent == expected ? 0 : 1;
}
