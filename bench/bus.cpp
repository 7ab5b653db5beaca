// How long a frame's exact length takes, and how long a frame takes on a full simulated bus.

#include "canopus/sim/bus.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/can/timeline.hpp"

namespace can = canopus::can;
namespace sim = canopus::sim;

namespace {

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
}
BENCHMARK(frame_bits_of_random_8_byte_frames);

void frame_bits_each_after_the_last(benchmark::State& state) {
  const auto frames = random_frames(4096);
  std::size_t next = 0;
  for (auto _ : state) {
    const unsigned bits = can::frame_bits(frames[next]);
    next = (next + bits) & 4095;
  }
  benchmark::DoNotOptimize(next);
}
BENCHMARK(frame_bits_each_after_the_last);

// A node that always has a frame waiting, and counts what it hears.
class Talker final : public can::Participant {
 public:
  Talker(sim::Bus& bus, can::Timeline& timeline, std::uint32_t number) : number_(number) {
    port = &bus.add_port("talker");
    port->connect(*this, timeline.add(*this));
    frame_ = can::data_frame(0x180 + number, {0, 0, 0, 0, 0, 0, 0, 0});
  }
  void start() { port->send(frame_); }
  void receive(const can::Frame& frame, can::Time) override { sum += frame.data[0]; }
  void transmitted(const can::Frame&, can::Time) override {
    // A counter and some bits that move, as process data have.
    ++frame_.data[0];
    frame_.data[3] = static_cast<std::uint8_t>(frame_.data[0] * 37 + number_);
    frame_.data[6] = static_cast<std::uint8_t>(frame_.data[3] ^ 0x5A);
    port->send(frame_);
  }
  void tick(can::Time now) override { heartbeat_ = now + std::chrono::milliseconds(100); }
  [[nodiscard]] can::Time deadline() const noexcept override { return heartbeat_; }

  sim::Port* port = nullptr;
  std::uint64_t sum = 0;

 private:
  std::uint32_t number_;
  can::Frame frame_;
  can::Time heartbeat_{};
};

// Bus at 100 % load, 1 Mbit/s; range(0) nodes. range(1) = 0: the first node hears everything, the others what
// a CANopen slave listens to; 1: everybody hears everything.
void full_bus(benchmark::State& state) {
  using namespace std::chrono_literals;
  can::Timeline timeline;
  sim::Bus bus("bench", 1'000'000, timeline);
  std::vector<std::unique_ptr<Talker>> nodes;
  for (std::uint32_t number = 0; number < static_cast<std::uint32_t>(state.range(0)); ++number) {
    nodes.push_back(std::make_unique<Talker>(bus, timeline, number));
    if (number == 0 || state.range(1) != 0) continue;
    sim::Acceptance slave;
    slave.base.reset();
    for (const std::uint32_t identifier : {0x000U, 0x080U, 0x100U, 0x200U + number, 0x600U + number}) {
      slave.base.set(identifier);
    }
    slave.extended = false;
    nodes.back()->port->accept(slave);
  }
  for (auto& node : nodes) node->start();
  can::Time now{};
  timeline.run_until(now);
  const std::uint64_t before = bus.load(now).frames;
  for (auto _ : state) {
    now += 10ms;
    timeline.run_until(now);
  }
  const double frames = static_cast<double>(bus.load(now).frames - before);
  state.counters["per frame"] =
      benchmark::Counter(frames, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["simulated s/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * 0.01, benchmark::Counter::kIsRate);
}
BENCHMARK(full_bus)
    ->ArgNames({"nodes", "everybody_hears_all"})
    ->Args({2, 0})
    ->Args({8, 0})
    ->Args({32, 0})
    ->Args({127, 0})
    ->Args({127, 1});

}  // namespace

BENCHMARK_MAIN();
