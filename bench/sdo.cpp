// SDO transfers between a client and the servers of a bus without bits: every frame is queued once and goes
// to whoever wants it.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"

#include "measure.hpp"
#include "network.hpp"

namespace {

using namespace canopus;

struct Client final : can::Participant, canopen::SdoClientListener {
  explicit Client(bench::PassThroughBus& bus, std::uint8_t server) : port(bus), client(port) {
    client.set_server(server);
    alarm().add_part(client.alarm());
    bus.add(*this, port, [server](std::uint32_t identifier) { return identifier == 0x580U + server; });
  }
  void receive(const can::Frame& frame, can::Time now) override { client.receive(frame, now); }
  void tick(can::Time now) override { client.tick(now); }
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
    const auto description = bench::make_slave_description(bench::sdo_objects);
    for (std::int64_t i = 0; i < buses; ++i) {
      auto& bus = *all.emplace_back(std::make_unique<bench::PassThroughBus>());
      for (std::int64_t node = 1; node <= nodes; ++node) {
        const auto id = static_cast<std::uint8_t>(node);
        slaves.push_back(std::make_unique<bench::NodeOnBus>(bus, description, id));
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

/// What is asked for next: an endless row without a pattern that a processor could learn, from one seed.
class RandomObjects {
 public:
  [[nodiscard]] unsigned next() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<unsigned>(state_ >> 33) % bench::sdo_objects;
  }

 private:
  std::uint64_t state_ = 1;
};

constexpr std::uint16_t object_of(unsigned number) { return static_cast<std::uint16_t>(0x2100 + number); }

void check_finished(benchmark::State& state, const Networks& networks) {
  for (const auto& client : networks.clients) {
    if (client->finished != static_cast<std::uint64_t>(state.iterations())) {
      state.SkipWithError("a transfer failed");
    }
  }
}

/// Request and answer, with each server in turn: one of the 64 objects, each time at random.
void expedited_upload(benchmark::State& state) {
  Networks networks(state.range(0), state.range(1));
  for (const auto& slave : networks.slaves) {
    for (unsigned i = 0; i < bench::sdo_objects; ++i) slave->node.dictionary().set(object_of(i), 0, ~i);
  }
  RandomObjects random;
  const std::uint64_t before = networks.frames();
  std::uint64_t wrong = 0;
  can::Time now{};
  for (auto _ : state) {
    now += std::chrono::microseconds(100);
    const unsigned number = random.next();
    for (std::size_t i = 0; i < networks.clients.size(); ++i) {
      Client& client = *networks.clients[i];
      networks.bus_of[i]->set_time(now);
      client.client.upload(object_of(number), 0, client, now);
      wrong += can::load_u32(client.client.data()) != ~number ? 1 : 0;
    }
  }
  if (wrong != 0) state.SkipWithError("a value is wrong");
  check_finished(state, networks);
  bench::report(state, networks.frames() - before);
}

/// The same the other way; each value is another than the one before.
void expedited_download(benchmark::State& state) {
  Networks networks(state.range(0), state.range(1));
  RandomObjects random;
  std::array<std::uint32_t, bench::sdo_objects> last{};
  const std::uint64_t before = networks.frames();
  can::Time now{};
  std::uint32_t value = 0;
  std::array<std::uint8_t, 4> bytes{};
  for (auto _ : state) {
    now += std::chrono::microseconds(100);
    const unsigned number = random.next();
    last[number] = value += 0x01234567;
    std::memcpy(bytes.data(), &value, 4);
    for (std::size_t i = 0; i < networks.clients.size(); ++i) {
      Client& client = *networks.clients[i];
      networks.bus_of[i]->set_time(now);
      client.client.download(object_of(number), 0, bytes, client, now);
    }
  }
  for (const auto& slave : networks.slaves) {
    for (unsigned i = 0; i < bench::sdo_objects; ++i) {
      if (slave->node.dictionary().get<std::uint32_t>(object_of(i), 0) != last[i]) {
        state.SkipWithError("a value is wrong");
      }
    }
  }
  check_finished(state, networks);
  bench::report(state, networks.frames() - before);
}

/// The same object again and again, as a tool does that shows a value.
void expedited_upload_of_one_object(benchmark::State& state) {
  Networks networks(state.range(0), state.range(1));
  const std::uint64_t before = networks.frames();
  can::Time now{};
  for (auto _ : state) {
    now += std::chrono::microseconds(100);
    networks.bus_of[0]->set_time(now);
    networks.clients[0]->client.upload(0x1000, 0, *networks.clients[0], now);
  }
  check_finished(state, networks);
  bench::report(state, networks.frames() - before);
}

std::vector<std::uint8_t> long_value() {
  std::vector<std::uint8_t> value(64 * 1024);
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = static_cast<std::uint8_t>(i * 7 + i / 251);
  return value;
}

/// 64 KiB into or out of the DOMAIN of each server in turn.
void transfer(benchmark::State& state, bool download, canopen::SdoClient::Mode mode) {
  Networks networks(state.range(0), state.range(1));
  const std::vector<std::uint8_t> value = long_value();
  if (!download) {
    for (const auto& slave : networks.slaves) {
      auto& dictionary = slave->node.dictionary();
      dictionary.assign(*dictionary.find(0x2000, 0), value);
    }
  }
  const std::uint64_t before = networks.frames();
  can::Time now{};
  std::size_t next = 0;
  for (auto _ : state) {
    now += std::chrono::microseconds(100);
    Client& client = *networks.clients[next];
    networks.bus_of[next]->set_time(now);
    if (download) {
      client.client.download(0x2000, 0, value, client, now, std::chrono::seconds(1), mode);
    } else {
      client.client.upload(0x2000, 0, client, now, std::chrono::seconds(1), mode);
    }
    if (client.client.busy() || client.client.abort_code() != canopen::AbortCode::none) {
      state.SkipWithError("a transfer failed");
    }
    next = (next + 1) % networks.clients.size();
  }
  const auto& dictionary = networks.slaves[0]->node.dictionary();
  const auto arrived =
      download ? dictionary.bytes(*dictionary.find(0x2000, 0)) : networks.clients[0]->client.data();
  if (!std::ranges::equal(arrived, value)) state.SkipWithError("the bytes are wrong");
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(value.size()));
  bench::report(state, networks.frames() - before);
}
void segmented_download_64_kib(benchmark::State& state) {
  transfer(state, true, canopen::SdoClient::Mode::segmented);
}
void segmented_upload_64_kib(benchmark::State& state) {
  transfer(state, false, canopen::SdoClient::Mode::segmented);
}
void block_download_64_kib(benchmark::State& state) {
  transfer(state, true, canopen::SdoClient::Mode::block);
}
void block_upload_64_kib(benchmark::State& state) { transfer(state, false, canopen::SdoClient::Mode::block); }

BENCHMARK(expedited_upload)->Apply(bench::nodes_and_buses);
BENCHMARK(expedited_download)->Apply(bench::nodes_and_buses);
BENCHMARK(expedited_upload_of_one_object)->Apply(bench::standard)->ArgNames({"nodes", "buses"})->Args({1, 1});
BENCHMARK(segmented_download_64_kib)->Apply(bench::nodes_and_buses);
BENCHMARK(segmented_upload_64_kib)->Apply(bench::standard)->ArgNames({"nodes", "buses"})->Args({1, 1});
BENCHMARK(block_download_64_kib)->Apply(bench::nodes_and_buses);
BENCHMARK(block_upload_64_kib)->Apply(bench::standard)->ArgNames({"nodes", "buses"})->Args({1, 1});

}  // namespace

BENCHMARK_MAIN();
