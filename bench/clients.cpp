// 64 clients over all servers of one rack while its network runs: MC protocol 3E over TCP, 4E over UDP, 1E over TCP, Modbus TCP,
// and the control server. Each writes words of its own (of the control server: forces a value of its own) and reads them
// back; a wrong byte anywhere ends the bench. A child process is `canopus run`, this one is all the clients; each of them
// has one request on the way at any time.
//
// The same load on a child that only sends back what it gets tells what of it is the kernel's and the clients' own.

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <poll.h>
#include <sched.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canopus/cli/run/run_loop.hpp"

#include "measure.hpp"
#include "rack_client.hpp"

namespace {

using namespace canopus::bench;
using namespace std::chrono_literals;

/// Client and program take turns on one core, as all figures are meant.
void stay_on_one_core() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(static_cast<unsigned>(std::max(0, ::sched_getcpu())), &cores);
  ::sched_setaffinity(0, sizeof cores, &cores);
}

int bound_socket(int type, std::uint16_t& port) {
  const int socket = ::socket(AF_INET, type, 0);
  const int on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address = loopback(port);
  socklen_t size = sizeof address;
  ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size);
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  port = ntohs(address.sin_port);
  return socket;
}

// --- the child processes ---

using Ports = std::array<std::uint16_t, server_count>;

/// Sends everything back, on each port.
[[noreturn]] void echo(const std::array<int, server_count>& listening) {
  const int poll = ::epoll_create1(0);
  const auto add = [poll](int socket) {
    epoll_event event{.events = EPOLLIN, .data = {.fd = socket}};
    ::epoll_ctl(poll, EPOLL_CTL_ADD, socket, &event);
  };
  for (const int socket : listening) add(socket);
  std::array<char, 4096> buffer{};
  while (true) {
    std::array<epoll_event, 64> events{};
    const int count = ::epoll_wait(poll, events.data(), static_cast<int>(events.size()), -1);
    for (int i = 0; i < count; ++i) {
      const int socket = events[static_cast<std::size_t>(i)].data.fd;
      const auto* const found = std::ranges::find(listening, socket);
      if (found == listening.end()) {
        const ssize_t size = ::recv(socket, buffer.data(), buffer.size(), 0);
        if (size <= 0)
          ::close(socket);
        else
          (void)!::send(socket, buffer.data(), static_cast<std::size_t>(size), MSG_NOSIGNAL);
      } else if (is_udp(static_cast<Server>(found - listening.begin()))) {
        sockaddr_in from{};
        socklen_t from_size = sizeof from;
        auto* const address = reinterpret_cast<sockaddr*>(&from);
        const ssize_t size = ::recvfrom(socket, buffer.data(), buffer.size(), 0, address, &from_size);
        if (size > 0)
          (void)!::sendto(socket, buffer.data(), static_cast<std::size_t>(size), 0, address, from_size);
      } else {
        add(::accept(socket, nullptr, nullptr));
      }
    }
  }
}

std::string plant_text(const Ports& ports) {
  const auto at = [&](Server server) {
    return "\"127.0.0.1:" + std::to_string(ports[static_cast<std::size_t>(server)]) + "\"\n";
  };
  std::string text =
      "[plant]\ncontrol = " + at(Server::control) + "[[bus]]\nname = \"line1\"\nbit_rate = 1_000_000\n";
  for (const int node : {2, 3}) {
    text += "[[device]]\nnode = " + std::to_string(node) + "\nname = \"io" + std::to_string(node) +
            "\"\neds = \"" CANOPUS_SOURCE_DIR
            "/examples/devices/io-block.eds\"\nobjects = { \"1017:00\" = 100 }\n"
            "[[device.behaviour]]\nobject = \"6000:01\"\nkind = \"counter\"\nlow = 0\nhigh = 255\nperiod = "
            "\"10ms\"\n";
  }
  return text + "[[plc]]\nlisten = " + at(Server::frame_3e) +
         "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nnode = 1\nmaster = true\nexchange = "
         "\"10ms\"\nslaves = \"all\"\n"
         "[[plc.port]]\ntransport = \"udp\"\nlisten = " +
         at(Server::udp_4e) + "[[plc.port]]\nframe = \"1E\"\nlisten = " + at(Server::frame_1e) +
         "[[plc.modbus]]\nlisten = " + at(Server::modbus);
}

