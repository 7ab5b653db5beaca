// SYNC and four TPDOs of 8 bytes from each slave, all received by the master into its objects. Every slave
// changes all of its 16 mapped values before each SYNC; the master's RPDOs are of synchronous type, so it has
// them after the next SYNC. Also: heap bytes of a slave.

#include <cstdint>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "measure.hpp"
#include "network.hpp"

namespace {

using namespace canopus;

struct Network {
  Network(unsigned count, bench::Delivery delivery) {
    master =
        std::make_unique<bench::NodeOnBus>(bus, bench::master_description(count), std::uint8_t{1}, delivery);
    for (unsigned i = 0; i < count; ++i) {
      slaves.push_back(std::make_unique<bench::NodeOnBus>(bus, bench::slave_description(),
                                                          static_cast<std::uint8_t>(i + 2), delivery));
    }
    for (std::uint8_t sub = 1; sub <= values; ++sub) {
      inputs.push_back(*slaves.front()->node.dictionary().find(0x6000, sub));
    }
    sync.owner = &nobody;
    bus.compile();
  }
  /// New values in the slaves, SYNC, and everything that follows from it.
  void cycle(can::Time now) {
    ++turn;
    for (unsigned slave = 0; slave < slaves.size(); ++slave) {
      canopen::ObjectDictionary& dictionary = slaves[slave]->node.dictionary();
      for (unsigned i = 0; i < values; ++i) dictionary.set(inputs[i], value(turn, slave, i));
    }
    bus.set_time(now);
    sync.send(can::data_frame(0x080));
  }
  static std::uint16_t value(unsigned turn, unsigned slave, unsigned i) {
    return static_cast<std::uint16_t>(turn * 257U + slave * values + i);
  }
  /// After one SYNC more the last values of every slave have arrived.
  [[nodiscard]] bool is_right() {
    sync.send(can::data_frame(0x080));
    const auto& received = master->node.dictionary();
    for (unsigned slave = 0; slave < slaves.size(); ++slave) {
      for (unsigned i = 0; i < values; ++i) {
        const auto object = static_cast<std::uint16_t>(0xA000 + 4 * slave + i / 4);
        const auto sub = static_cast<std::uint8_t>(i % 4 + 1);
        if (received.get<std::uint16_t>(object, sub) != value(turn, slave, i)) return false;
      }
    }
    return true;
  }

  static constexpr unsigned values = 16;  // of a slave
  struct Nobody final : can::Participant {
    void receive(const can::Frame&, can::Time) override {}
    void tick(can::Time) override {}
  } nobody;
  bench::PassThroughBus bus;
  bench::PassThroughBus::Port sync{bus};
  std::unique_ptr<bench::NodeOnBus> master;
  std::vector<std::unique_ptr<bench::NodeOnBus>> slaves;
  std::vector<canopen::Entry> inputs;
  unsigned turn = 0;
};

void sync_and_four_tpdos(benchmark::State& state, bench::Delivery delivery) {
  std::vector<std::unique_ptr<Network>> networks;
  for (std::int64_t i = 0; i < state.range(1); ++i) {
    networks.push_back(std::make_unique<Network>(static_cast<unsigned>(state.range(0)), delivery));
  }
  const auto frames = [&] {
    std::uint64_t sum = 0;
    for (const auto& network : networks) sum += network->bus.frames();
    return sum;
  };
  const std::uint64_t before = frames();
  can::Time now{};
  for (auto _ : state) {
    now += std::chrono::milliseconds(10);
    for (const auto& network : networks) network->cycle(now);
  }
  const std::uint64_t count = frames() - before;
  for (const auto& network : networks) {
    if (!network->is_right()) state.SkipWithError("values are missing");
  }
  if (count != static_cast<std::uint64_t>(state.iterations() * state.range(1) * (4 * state.range(0) + 1))) {
    state.SkipWithError("frames are missing");
  }
  bench::report(state, count);
}
void sync_and_four_tpdos(benchmark::State& state) { sync_and_four_tpdos(state, bench::Delivery::routed); }
void sync_and_four_tpdos_to_all(benchmark::State& state) {
  sync_and_four_tpdos(state, bench::Delivery::broadcast);
}
BENCHMARK(sync_and_four_tpdos)->Apply(bench::nodes_and_buses)->Args({16, 1});
BENCHMARK(sync_and_four_tpdos_to_all)
    ->Apply(bench::standard)
    ->ArgNames({"nodes", "buses"})
    ->Args({16, 1})
    ->Args({126, 1});

// Heap bytes of one more slave, Operational, without a bus: with the description that all share, or one of its
// own.
void heap_per_slave(benchmark::State& state) {
  constexpr std::size_t count = 126;
  std::size_t bytes = 0;
  struct Nowhere final : can::Sink {
    bool send(const can::Frame&) override { return true; }
  } nowhere;
  for (auto _ : state) {
    static_cast<void>(bench::slave_description());
    std::vector<std::unique_ptr<canopen::Node>> slaves;
    slaves.reserve(count);
    const std::size_t before = mallinfo2().uordblks;
    for (std::uint8_t id = 1; id <= count; ++id) {
      const auto description =
          state.range(0) != 0 ? bench::make_slave_description() : bench::slave_description();
      slaves.push_back(std::make_unique<canopen::Node>(description, id, nowhere));
      slaves.back()->power_on(can::Time{});
      slaves.back()->command(canopen::NmtCommand::start, can::Time{});
    }
    bytes = (mallinfo2().uordblks - before) / count;
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(heap_per_slave)->ArgName("own_description")->Arg(0)->Arg(1)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
