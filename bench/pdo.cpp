// SYNC and four TPDOs of 8 bytes from each slave, all received by the master into its objects.

#include <cstdint>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "measure.hpp"
#include "network.hpp"

namespace {

using namespace canopus;

struct Network {
  explicit Network(unsigned count) {
    master = std::make_unique<bench::NodeOnBus>(bus, bench::master_description(count), std::uint8_t{1});
    for (unsigned i = 0; i < count; ++i) {
      slaves.push_back(std::make_unique<bench::NodeOnBus>(bus, bench::slave_description(),
                                                          static_cast<std::uint8_t>(i + 2)));
      inputs.push_back(&slaves.back()
                            ->node.dictionary()
                            .block()[slaves.back()->node.dictionary().find(0x6000, 1)->offset]);
    }
    sync.owner = &nobody;
    bus.compile();
  }
  /// New values in the slaves, SYNC, and everything that follows from it.
  void cycle(can::Time now) {
    ++turn;
    for (std::uint8_t* input : inputs) {
      input[0] = static_cast<std::uint8_t>(turn);
      input[24] = static_cast<std::uint8_t>(turn >> 8);
    }
    bus.set_time(now);
    sync.send(can::data_frame(0x080));
  }
  /// The last values of every slave have arrived.
  [[nodiscard]] bool is_right() const {
    for (std::size_t i = 0; i < slaves.size(); ++i) {
      const auto& d = master->node.dictionary();
      const auto word = [&](std::size_t pdo) {
        return d.get<std::uint16_t>(static_cast<std::uint16_t>(0xA000 + 4 * i + pdo), 1);
      };
      if (word(0) != (turn & 0xFF) || word(3) != (turn >> 8 & 0xFF)) return false;
    }
    return true;
  }

  struct Nobody final : can::Participant {
    void receive(const can::Frame&, can::Time) override {}
    void tick(can::Time) override {}
    [[nodiscard]] can::Time deadline() const noexcept override { return can::never; }
  } nobody;
  bench::PassThroughBus bus;
  bench::PassThroughBus::Port sync{bus};
  std::unique_ptr<bench::NodeOnBus> master;
  std::vector<std::unique_ptr<bench::NodeOnBus>> slaves;
  std::vector<std::uint8_t*> inputs;
  unsigned turn = 0;
};

void sync_and_four_tpdos(benchmark::State& state) {
  std::vector<std::unique_ptr<Network>> networks;
  for (std::int64_t i = 0; i < state.range(1); ++i) {
    networks.push_back(std::make_unique<Network>(static_cast<unsigned>(state.range(0))));
  }
  std::uint64_t before = 0;
  for (const auto& network : networks) before += network->bus.frames();
  can::Time now{};
  for (auto _ : state) {
    now += std::chrono::milliseconds(10);
    for (const auto& network : networks) network->cycle(now);
  }
  std::uint64_t after = 0;
  for (const auto& network : networks) {
    after += network->bus.frames();
    if (!network->is_right()) state.SkipWithError("values are missing");
  }
  if (after - before !=
      static_cast<std::uint64_t>(state.iterations() * state.range(1) * (4 * state.range(0) + 1))) {
    state.SkipWithError("frames are missing");
  }
  bench::report(state, after - before);
}
BENCHMARK(sync_and_four_tpdos)->Apply(bench::nodes_and_buses)->Args({16, 1});

}  // namespace

BENCHMARK_MAIN();