/// A child with the five servers.
class Child {
 public:
  explicit Child(bool only_echoes) {
    stay_on_one_core();
    std::array<int, server_count> listening{};
    for (std::size_t i = 0; i < server_count; ++i) {
      const bool udp = is_udp(static_cast<Server>(i));
      listening[i] = bound_socket(udp ? SOCK_DGRAM : SOCK_STREAM, ports[i]);
      if (!udp && only_echoes) ::listen(listening[i], 64);
    }
    if (!only_echoes) {
      char path[] = "/tmp/canopus-bench-XXXXXX";
      ::close(::mkstemp(path));
      path_ = path;
      std::ofstream(path_) << plant_text(ports);
      for (const int socket : listening) ::close(socket);
    }
    id_ = ::fork();
    if (id_ == 0) {
      if (only_echoes) echo(listening);
      std::_Exit(canopus::cli::run_plant({.plant = path_, .quiet = true}));
    }
    if (only_echoes)
      for (const int socket : listening) ::close(socket);
  }
  ~Child() {
    ::kill(id_, is_plant() ? SIGTERM : SIGKILL);
    ::waitpid(id_, nullptr, 0);
    if (is_plant()) ::unlink(path_.c_str());
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  [[nodiscard]] bool is_plant() const { return !path_.empty(); }

  struct Seconds {
    double user = 0;
    double kernel = 0;
  };
  /// Processor time it has used.
  [[nodiscard]] Seconds used() const {
    std::ifstream file("/proc/" + std::to_string(id_) + "/stat");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    std::istringstream fields(text.substr(text.rfind(')') + 2));  // behind the name: field 3 and further
    std::string field;
    Seconds seconds;
    for (int number = 3; fields >> field && number <= 15; ++number) {
      if (number == 14) seconds.user = std::stod(field) / static_cast<double>(::sysconf(_SC_CLK_TCK));
      if (number == 15) seconds.kernel = std::stod(field) / static_cast<double>(::sysconf(_SC_CLK_TCK));
    }
    return seconds;
  }

  Ports ports{};

 private:
  std::string path_;
  pid_t id_ = 0;
};

using Clients = std::vector<std::unique_ptr<Client>>;

Clients connect_all(const Ports& ports, bool echoes) {
  Clients clients;
  for (std::size_t server = 0; server < server_count; ++server) {
    for (unsigned among = 0; among < clients_of[server]; ++among) {
      auto client = std::make_unique<Client>(static_cast<Server>(server),
                                             static_cast<unsigned>(clients.size()), among, echoes);
      for (int attempt = 0; !client->connect(ports[server]); ++attempt) {
        if (attempt == 1000) return {};
        std::this_thread::sleep_for(10ms);
      }
      clients.push_back(std::move(client));
    }
  }
  return clients;
}

/// Reads the NMT states of nodes 1 to 3 (G601...) through a 3E client that waits for nothing.
bool is_operational(const Client& client) {
  const std::string request =
      "\x50\0\0\xFF\xFF\x03\0\x13\0\0\0\x01\x04\x80\0\0\0\x59\x02\0\xAB\0\0\0\0\xF8\x03\0"s;
  std::array<char, 64> reply{};
  return ::send(client.socket(), request.data(), request.size(), MSG_NOSIGNAL) > 0 &&
         ::recv(client.socket(), reply.data(), reply.size(), 0) == 17 && reply[11] == 5 && reply[13] == 5 &&
         reply[15] == 5;
}

double at(const std::vector<std::uint32_t>& sorted, std::size_t permille) {
  return sorted[std::min(sorted.size() - 1, sorted.size() * permille / 1000)] * 1e-9;
}

void sixty_four_clients(benchmark::State& state) {
  const bool echoes = state.range(0) != 0;
  Child child(echoes);
  Clients clients = connect_all(child.ports, echoes);
  if (clients.size() != 64) return state.SkipWithError("no connection");
  for (int attempt = 0; !echoes && !is_operational(*clients[0]); ++attempt) {
    if (attempt == 600) return state.SkipWithError("the network does not come up");
    std::this_thread::sleep_for(100ms);
  }

  std::array<std::vector<std::uint32_t>, server_count> times;
  std::vector<std::uint32_t> all;
  std::vector<pollfd> sockets;
  for (const auto& client : clients) {
    sockets.push_back({client->socket(), POLLIN, 0});
    client->request();
  }
  const Child::Seconds before = child.used();
  for (auto _ : state) {  // as many replies as there are clients
    for (std::size_t replies = 0; replies < clients.size();) {
      if (::poll(sockets.data(), sockets.size(), 60'000) <= 0)
        return state.SkipWithError("no reply within a minute");
      for (std::size_t i = 0; i < clients.size(); ++i) {
        if (sockets[i].revents == 0) continue;
        Client& client = *clients[i];
        const Client::Reply reply = client.receive();
        if (reply == Client::Reply::waits) continue;
        if (reply == Client::Reply::wrong) return state.SkipWithError(client.description().c_str());
        const auto time = static_cast<std::uint32_t>((Clock::now() - client.requested_at()).count());
        times[static_cast<std::size_t>(client.server())].push_back(time);
        all.push_back(time);
        ++replies;
        client.request();
      }
    }
  }
  const Child::Seconds after = child.used();
  for (const auto& client : clients) {
    Client::Reply reply = Client::Reply::waits;
    while (reply == Client::Reply::waits) reply = client->receive();
    if (reply == Client::Reply::wrong) return state.SkipWithError(client->description().c_str());
  }
  if (!echoes && !is_operational(*clients[0])) return state.SkipWithError("the network came down");

  const auto requests = static_cast<double>(all.size());
  state.counters["server_seconds"] = (after.user - before.user) / requests;
  state.counters["kernel_seconds"] = (after.kernel - before.kernel) / requests;
  const auto print_times = [&](const std::string& who, std::vector<std::uint32_t>& those) {
    std::ranges::sort(those);
    state.counters[who + "p50_seconds"] = at(those, 500);
    state.counters[who + "p99_seconds"] = at(those, 990);
    state.counters[who + "max_seconds"] = at(those, 1000);
  };
  print_times("", all);
  for (std::size_t server = 0; server < server_count; ++server)
    print_times(std::string(names[server]) + '_', times[server]);
  canopus::bench::report(state, all.size());
}
BENCHMARK(sixty_four_clients)
    ->Apply(canopus::bench::standard)
    ->UseRealTime()
    ->ArgName("echo")
    ->Arg(0)
    ->Arg(1)
    ->Iterations(2000);

}  // namespace

BENCHMARK_MAIN();
