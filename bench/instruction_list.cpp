// Instruction lists of MELSEC, and the same by hand in C++ (-O2) on the same devices: contacts and coils, timers and counters, words.
// By turns in one run; "times" is how much longer the list takes.

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "canopus/ascii/number.hpp"
#include "canopus/instruction_list/compiler.hpp"
#include "canopus/program/machine.hpp"

namespace {

using namespace canopus;

/// M, D, TS, TC, TN of the program by hand, 1024 points each: 16 bits a word.
struct Devices {
  std::array<std::array<std::uint16_t, 1024>, 5> memory{};

  [[nodiscard]] bool bit(unsigned device, unsigned number) const {
    return (memory[device][number / 16] >> number % 16 & 1U) != 0;
  }
  void set(unsigned device, unsigned number, bool on) {
    std::uint16_t& word = memory[device][number / 16];
    const auto mask = static_cast<std::uint16_t>(1U << number % 16);
    word = static_cast<std::uint16_t>(on ? word | mask : word & ~mask);
  }
};

/// The same of the list, as the rack of a CPU has them.
class ListedDevices final : public program::DeviceImage, public program::DeviceNames {
 public:
  std::array<std::array<std::uint16_t, 1024>, 5> words{};
  std::array<std::array<std::uint8_t, 1024>, 5> bits{};

