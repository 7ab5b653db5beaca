// The MC protocol over loopback TCP against the program itself: a child process runs a plant in real time (a
// bus, an ME3CAN1-Q, and the PLC's server), this one is the client.

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <netinet/tcp.h>
#include <sched.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canopus/cli/run/run_loop.hpp"

#include "measure.hpp"

namespace {

using boost::asio::ip::tcp;
using Clock = std::chrono::steady_clock;

/// Client and program take turns on one core, as all figures are meant; on two that are idle, waking the
/// other one would be most of what is measured.
void stay_on_one_core() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(static_cast<unsigned>(std::max(0, ::sched_getcpu())), &cores);
  ::sched_setaffinity(0, sizeof cores, &cores);
}

// D100, 64 words.
constexpr std::array<std::uint8_t, 21> read_3e{0x50, 0, 0, 0xFF, 0xFF, 3, 0, 12,   0,  16, 0,
                                               1,    4, 0, 0,    100,  0, 0, 0xA8, 64, 0};
constexpr std::size_t reply_3e = 11 + 2 * 64;

/// What any server costs: a process that sends a reply's bytes for each request's, and looks at neither.
class EchoServer {
 public:
  explicit EchoServer(std::int64_t clients) {
    stay_on_one_core();
    tcp::acceptor acceptor(context_, {boost::asio::ip::address_v4::loopback(), 0});
    child_ = ::fork();
    if (child_ == 0) serve(acceptor.native_handle());
    for (std::int64_t client = 0; client < clients; ++client) {
      sockets.emplace_back(context_).connect(acceptor.local_endpoint());
      sockets.back().set_option(tcp::no_delay(true));
    }
  }
  ~EchoServer() {
    ::kill(child_, SIGTERM);
    ::waitpid(child_, nullptr, 0);
  }
  EchoServer(const EchoServer&) = delete;
  EchoServer& operator=(const EchoServer&) = delete;

 private:
  [[noreturn]] static void serve(int listening) {
    const int poll = ::epoll_create1(0);
    const auto add = [poll](int socket) {
      epoll_event event{.events = EPOLLIN, .data = {.fd = socket}};
      ::epoll_ctl(poll, EPOLL_CTL_ADD, socket, &event);
    };
    add(listening);
    std::array<char, read_3e.size()> request{};
    const std::array<char, reply_3e> reply{};
    std::array<epoll_event, 64> events{};
    while (true) {
      const int count = ::epoll_wait(poll, events.data(), static_cast<int>(events.size()), -1);
      for (int i = 0; i < count; ++i) {
        const int socket = events[static_cast<std::size_t>(i)].data.fd;
        if (socket == listening) {
          const int accepted = ::accept(listening, nullptr, nullptr);
          const int no_delay = 1;
          ::setsockopt(accepted, IPPROTO_TCP, TCP_NODELAY, &no_delay, sizeof no_delay);
          add(accepted);
        } else if (::recv(socket, request.data(), request.size(), 0) <= 0) {
          ::close(socket);
        } else {
          (void)!::send(socket, reply.data(), reply.size(), MSG_NOSIGNAL);
        }
      }
    }
  }
  boost::asio::io_context context_;
  pid_t child_ = 0;

 public:
  std::vector<tcp::socket> sockets;
};

