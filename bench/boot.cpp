// CiA 302 boot-up on a bus without bits: from the master's power-on to all slaves Operational.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "canopus/manager/nmt/master_node.hpp"

#include "measure.hpp"
#include "network.hpp"

namespace {

using namespace canopus;

std::shared_ptr<const canopen::DictionaryDescription> boot_master_description(unsigned slaves) {
  using canopen::DataType;
  canopen::DictionaryBuilder builder;
  bench::add_communication_objects(builder);
  builder.uniform(0x1016, canopen::ObjectCode::array, "Consumer heartbeat time", 127, {.name = "Time"});
  builder.variable(0x1F80, {.name = "NMT start-up", .value = {0x01}});
  builder.object(0x1F81, canopen::ObjectCode::array, "Slave assignment");
  builder.object(0x1F84, canopen::ObjectCode::array, "Device type");
  builder.object(0x1F85, canopen::ObjectCode::array, "Vendor");
  for (unsigned id = 1; id <= 127; ++id) {
    const bool is_slave = id >= 2 && id < 2 + slaves;
    const auto value = [&](std::uint32_t of_a_slave) {
      return canopen::little_endian(is_slave ? of_a_slave : 0, 4);
    };
    const auto sub = static_cast<std::uint8_t>(id);
    builder.sub(0x1F81, sub, {.name = "Node", .value = value(0x0D)});  // a slave, booted, mandatory
    builder.sub(0x1F84, sub, {.name = "Node", .value = value(0x000F0191)});
    builder.sub(0x1F85, sub, {.name = "Node", .value = value(7)});
  }
  return builder.build();
}

class Master final : public manager::MasterNode, manager::MasterListener {
 public:
  Master(bench::PassThroughBus& bus, std::shared_ptr<const canopen::DictionaryDescription> description)
      : Master(std::make_unique<bench::PassThroughBus::Port>(bus), std::move(description)) {
    // The wait between the two resets and the start is the standard's, not the program's work: virtual time.
    bus.add(*this, *port_, [](std::uint32_t identifier) { return identifier > 0x580; });
  }
  bool finished = false;

 private:
  Master(std::unique_ptr<bench::PassThroughBus::Port> port,
         std::shared_ptr<const canopen::DictionaryDescription> description)
      : MasterNode(std::move(description), 1, *port), port_(std::move(port)) {
    master().set_listener(this);
  }
  void start_up_finished(can::Time) override { finished = true; }

  std::unique_ptr<bench::PassThroughBus::Port> port_;
};

/// A master and its slaves, off.
struct Network {
  Network(unsigned count, const std::shared_ptr<const canopen::DictionaryDescription>& description)
      : bus(std::make_unique<bench::PassThroughBus>()) {
    for (unsigned i = 0; i < count; ++i) {
      slaves.push_back(std::make_unique<bench::NodeOnBus>(*bus, bench::slave_description(),
                                                          static_cast<std::uint8_t>(i + 2)));
    }
    master = std::make_unique<Master>(*bus, description);
    bus->compile();
  }
  /// Until all slaves are Operational. False: one is not.
  bool boot() {
    can::Time now{};
    master->power_on(now);
    while (!master->finished && master->deadline() != can::never) {
      now = std::max(now, master->deadline());
      bus->set_time(now);
      master->tick(now);
    }
    return std::ranges::all_of(
        slaves, [](const auto& slave) { return slave->node.state() == canopen::NmtState::operational; });
  }
  std::unique_ptr<bench::PassThroughBus> bus;
  std::vector<std::unique_ptr<bench::NodeOnBus>> slaves;
  std::unique_ptr<Master> master;
};

void boot_up(benchmark::State& state) {
  const auto count = static_cast<unsigned>(state.range(0));
  const auto description = boot_master_description(count);
  std::uint64_t frames = 0;
  for (auto _ : state) {
    state.PauseTiming();
    std::vector<std::unique_ptr<Network>> networks;
    for (std::int64_t i = 0; i < state.range(1); ++i) {
      networks.push_back(std::make_unique<Network>(count, description));
      frames -= networks.back()->bus->frames();
    }
    state.ResumeTiming();
    for (const auto& network : networks) {
      if (!network->boot()) state.SkipWithError("a slave is not operational");
    }
    state.PauseTiming();
    for (const auto& network : networks) frames += network->bus->frames();
    networks.clear();
    state.ResumeTiming();
  }
  bench::report(state, static_cast<std::uint64_t>(state.iterations() * state.range(1)));
  state.counters["frames"] = static_cast<double>(frames) / static_cast<double>(state.iterations());
}
BENCHMARK(boot_up)->Apply(bench::nodes_and_buses)->Unit(benchmark::kMillisecond);

/// What a master asks of all slaves at one moment, before it boots them: four PDOs each way of four objects, whose
/// parameters are the defaults (0) or were written after each reset (1).
void reset_communication(benchmark::State& state) {
  constexpr unsigned count = 126;
  const bool are_written = state.range(0) != 0;
  bench::PassThroughBus bus;
  std::vector<std::unique_ptr<bench::NodeOnBus>> slaves;
  for (unsigned i = 0; i < count; ++i) {
    slaves.push_back(std::make_unique<bench::NodeOnBus>(bus, bench::slave_description(),
                                                        static_cast<std::uint8_t>(i + 2)));
  }
  bus.compile();
  const auto type = canopen::little_endian(1, 1);
  for (auto _ : state) {
    for (const auto& slave : slaves) {
      slave->node.command(canopen::NmtCommand::reset_communication, can::Time{});
      if (!are_written) continue;
      for (const std::uint16_t pdo : {std::uint16_t{0x1400}, std::uint16_t{0x1800}}) {
        if (slave->node.dictionary().write(pdo, 2, type, can::Time{}) != canopen::AbortCode::none) {
          state.SkipWithError("a PDO is not written");
        }
      }
    }
  }
  bench::report(state, static_cast<std::uint64_t>(state.iterations()) * count);
}
BENCHMARK(reset_communication)->Apply(bench::standard)->ArgName("written")->Arg(0)->Arg(1);

}  // namespace

BENCHMARK_MAIN();
