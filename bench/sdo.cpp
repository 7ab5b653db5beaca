// SDO transfers between a client and the servers of a bus without bits: every frame is queued once and goes
// to whoever wants it.

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "canopus/canopen/sdo/sdo_client.hpp"

#include "measure.hpp"
#include "network.hpp"

namespace {

using namespace canopus;

struct Client final : can::Participant, canopen::SdoClientUser {
  explicit Client(bench::PassThroughBus& bus, std::uint8_t server) : port(bus), client(port) {
    client.set_server(server);
    bus.add(*this, port, [server](std::uint32_t identifier) { return identifier == 0x580U + server; });
  }
  void receive(const can::Frame& frame, can::Time now) override { client.receive(frame, now); }
  void tick(can::Time now) override { client.tick(now); }
  [[nodiscard]] can::Time deadline() const noexcept override { return client.deadline(); }
  void sdo_finished(canopen::SdoClient& done, can::Time) override {
    finished += done.abort_code() == canopen::AbortCode::none ? 1 : 0;
  }
  bench::PassThroughBus::Port port;
  canopen::SdoClient client;
  std::uint64_t finished = 0;
};

/// `buses` buses with `nodes` slaves each; one client per slave.
struct Networks {
  Networks(std::int64_t nodes, std::int64_t buses) {
    for (std::int64_t i = 0; i < buses; ++i) {
      auto& bus = *all.emplace_back(std::make_unique<bench::PassThroughBus>());
      for (std::int64_t node = 1; node <= nodes; ++node) {
        const auto id = static_cast<std::uint8_t>(node);
        slaves.push_back(std::make_unique<bench::NodeOnBus>(bus, bench::slave_description(), id));
        clients.push_back(std::make_unique<Client>(bus, id));
        bus_of.push_back(&bus);
      }
      bus.compile();
    }
  }
  [[nodiscard]] std::uint64_t frames() const {
    std::uint64_t sum = 0;
    for (const auto& bus : all) sum += bus->frames();
    return sum;
  }
  std::vector<std::unique_ptr<bench::PassThroughBus>> all;
  std::vector<std::unique_ptr<bench::NodeOnBus>> slaves;
  std::vector<std::unique_ptr<Client>> clients;
  std::vector<bench::PassThroughBus*> bus_of;
};

/// Request and answer, with each server in turn: always the same object, or one object and another.
void expedited_upload(benchmark::State& state, std::uint16_t object, std::uint16_t other) {
  Networks networks(state.range(0), state.range(1));
  const std::uint64_t before = networks.frames();
  can::Time now{};
  for (auto _ : state) {
    now += std::chrono::microseconds(100);
    for (std::size_t i = 0; i < networks.clients.size(); ++i) {
      Client& client = *networks.clients[i];
      networks.bus_of[i]->set_time(now);
      client.client.upload(object, 0, client, now);
    }
    std::swap(object, other);
  }
  for (const auto& client : networks.clients) {
    if (client->finished != static_cast<std::uint64_t>(state.iterations())) {
      state.SkipWithError("a transfer failed");
    }
  }
  bench::report(state, networks.frames() - before);
}
void expedited_upload(benchmark::State& state) { expedited_upload(state, 0x1000, 0x1000); }
void expedited_upload_in_turn(benchmark::State& state) { expedited_upload(state, 0x1000, 0x1001); }

void download(benchmark::State& state, canopen::SdoClient::Mode mode) {
  Networks networks(state.range(0), state.range(1));
  std::vector<std::uint8_t> value(64 * 1024);
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = static_cast<std::uint8_t>(i * 7 + i / 251);
  const std::uint64_t before = networks.frames();
  can::Time now{};
  std::size_t next = 0;
  for (auto _ : state) {
    now += std::chrono::microseconds(100);
    Client& client = *networks.clients[next];
    networks.bus_of[next]->set_time(now);
    client.client.download(0x2000, 0, value, client, now, std::chrono::seconds(1), mode);
    if (client.client.busy() || client.client.abort_code() != canopen::AbortCode::none) {
      state.SkipWithError("a transfer failed");
    }
    next = (next + 1) % networks.clients.size();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(value.size()));
  bench::report(state, networks.frames() - before);
}
void segmented_download_64_kib(benchmark::State& state) {
  download(state, canopen::SdoClient::Mode::segmented);
}
void block_download_64_kib(benchmark::State& state) { download(state, canopen::SdoClient::Mode::block); }
BENCHMARK(expedited_upload)->Apply(bench::nodes_and_buses);
BENCHMARK(expedited_upload_in_turn)->Apply(bench::standard)->ArgNames({"nodes", "buses"})->Args({1, 1});
BENCHMARK(segmented_download_64_kib)->Apply(bench::nodes_and_buses);
BENCHMARK(block_download_64_kib)->Apply(bench::nodes_and_buses);

}  // namespace

BENCHMARK_MAIN();
