// How long a frame's exact length takes, and how long a frame takes on a full simulated bus.

#include "canopus/sim/bus/bus.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/canopen/service/frame_of.hpp"
#include "canopus/sim/bus/line/line.hpp"

#include "measure.hpp"
#include "network.hpp"

namespace {

using namespace canopus;

std::vector<can::Frame> random_frames(std::size_t count) {
  std::mt19937_64 random(1);
  std::vector<can::Frame> frames(count);
  for (can::Frame& frame : frames) {
    frame.identifier = static_cast<std::uint32_t>(random() & 0x7FF);
    frame.dlc = 8;
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
  }
  return frames;
}

void frame_bits_of_random_8_byte_frames(benchmark::State& state) {
  const auto frames = random_frames(4096);
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(can::frame_bits(frames[next]));
    next = (next + 1) & 4095;
  }
  bench::report(state, static_cast<std::uint64_t>(state.iterations()));
}
BENCHMARK(frame_bits_of_random_8_byte_frames)->Apply(bench::standard);

void frame_bits_each_after_the_last(benchmark::State& state) {
  const auto frames = random_frames(4096);
  std::size_t next = 0;
  for (auto _ : state) {
    const unsigned bits = can::frame_bits(frames[next]);
    next = (next + bits) & 4095;
  }
  benchmark::DoNotOptimize(next);
  bench::report(state, static_cast<std::uint64_t>(state.iterations()));
}
BENCHMARK(frame_bits_each_after_the_last)->Apply(bench::standard);

// A node that always has a frame waiting, and counts what it hears.
class Talker final : public can::Participant {
 public:
  Talker(sim::Bus& bus, can::Timeline& timeline, std::uint32_t number) : number_(number) {
    port = &bus.add_port("talker");
    alarm() = can::Time{};
    timeline.add(*this);
    port->connect(*this);
    frame_ = can::data_frame(0x180 + number, {0, 0, 0, 0, 0, 0, 0, 0});
  }
  void start() { port->send(frame_); }
  void receive(const can::Frame& frame, can::Time) override { sum += frame.data[0]; }
  void transmitted(const can::Frame&, can::Time) override {
    // A counter and some bits that move, as process data have.
    ++turn_;
    const std::uint64_t moving = (turn_ * 37 + number_) & 0xFF;
    frame_ = canopen::frame_of({0x180 + number_, 8}, (turn_ & 0xFF) | moving << 24 | (moving ^ 0x5A) << 48);
    port->send(frame_);
  }
  void tick(can::Time now) override { alarm() = now + std::chrono::milliseconds(100); }

  sim::Port* port = nullptr;
  std::uint64_t sum = 0;

 private:
  std::uint32_t number_;
  std::uint64_t turn_ = 0;
  can::Frame frame_;
};

struct FullBus {
  FullBus(can::Timeline& timeline, std::uint32_t nodes, bool everybody_hears_all)
      : bus("bench", 1'000'000, timeline) {
    for (std::uint32_t number = 0; number < nodes; ++number) {
      talkers.push_back(std::make_unique<Talker>(bus, timeline, number));
      if (number == 0 || everybody_hears_all) continue;
      sim::Acceptance slave;
      slave.base.reset();
      for (const std::uint32_t identifier : {0x000U, 0x080U, 0x100U, 0x200U + number, 0x600U + number}) {
        slave.base.set(identifier);
      }
      slave.extended = false;
      talkers.back()->port->accept(slave);
    }
    for (auto& talker : talkers) talker->start();
  }
  sim::Bus bus;
  std::vector<std::unique_ptr<Talker>> talkers;
};

// Buses at 100 % load, 1 Mbit/s, on one timeline. everybody_hears_all = 0: the first node hears everything,
// the others what a CANopen slave listens to; 1: everybody hears everything.
void full_bus(benchmark::State& state) {
  using namespace std::chrono_literals;
  can::Timeline timeline;
  std::vector<std::unique_ptr<FullBus>> buses;
  for (std::int64_t i = 0; i < state.range(1); ++i) {
    buses.push_back(
        std::make_unique<FullBus>(timeline, static_cast<std::uint32_t>(state.range(0)), state.range(2) != 0));
  }
  can::Time now{};
  const auto frames = [&] {
    std::uint64_t sum = 0;
    for (const auto& full : buses) sum += full->bus.load(now).frames;
    return sum;
  };
  timeline.run_until(now);
  const std::uint64_t before = frames();
  for (auto _ : state) {
    now += 10ms;
    timeline.run_until(now);
  }
  for (const auto& full : buses) {
    if (full->bus.load(now).now < 0.99 && state.iterations() > 200)
      state.SkipWithError("the bus is not full");
  }
  bench::report(state, frames() - before);
  state.counters["simulated_seconds_per_second"] = benchmark::Counter(
      static_cast<double>(state.iterations() * state.range(1)) * 0.01, benchmark::Counter::kIsRate);
}
BENCHMARK(full_bus)
    ->Apply(bench::standard)
    ->ArgNames({"nodes", "buses", "everybody_hears_all"})
    ->Args({2, 1, 0})
    ->Args({3, 1, 0})
    ->Args({9, 1, 0})
    ->Args({33, 1, 0})
    ->Args({127, 1, 0})
    ->Args({127, 4, 0})
    ->Args({127, 16, 0})
    ->Args({127, 1, 1});

