// How long a frame's exact length takes, and how long a frame takes on a full simulated bus.

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "canopus/can/frame_bits.hpp"

namespace can = canopus::can;

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

}  // namespace

BENCHMARK_MAIN();