  [[nodiscard]] bool is_as(const Devices& other) const {
    for (const unsigned device : {0U, 2U, 3U})
      for (unsigned number = 0; number < 1024; ++number)
        if ((bits[device][number] != 0) != other.bit(device, number)) return false;
    return words[1] == other.memory[1] && words[4] == other.memory[4];
  }
  [[nodiscard]] std::uint16_t* words_in_memory(const program::DevicePoint& first, unsigned) override {
    return &words[first.device][first.number];
  }
  [[nodiscard]] std::uint8_t* bit_in_memory(const program::DevicePoint& point) override {
    return &bits[point.device][point.number];
  }
  program::DeviceError read_words(const program::DevicePoint& first, std::span<std::uint16_t> to) override {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = words[first.device][first.number + i];
    return program::DeviceError::none;
  }
  program::DeviceError write_words(const program::DevicePoint& first,
                                   std::span<const std::uint16_t> from) override {
    for (std::size_t i = 0; i < from.size(); ++i) words[first.device][first.number + i] = from[i];
    return program::DeviceError::none;
  }
  program::DeviceError read_bits(const program::DevicePoint& first, unsigned count,
                                 std::uint32_t& to) override {
    to = 0;
    for (unsigned i = 0; i < count; ++i) to |= std::uint32_t{bits[first.device][first.number + i]} << i;
    return program::DeviceError::none;
  }
  program::DeviceError write_bits(const program::DevicePoint& first, unsigned count,
                                  std::uint32_t from) override {
    for (unsigned i = 0; i < count; ++i) bits[first.device][first.number + i] = from >> i & 1U;
    return program::DeviceError::none;
  }
  [[nodiscard]] std::expected<program::DevicePoint, std::string> point(std::string_view name) const override {
    static constexpr std::array<std::string_view, 5> names = {"M", "D", "TS", "TC", "TN"};
    for (std::uint16_t device = 0; device < names.size(); ++device) {
      if (!name.starts_with(names[device])) continue;
      if (const auto number = ascii::parse_number<std::uint32_t>(name.substr(names[device].size()));
          number && *number < 1024)
        return program::DevicePoint{
            .device = device, .number = *number, .is_bit = device != 1 && device != 4};
    }
    return std::unexpected("expected M, D or T below 1024");
  }
  [[nodiscard]] bool looks_like_device(std::string_view name) const override {
    return point(name).has_value();
  }
};
enum Device : unsigned { m, d, ts, tc, tn };

program::Machine machine_of(const std::string& rows, const ListedDevices& devices) {
  const std::vector<instruction_list::Source> sources = {{"bench.csv", rows + "9,,END,\n"}};
  instruction_list::Compilation made =
      instruction_list::compile(sources, instruction_list::Family::q, devices);
  if (!made.program) throw std::runtime_error(made.errors.front().message);
  return program::Machine(made.program);
}

/// "LD M0" -> rows of a CSV.
std::string rows(std::initializer_list<std::string> lines) {
  std::string made;
  for (const std::string& line : lines) {
    std::string row = "0,,";
    bool is_first = true;
    for (const char c : line) {
      if (c != ' ') {
        row += c;
      } else {
        row += is_first ? "," : "\n,,,";
        is_first = false;
      }
    }
    made += row + '\n';
  }
  return made;
}

/// ns of processor time of this thread: what other programs of the machine take is not in it.
std::int64_t processor_time() {
  std::timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

/// Both by turns, 100 scans each; "times" is the ratio of the medians, and both must leave the same devices.
template <typename Native>
void compare(benchmark::State& state, const std::string& program, Native native) {
  constexpr int scans = 100;
  constexpr std::int64_t period = 1'000'000;
  ListedDevices listed;
  Devices by_hand;
  program::Machine machine = machine_of(program, listed);
  std::vector<std::int64_t> list_times;
  std::vector<std::int64_t> hand_times;
  std::int64_t now = 0;
  for (auto _ : state) {
    const std::int64_t begin = processor_time();
    for (int i = 0; i < scans; ++i)
      if (machine.scan(now + i * period, &listed)) state.SkipWithError("the program ended with a fault");
    const std::int64_t middle = processor_time();
    for (int i = 0; i < scans; ++i) {
      native(by_hand, now + i * period);
      benchmark::DoNotOptimize(by_hand);
      benchmark::ClobberMemory();
    }
    hand_times.push_back(processor_time() - middle);
    list_times.push_back(middle - begin);
    now += scans * period;
  }
  if (!listed.is_as(by_hand)) state.SkipWithError("the devices differ");
  const auto median = [](std::vector<std::int64_t>& turns) {
    std::ranges::nth_element(turns, turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2));
    return static_cast<double>(turns[turns.size() / 2]);
  };
  state.counters["times"] = median(list_times) / median(hand_times);
}

/// 100 rungs of 6 instructions.
void contacts(benchmark::State& state) {
  std::string program = rows({"LDI M0", "OUT M0"});
  for (int i = 1; i <= 100; ++i) {
    const auto at = [&](int offset) { return std::to_string(i + offset); };
    program += rows({"LD M" + at(-1), "AND M" + at(100), "OR M" + at(200), "ANI M" + at(300), "ORI M" + at(1),
                     "OUT M" + at(0)});
  }
  compare(state, program, [](Devices& x, std::int64_t) {
    x.set(m, 0, !x.bit(m, 0));
    for (unsigned i = 1; i <= 100; ++i)
      x.set(m, i,
            (((x.bit(m, i - 1) && x.bit(m, i + 100)) || x.bit(m, i + 200)) && !x.bit(m, i + 300)) ||
                !x.bit(m, i + 1));
  });
}
BENCHMARK(contacts);

/// 50 stations: words that count, compare, and add.
void words(benchmark::State& state) {
  std::string program = rows({"LDI M0", "OUT M0"});
  for (int i = 1; i <= 50; ++i) {
    const auto at = [&](int offset) { return std::to_string(i + offset); };
    program += rows({"LD M0", "INC D" + at(0), "LD> D" + at(0) + " K100", "MOV K0 D" + at(0), "LD M0",
                     "+ D" + at(0) + " D" + at(100), "- D" + at(100) + " K3 D" + at(200),
                     "MOV D" + at(200) + " D" + at(300)});
  }
  compare(state, program, [](Devices& x, std::int64_t) {
    x.set(m, 0, !x.bit(m, 0));
    auto& words = x.memory[d];
    for (unsigned i = 1; i <= 50; ++i) {
      if (x.bit(m, 0)) ++words[i];
      if (static_cast<std::int16_t>(words[i]) > 100) words[i] = 0;
      if (!x.bit(m, 0)) continue;
      words[i + 100] = static_cast<std::uint16_t>(words[i + 100] + words[i]);
      words[i + 200] = static_cast<std::uint16_t>(words[i + 100] - 3);
      words[i + 300] = words[i + 200];
    }
  });
}
BENCHMARK(words);

/// 50 timers of 10 ms that start themselves again.
void timers(benchmark::State& state) {
  std::string program;
  for (int i = 1; i <= 50; ++i) {
    const std::string number = std::to_string(i);
    program += rows({"LDI T" + number, "OUTH T" + number + " K5", "LD T" + number, "INC D" + number});
  }
  struct Timer {
    std::int64_t ticks = -1;
  };
  std::array<Timer, 51> all;
  compare(state, program, [&](Devices& x, std::int64_t now) {
    for (unsigned i = 1; i <= 50; ++i) {
      const bool is_on = !x.bit(ts, i);
      const std::int64_t ticks = now / 10'000'000;
      std::uint16_t& value = x.memory[tn][i];
      bool is_done = false;
      if (is_on) {
        if (x.bit(tc, i))
          value = static_cast<std::uint16_t>(std::min<std::int64_t>(value + ticks - all[i].ticks, 5));
        is_done = value >= 5;
      } else {
        value = 0;
      }
      all[i].ticks = ticks;
      x.set(tc, i, is_on);
      x.set(ts, i, is_done);
      if (is_done) ++x.memory[d][i];
    }
  });
}
BENCHMARK(timers);

}  // namespace

BENCHMARK_MAIN();