// Simulated seconds per second of a bus whose iterations are 10 ms each.
void report_pace(benchmark::State& state, std::uint64_t frames) {
  bench::report(state, frames);
  state.counters["simulated_seconds_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * 0.01, benchmark::Counter::kIsRate);
}

// The same with one frame in `every` hit by a fault in some bit; 1: all of it is error frames.
void full_bus_of_errors(benchmark::State& state) {
  using namespace std::chrono_literals;
  can::Timeline timeline;
  FullBus full(timeline, static_cast<std::uint32_t>(state.range(0)), false);
  const auto every = static_cast<std::uint64_t>(state.range(1));
  if (!full.bus.set_faults({{.kind = sim::FaultKind::corrupt, .every = every}}, 1))
    return state.SkipWithError("no faults");
  can::Time now{};
  timeline.run_until(now);
  for (auto _ : state) {
    now += 10ms;
    timeline.run_until(now);
  }
  const can::BusLoad load = full.bus.load(now);
  if (load.error_frames < load.frames / (every + 1)) state.SkipWithError("frames without their errors");
  report_pace(state, load.frames + load.error_frames);
}
BENCHMARK(full_bus_of_errors)
    ->Apply(bench::standard)
    ->ArgNames({"nodes", "every"})
    ->Args({2, 1})
    ->Args({33, 1})
    ->Args({127, 1})
    ->Args({127, 100});

// A line of 10 m with clocks of 100 ppm, bit by bit: 60 nodes that send by turns, 69 % load at 250 kbit/s.
void exact_line(benchmark::State& state) {
  using namespace std::chrono_literals;
  can::Timeline timeline;
  sim::Bus bus("bench", 250'000, timeline);
  bus.set_line({.length = 10, .clock_ppm = 100});
  std::vector<sim::Port*> ports;
  for (std::int64_t number = 0; number < state.range(0); ++number) ports.push_back(&bus.add_port("node"));
  can::Time now{};
  std::uint32_t turn = 0;
  for (auto _ : state) {
    const can::Time end = now + 10ms;
    for (; now < end; now += 714'286ns) {
      ports[turn % ports.size()]->send(can::data_frame(0x180 + turn % 127, {1, 2, 3, 4, 5, 6, 7, 8}));
      ++turn;
      timeline.run_until(now);
    }
    now = end;
    timeline.run_until(now);
  }
  if (bus.load(now).error_frames > 0) state.SkipWithError("error frames");
  report_pace(state, bus.load(now).frames);
}
BENCHMARK(exact_line)->Apply(bench::standard)->ArgName("nodes")->Arg(5)->Arg(60);

// Heap bytes of one more simulated slave: node, controller and their places on bus and timeline.
void bytes_per_slave(benchmark::State& state) {
  constexpr std::size_t count = 126;
  std::size_t bytes = 0;
  struct Slave {
    Slave(sim::Port& port, std::uint8_t id) : node(bench::slave_description(), id, port) {}
    canopen::Node node;
  };
  for (auto _ : state) {
    can::Timeline timeline;
    sim::Bus bus("bench", 1'000'000, timeline);
    static_cast<void>(bench::slave_description());
    std::vector<std::unique_ptr<Slave>> slaves;
    const std::size_t before = mallinfo2().uordblks;
    for (std::uint8_t id = 1; id <= count; ++id) {
      sim::Port& port = bus.add_port("slave");
      Slave& slave = *slaves.emplace_back(std::make_unique<Slave>(port, id));
      timeline.add(slave.node);
      port.connect(slave.node);
      slave.node.power_on(can::Time{});
      slave.node.command(canopen::NmtCommand::start, can::Time{});
    }
    timeline.run_until(can::Time{} + std::chrono::seconds(1));
    bytes = (mallinfo2().uordblks - before) / count;
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(bytes_per_slave)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
