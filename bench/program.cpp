// Programs in Structured Text, and the same by hand in C++ (-O2): integers in loops and arrays, arithmetic of REAL with calls, and
// a scan of conditions, timers and counters. By turns in one run; "times" is how much longer the program takes.

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "canopus/program/machine.hpp"
#include "canopus/structured_text/compiler.hpp"

namespace {

using namespace canopus;

program::Machine machine_of(const std::string& text) {
  const std::vector<structured_text::Source> sources = {{"bench.st", text}};
  structured_text::Compilation made = structured_text::compile(sources, nullptr);
  if (!made.program) throw std::runtime_error(made.errors.front().message);
  return program::Machine(made.program);
}

/// ns of processor time of this thread: what other programs of the machine take is not in it.
std::int64_t processor_time() {
  std::timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

/// Both by turns, 100 scans each, until the benchmark has enough. "times" is the ratio of the medians.
template <typename Native>
void compare(benchmark::State& state, program::Machine& machine, Native native, const char* result,
             auto expected) {
  constexpr int scans = 100;  // of one turn
  constexpr std::int64_t period = 1'000'000;
  std::vector<std::int64_t> by_machine;
  std::vector<std::int64_t> by_hand;
  std::int64_t now = 0;
  for (auto _ : state) {
    const std::int64_t begin = processor_time();
    for (int i = 0; i < scans; ++i)
      if (machine.scan(now + i * period, nullptr)) state.SkipWithError("the program ended with a fault");
    const std::int64_t middle = processor_time();
    for (int i = 0; i < scans; ++i) native(now + i * period);
    by_hand.push_back(processor_time() - middle);
    by_machine.push_back(middle - begin);
    now += scans * period;
  }
  if (machine.read(result) != std::to_string(expected())) state.SkipWithError("the results differ");
  const auto median = [](std::vector<std::int64_t>& turns) {
    std::ranges::nth_element(turns, turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2));
    return static_cast<double>(turns[turns.size() / 2]);
  };
  state.counters["times"] = median(by_machine) / median(by_hand);
}

void sort_and_sum(benchmark::State& state) {
  program::Machine machine = machine_of(
      "PROGRAM P VAR a : ARRAY[0..99] OF INT; i, k, t : INT; seed : UDINT := 1; sum : DINT; END_VAR\n"
      "FOR i := 0 TO 99 DO seed := seed * 1103515245 + 12345; a[i] := UDINT_TO_INT(seed / 65536 MOD 10000); "
      "END_FOR;\n"
      "FOR i := 0 TO 98 DO FOR k := 0 TO 98 - i DO\n"
      "IF a[k] > a[k + 1] THEN t := a[k]; a[k] := a[k + 1]; a[k + 1] := t; END_IF; END_FOR; END_FOR;\n"
      "sum := 0; FOR i := 0 TO 99 DO sum := sum + a[i] * (i MOD 3); END_FOR; END_PROGRAM");
  std::array<std::int16_t, 100> a{};
  std::uint32_t seed = 1;
  std::int32_t sum = 0;
  const auto by_hand = [&](std::int64_t) {
    for (std::int16_t& each : a) {
      seed = seed * 1103515245U + 12345U;
      each = static_cast<std::int16_t>(seed / 65536 % 10000);
    }
    for (int i = 0; i <= 98; ++i)
      for (int k = 0; k <= 98 - i; ++k)
        if (a[static_cast<std::size_t>(k)] > a[static_cast<std::size_t>(k + 1)])
          std::swap(a[static_cast<std::size_t>(k)], a[static_cast<std::size_t>(k + 1)]);
    sum = 0;
    for (int i = 0; i <= 99; ++i) sum += static_cast<std::int16_t>(a[static_cast<std::size_t>(i)] * (i % 3));
    benchmark::DoNotOptimize(a);
  };
  compare(state, machine, by_hand, "P.sum", [&] { return sum; });
}
BENCHMARK(sort_and_sum);

/// A controller as a function: not inlined, as a function of a library is not.
[[gnu::noinline]] float limited(float value, float low, float high) {
  return value < low ? low : value > high ? high : value;
}

void controllers(benchmark::State& state) {
  program::Machine machine = machine_of(
      "FUNCTION limited : REAL VAR_INPUT v, low, high : REAL; END_VAR\n"
      "IF v < low THEN limited := low; ELSIF v > high THEN limited := high; ELSE limited := v; END_IF; "
      "END_FUNCTION\n"
      "PROGRAM P VAR i, n : INT; x, y, e, sum, old, out : REAL; steps : DINT; END_VAR\n"
      "FOR i := 1 TO 500 DO e := 50.0 - y; sum := limited(sum + e * 0.01, -100.0, 100.0);\n"
      "out := limited(2.0 * e + 0.5 * sum + 0.1 * (e - old), -10.0, 10.0); old := e; y := y + (out - 0.1 * "
      "y) * 0.01;\n"
      "steps := steps + 1; END_FOR; END_PROGRAM");
  float y = 0, sum = 0, old = 0;
  std::int32_t steps = 0;
  const auto by_hand = [&](std::int64_t) {
    for (int i = 1; i <= 500; ++i) {
      const float e = 50.0F - y;
      sum = limited(sum + e * 0.01F, -100.0F, 100.0F);
      const float out = limited(2.0F * e + 0.5F * sum + 0.1F * (e - old), -10.0F, 10.0F);
      old = e;
      y = y + (out - 0.1F * y) * 0.01F;
      ++steps;
    }
    benchmark::DoNotOptimize(y);
  };
  compare(state, machine, by_hand, "P.steps", [&] { return steps; });
}
BENCHMARK(controllers);

/// 50 stations, each with a state, an on-delay and a counter.
void stations(benchmark::State& state) {
  program::Machine machine = machine_of(
      "FUNCTION_BLOCK Station VAR_INPUT go : BOOL; END_VAR VAR_OUTPUT done : UDINT; END_VAR VAR state : INT; "
      "t : TON; END_VAR\n"
      "CASE state OF 0: IF go THEN state := 1; END_IF;\n"
      "1: t(IN := TRUE, PT := T#5ms); IF t.Q THEN t(IN := FALSE); state := 2; END_IF;\n"
      "2: done := done + 1; state := 0; END_CASE; END_FUNCTION_BLOCK\n"
      "PROGRAM P VAR s : ARRAY[1..50] OF Station; i : INT; total : UDINT; clock : BOOL; END_VAR\n"
      "clock := NOT clock; total := 0;\n"
      "FOR i := 1 TO 50 DO s[i](go := clock OR i MOD 2 = 0); total := total + s[i].done; END_FOR; "
      "END_PROGRAM");
  struct Station {
    int step = 0;
    bool runs = false;
    std::int64_t since = 0;
    std::uint32_t done = 0;
  };
  std::array<Station, 50> all;
  bool clock = false;
  std::uint32_t total = 0;
  const auto by_hand = [&](std::int64_t now) {
    clock = !clock;
    total = 0;
    int number = 0;
    for (Station& s : all) {
      ++number;
      const bool go = clock || number % 2 == 0;
      switch (s.step) {
        case 0:
          if (go) s.step = 1;
          break;
        case 1:
          if (!s.runs) s.since = now;
          s.runs = true;
          if (now - s.since >= 5'000'000) {
            s.runs = false;
            s.step = 2;
          }
          break;
        default: ++s.done; s.step = 0;
      }
      total += s.done;
    }
    benchmark::DoNotOptimize(all);
  };
  compare(state, machine, by_hand, "P.total", [&] { return total; });
}
BENCHMARK(stations);

}  // namespace

BENCHMARK_MAIN();