class RunningPlant {
 public:
  /// A CPU with one module for each bus, nodes 1, and so many connections to it.
  explicit RunningPlant(std::int64_t buses = 1, std::int64_t clients = 1) {
    stay_on_one_core();
    {
      tcp::acceptor free(context_, {boost::asio::ip::address_v4::loopback(), 0});
      port_ = free.local_endpoint().port();
    }
    char path[] = "/tmp/canopus-bench-XXXXXX";
    ::close(::mkstemp(path));
    path_ = path;
    std::ofstream file(path_);
    for (std::int64_t bus = 1; bus <= buses; ++bus) {
      file << "[[bus]]\nname = \"line" << bus << "\"\nbit_rate = 1_000_000\n";
    }
    file << "[[plc]]\nlisten = \"127.0.0.1:" << port_ << "\"\n";
    for (std::int64_t bus = 1; bus <= buses; ++bus) {
      file << "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nbus = \"line" << bus << "\"\nhead = " << 32 * (bus - 1)
           << "\nnode = 1\nmaster = true\n";
    }
    file.close();
    child_ = ::fork();
    if (child_ == 0) std::_Exit(canopus::cli::run_plant({.plant = path_, .quiet = true}));
    for (int attempt = 0; attempt < 500; ++attempt) {
      boost::system::error_code error;
      tcp::socket next(context_);
      next.connect({boost::asio::ip::address_v4::loopback(), port_}, error);
      if (!error) {
        next.set_option(tcp::no_delay(true));
        sockets.push_back(std::move(next));
        if (sockets.size() == static_cast<std::size_t>(clients)) return;
        continue;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  ~RunningPlant() {
    ::kill(child_, SIGTERM);
    ::waitpid(child_, nullptr, 0);
    ::unlink(path_.c_str());
  }
  RunningPlant(const RunningPlant&) = delete;
  RunningPlant& operator=(const RunningPlant&) = delete;

 private:
  boost::asio::io_context context_;
  std::uint16_t port_ = 0;
  std::string path_;
  pid_t child_ = 0;

 public:
  std::vector<tcp::socket> sockets;
};

constexpr std::array<std::uint8_t, 25> read_4e{0x54, 0, 1, 0, 0, 0, 0,   0xFF, 0xFF, 3,    0,  12, 0,
                                               16,   0, 1, 4, 0, 0, 100, 0,    0,    0xA8, 64, 0};
constexpr std::size_t reply_4e = 15 + 2 * 64;

/// One request after the other's reply: the median is the figure.
void read_64_words_3e(benchmark::State& state) {
  RunningPlant plant;
  std::array<std::uint8_t, reply_3e> reply{};
  std::vector<std::uint32_t> times;
  times.reserve(1U << 20);
  for (auto _ : state) {
    const auto start = Clock::now();
    boost::asio::write(plant.sockets[0], boost::asio::buffer(read_3e));
    boost::asio::read(plant.sockets[0], boost::asio::buffer(reply));
    const auto time = std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start);
    times.push_back(static_cast<std::uint32_t>(time.count()));
    if (reply[0] != 0xD0 || reply[9] != 0 || reply[10] != 0) return state.SkipWithError("not a good reply");
  }
  std::ranges::sort(times);
  state.counters["p50_seconds"] = times[times.size() / 2] * 1e-9;
  state.counters["p99_seconds"] = times[times.size() * 99 / 100] * 1e-9;
  canopus::bench::report(state, times.size());
}
BENCHMARK(read_64_words_3e)->Apply(canopus::bench::standard)->UseRealTime();

/// A request of each client, then the replies; range(1) buses run meanwhile.
void read_64_words_by_clients(benchmark::State& state) {
  RunningPlant plant(state.range(1), state.range(0));
  if (plant.sockets.size() != static_cast<std::size_t>(state.range(0)))
    return state.SkipWithError("no connection");
  std::array<std::uint8_t, reply_3e> reply{};
  for (auto _ : state) {
    for (auto& socket : plant.sockets) boost::asio::write(socket, boost::asio::buffer(read_3e));
    for (auto& socket : plant.sockets) {
      boost::asio::read(socket, boost::asio::buffer(reply));
      if (reply[0] != 0xD0 || reply[9] != 0 || reply[10] != 0) return state.SkipWithError("not a good reply");
    }
  }
  canopus::bench::report(state, static_cast<std::uint64_t>(state.iterations() * state.range(0)));
}
BENCHMARK(read_64_words_by_clients)
    ->Apply(canopus::bench::standard)
    ->UseRealTime()
    ->ArgNames({"clients", "buses"})
    ->Args({1, 1})
    ->Args({2, 1})
    ->Args({8, 1})
    ->Args({16, 1})
    ->Args({16, 4})
    ->Args({16, 16});

/// The same requests and as many bytes back, from a server that does nothing else.
void echo_by_clients(benchmark::State& state) {
  EchoServer server(state.range(0));
  std::array<std::uint8_t, reply_3e> reply{};
  for (auto _ : state) {
    for (auto& socket : server.sockets) boost::asio::write(socket, boost::asio::buffer(read_3e));
    for (auto& socket : server.sockets) boost::asio::read(socket, boost::asio::buffer(reply));
  }
  canopus::bench::report(state, static_cast<std::uint64_t>(state.iterations() * state.range(0)));
}
BENCHMARK(echo_by_clients)
    ->Apply(canopus::bench::standard)
    ->UseRealTime()
    ->ArgName("clients")
    ->Arg(1)
    ->Arg(16);

/// range(0) requests at once, then their replies.
void read_64_words_4e_pipelined(benchmark::State& state) {
  RunningPlant plant;
  const auto depth = static_cast<std::size_t>(state.range(0));
  std::vector<std::uint8_t> requests;
  for (std::size_t i = 0; i < depth; ++i) {
    requests.insert(requests.end(), read_4e.begin(), read_4e.end());
    requests[requests.size() - read_4e.size() + 2] = static_cast<std::uint8_t>(i);
  }
  std::vector<std::uint8_t> replies(depth * reply_4e);
  for (auto _ : state) {
    boost::asio::write(plant.sockets[0], boost::asio::buffer(requests));
    boost::asio::read(plant.sockets[0], boost::asio::buffer(replies));
    const std::uint8_t* const last = &replies[(depth - 1) * reply_4e];
    if (last[0] != 0xD4 || last[2] != static_cast<std::uint8_t>(depth - 1)) {
      return state.SkipWithError("not a good reply");
    }
  }
  canopus::bench::report(state, static_cast<std::uint64_t>(state.iterations()) * depth);
}
BENCHMARK(read_64_words_4e_pipelined)
    ->Apply(canopus::bench::standard)
    ->UseRealTime()
    ->ArgName("depth")
    ->Arg(16)
    ->Arg(64);

}  // namespace

BENCHMARK_MAIN();
