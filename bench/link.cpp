// Frames per second over a transport, from one client of it to another in the same process, and what a frame costs the processor:
// bench_link ADDRESS [FRAMES]. With a CAN interface (socketcan:vcan0) the two system calls that bring a frame are measured beside
// it: write() and read() alone, one frame each. bench/link runs it for each transport there is, in a machine with SocketCAN.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <thread>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "canopus/link/bus_client.hpp"
#include "canopus/link/socket_pair.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

std::chrono::nanoseconds processor_time() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& time) {
    return std::chrono::seconds(time.tv_sec) + std::chrono::microseconds(time.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

void report(const std::string& what, std::uint64_t frames, std::uint64_t lost, Clock::duration wall,
            std::chrono::nanoseconds processor) {
  const double seconds = std::chrono::duration<double>(wall).count();
  fmt::print("{:<44}{:>12.0f} frames/s{:>8.0f} ns of processor time per frame{}\n", what,
             static_cast<double>(frames) / seconds,
             static_cast<double>(processor.count()) / static_cast<double>(frames),
             lost == 0 ? "" : fmt::format(", {} lost", lost));
}

can::Frame numbered(std::uint64_t number) {
  can::Frame frame = can::data_frame(0x123, {0, 0, 0, 0, 0, 0, 0, 0});
  std::memcpy(frame.data.data(), &number, sizeof number);
  return frame;
}

/// Sends with so many frames under way as a plant has.
class Sender final : public link::BusClientListener {
 public:
  Sender(link::BusClient& bus, std::uint64_t frames, std::atomic<std::uint64_t>& received)
      : bus_(bus), frames_(frames), received_(received) {}
  void send_next() {
    // Not more than a receiver's socket holds: what is measured is not how fast frames are lost.
    while (sent_ < frames_ && under_way_ < 4 && sent_ - received_.load() < 64) {
      if (!bus_.send(numbered(sent_))) return;
      ++sent_;
      ++under_way_;
    }
  }
  void frame_received(const can::Frame&) override {}
  void frame_sent(const can::Frame&) override {
    --under_way_;
    send_next();
  }
  void bus_lost(const std::string& reason) override {
    fmt::print(stderr, "lost: {}\n", reason);
    std::exit(1);
  }
  [[nodiscard]] bool is_done() const { return sent_ == frames_; }
  [[nodiscard]] bool is_stuck() const { return under_way_ == 0 && !is_done(); }

 private:
  link::BusClient& bus_;
  std::uint64_t frames_;
  std::atomic<std::uint64_t>& received_;
  std::uint64_t sent_ = 0;
  std::uint64_t under_way_ = 0;
};

class Receiver final : public link::BusClientListener {
 public:
  explicit Receiver(std::atomic<std::uint64_t>& received) : received_(received) {}
  void frame_received(const can::Frame& frame) override {
    if (frame.identifier == 0x123) received_.fetch_add(1);
  }
  void bus_lost(const std::string&) override {}

 private:
  std::atomic<std::uint64_t>& received_;
};

int measure(const std::string& text, std::uint64_t frames) {
  boost::asio::io_context one{1};
  boost::asio::io_context other{1};
  std::unique_ptr<link::BusClient> near;
  std::unique_ptr<link::BusClient> far;
  if (text == "pair") {
    auto pair = link::open_socket_pair(one, other);
    if (!pair) return fmt::print(stderr, "{}\n", pair.error()), 1;
    near = std::move(pair->first);
    far = std::move(pair->second);
  } else {
    const auto address = link::parse_bus_address(text);
    if (!address) return fmt::print(stderr, "{}\n", address.error()), 2;
    auto first = link::open_bus(one, *address);
    auto second = link::open_bus(other, *address);
    if (!first || !second) return fmt::print(stderr, "{}\n", !first ? first.error() : second.error()), 1;
    near = std::move(*first);
    far = std::move(*second);
  }
  std::atomic<std::uint64_t> received = 0;
  Sender sender(*near, frames, received);
  Receiver receiver(received);
  near->set_user(&sender);
  far->set_user(&receiver);
  auto work = boost::asio::make_work_guard(other);
  std::thread thread([&] { other.run(); });
  const auto begin = Clock::now();
  const auto processor = processor_time();
  std::uint64_t before = 0;
  auto last_progress = begin;
  sender.send_next();
  while (received.load() < frames && Clock::now() - last_progress < 2s) {
    one.run_one_for(200us);
    sender.send_next();
    if (received.load() != before) {
      before = received.load();
      last_progress = Clock::now();
    }
  }
  const auto wall = last_progress - begin;
  const auto used = processor_time() - processor;
  boost::asio::post(other, [&] { other.stop(); });
  thread.join();
  report(text, received.load(), frames - received.load(), wall, used);
  return received.load() > 0 ? 0 : 1;
}

/// write() and read() of raw sockets in one thread.
int measure_system_calls(const std::string& interface, std::uint64_t frames) {
  const auto open = [&] {
    const int socket = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    sockaddr_can place{};
    place.can_family = AF_CAN;
    place.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    if (socket < 0 || ::bind(socket, reinterpret_cast<const sockaddr*>(&place), sizeof place) < 0) {
      std::perror(interface.c_str());
      std::exit(1);
    }
    return socket;
  };
  const int out = open();
  const int in = open();
  can_frame frame{};
  frame.can_id = 0x123;
  frame.can_dlc = 8;
  const auto begin = Clock::now();
  const auto processor = processor_time();
  std::uint64_t done = 0;
  for (; done < frames; ++done) {
    if (::write(out, &frame, sizeof frame) != sizeof frame ||
        ::read(in, &frame, sizeof frame) != sizeof frame)
      break;
  }
  report("write() and read(), " + interface, done, frames - done, Clock::now() - begin,
         processor_time() - processor);
  ::close(out);
  ::close(in);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    fmt::print(stderr, "usage: bench_link ADDRESS|pair [FRAMES]\n");
    return 2;
  }
  const std::string address = argv[1];
  const std::uint64_t frames = argc == 3 ? std::stoull(argv[2]) : 100'000;
  constexpr std::string_view socketcan = "socketcan:";
  if (address.starts_with(socketcan)) (void)measure_system_calls(address.substr(socketcan.size()), frames);
  return measure(address, frames);
}
