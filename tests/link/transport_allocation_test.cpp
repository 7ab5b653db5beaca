// A transport in steady state allocates nothing for the frames it carries, in either direction: the program's operator
// new counts. The other side is a socket of this machine that answers each frame with another one.

#include <array>
#include <chrono>
#include <string>
#include <string_view>

#include <arpa/inet.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "canopus/link/bus_client.hpp"

#include "support/counted_allocations.hpp"

namespace canopus::link::transport_allocation_test {
namespace {

using namespace std::chrono_literals;
using namespace std::string_view_literals;

struct Counter final : BusClientListener {
  void frame_received(const can::Frame&) override { ++received; }
  void frame_sent(const can::Frame&) override { ++sent; }
  void bus_lost(const std::string& reason) override { lost = reason; }

  std::size_t received = 0, sent = 0;
  std::string lost;
};

struct Case {
  const char* name;
  const char* address;  // the port follows
  bool is_stream;
  /// What the other side says to what it heard; nothing: it does not answer that.
  std::string_view (*answer)(std::string_view heard);
};

std::string_view cannelloni_datagram(std::string_view) {
  static std::array datagram = {'\x02', '\x00', '\x00', '\x00', '\x01', '\x00',
                                '\x00', '\x01', '\x81', '\x02', '\x11', '\x22'};
  ++datagram[2];  // they are numbered
  return {datagram.data(), datagram.size()};
}
std::string_view cannelloni_stream(std::string_view heard) {
  if (heard.empty()) return ""sv;
  return heard.starts_with("CANNELLONI") ? "CANNELLONIv1"sv : "\x00\x00\x01\x81\x02\x11\x22"sv;
}
std::string_view slcan(std::string_view heard) {
  if (heard.find('t') != std::string_view::npos) return "z\rt18121122\r"sv;
  if (heard.find('F') != std::string_view::npos) return "F00\r"sv;
  return heard.find('O') != std::string_view::npos ? "\r"sv : ""sv;
}
std::string_view socketcand(std::string_view heard) {
  if (heard.empty()) return "< hi >"sv;
  if (heard.starts_with("< send")) return "< frame 181 1.000000 1122 >"sv;
  return "< ok >"sv;
}

constexpr std::array cases = {
    Case{"cannelloni over UDP", "cannelloni:127.0.0.1:", false, cannelloni_datagram},
    Case{"cannelloni over TCP", "cannelloni:tcp:127.0.0.1:", true, cannelloni_stream},
    Case{"slcan", "slcan:tcp:127.0.0.1:", true, slcan},
    Case{"socketcand", "socketcand:127.0.0.1:", true, socketcand},
};

/// The other side, without a library: it must not allocate either.
class Peer {
 public:
  explicit Peer(const Case& the_case) : case_(the_case) {
    listening_ = ::socket(AF_INET, (case_.is_stream ? SOCK_STREAM : SOCK_DGRAM) | SOCK_NONBLOCK, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof here;
    EXPECT_EQ(::bind(listening_, reinterpret_cast<const sockaddr*>(&here), size), 0);
    if (case_.is_stream) {
      EXPECT_EQ(::listen(listening_, 1), 0);
    }
    EXPECT_EQ(::getsockname(listening_, reinterpret_cast<sockaddr*>(&here), &size), 0);
    port_ = ntohs(here.sin_port);
  }
  ~Peer() {
    ::close(listening_);
    if (connection_ >= 0) ::close(connection_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  [[nodiscard]] std::string address() const {
    return case_.address + std::to_string(port_) +
           (case_.is_stream ? "" : ":" + std::to_string(port_ == 65535 ? 1024 : port_ + 1));
  }
  /// Accepts, hears and answers what is there.
  void turn() {
    if (case_.is_stream && connection_ < 0) {
      connection_ = ::accept4(listening_, nullptr, nullptr, SOCK_NONBLOCK);
      if (connection_ < 0) return;
      write(case_.answer(""));
    }
    std::array<char, 4096> input;
    socklen_t size = sizeof from_;
    const ssize_t heard = case_.is_stream ? ::recv(connection_, input.data(), input.size(), MSG_DONTWAIT)
                                          : ::recvfrom(listening_, input.data(), input.size(), MSG_DONTWAIT,
                                                       reinterpret_cast<sockaddr*>(&from_), &size);
    if (heard > 0) write(case_.answer({input.data(), static_cast<std::size_t>(heard)}));
  }

 private:
  void write(std::string_view text) {
    if (text.empty()) return;
    if (case_.is_stream) {
      EXPECT_EQ(::send(connection_, text.data(), text.size(), MSG_NOSIGNAL),
                static_cast<ssize_t>(text.size()));
    } else {
      (void)::sendto(listening_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&from_),
                     sizeof from_);
    }
  }

  const Case& case_;
  int listening_ = -1;
  int connection_ = -1;
  std::uint16_t port_ = 0;
  sockaddr_in from_{};
};

class TransportAllocation : public testing::TestWithParam<Case> {};

TEST_P(TransportAllocation, NoneInSteadyState) {
  boost::asio::io_context io;
  Peer peer(GetParam());
  const auto address = parse_bus_address(peer.address());
  ASSERT_TRUE(address) << address.error();
  // The other side takes its turn while the client waits.
  struct Turn {
    boost::asio::io_context& io;
    Peer& peer;
    boost::asio::steady_timer timer{io};
    bool over = false;
    void again() {
      peer.turn();
      if (over) return;
      timer.expires_after(0ms);
      timer.async_wait([this](boost::system::error_code failure) {
        if (!failure) again();
      });
    }
  } turn{io, peer};
  turn.again();
  auto bus = open_bus(io, *address, {.time_out = 20s});
  ASSERT_TRUE(bus) << bus.error();
  Counter counter;
  (*bus)->set_user(&counter);
  const can::Frame frame = can::data_frame(0x123, {1, 2, 3, 4, 5, 6, 7, 8});
  const auto exchange = [&](std::size_t rounds) {
    for (std::size_t i = 0; i < rounds; ++i) {
      const std::size_t sent = counter.sent + 1;
      const std::size_t received = counter.received + 1;
      if (!(*bus)->send(frame)) return false;
      for (int patience = 0; counter.sent < sent || counter.received < received; ++patience) {
        if (patience > 1'000'000 || !counter.lost.empty()) return false;
        io.run_one();
      }
    }
    return true;
  };
  ASSERT_TRUE(exchange(200)) << counter.lost;
  const std::size_t before = counted::allocations;
  EXPECT_TRUE(exchange(500)) << counter.lost;
  EXPECT_EQ(counted::allocations, before);
  turn.over = true;
}

INSTANTIATE_TEST_SUITE_P(Transports, TransportAllocation, testing::ValuesIn(cases), [](const auto& the_case) {
  std::string name = the_case.param.name;
  std::erase(name, ' ');
  return name;
});

}  // namespace
}  // namespace canopus::link::transport_allocation_test
