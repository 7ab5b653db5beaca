#pragma once
// How benches are registered and how they say what one of their iterations was worth, so that bench/run can
// also count instructions: with CANOPUS_BENCH_ITERATIONS=n a bench runs exactly n iterations, and the
// difference of two such runs under callgrind is what the iterations in between cost, without any set-up.

#include <cstdint>
#include <cstdlib>

#include <benchmark/benchmark.h>

namespace canopus::bench {

/// For ->Apply().
inline void standard(benchmark::internal::Benchmark* bench) {
  if (const char* iterations = std::getenv("CANOPUS_BENCH_ITERATIONS"))
    bench->Iterations(std::atoll(iterations));
}

/// For ->Apply(), over 1 to 126 nodes, and over buses of 126 nodes each.
inline void nodes_and_buses(benchmark::internal::Benchmark* bench) {
  standard(bench);
  bench->ArgNames({"nodes", "buses"});
  for (const std::int64_t nodes : {1, 2, 8, 32, 126}) bench->Args({nodes, 1});
  bench->Args({126, 4})->Args({126, 16});
}

/// `count` things (frames, requests, exchanges) in all iterations together: time per thing, and things per
/// iteration.
inline void report(benchmark::State& state, std::uint64_t count) {
  const auto things = static_cast<double>(count);
  state.counters["seconds_per_item"] =
      benchmark::Counter(things, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["items_per_iteration"] = benchmark::Counter(things, benchmark::Counter::kAvgIterations);
}

}  // namespace canopus::bench
