// A whole plant: twenty devices under one ME3CAN1-Q at 1 Mbit/s, in virtual time, built from the example
// device files.

#include "canopus/plant/plant.hpp"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <string_view>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "canopus/eds/device_file.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/serve/slices/plant_slices.hpp"
#include "canopus/sim/bus/waveform/waveform.hpp"
#include "canopus/sim/device/device.hpp"

#include "measure.hpp"

namespace {

using namespace canopus;

constexpr const char* kinds[] = {"io-block", "encoder", "drive"};
constexpr const char* moving[] = {"6000:01", "6004:00", "606C:00"};

enum class Racks : std::uint8_t { one, one_per_bus };

/// Buses with so many devices and a module each. Each device's value moves in every `period`.
std::string plant_text(unsigned devices = 20, unsigned buses = 1, const std::string& period = "10ms",
                       Racks racks = Racks::one) {
  std::string text;
  std::string modules;
  for (unsigned number = 1; number <= buses; ++number) {
    const std::string bus = "\"line" + std::to_string(number) + "\"\n";
    text += "[[bus]]\nname = " + bus + "bit_rate = 1_000_000\n";
    for (unsigned i = 0; i < devices; ++i) {
      text += "[[device]]\nbus = " + bus + "node = " + std::to_string(i + 2) +
              "\neds = \"" CANOPUS_SOURCE_DIR "/examples/devices/" + kinds[i % 3] +
              ".eds\"\nobjects = { \"1017:00\" = 100 }\n[[device.behaviour]]\nobject = \"" + moving[i % 3] +
              "\"\nkind = \"counter\"\nhigh = 100\nperiod = \"" + period + "\"\n";
    }
    if (number == 1 || racks == Racks::one_per_bus) {
      modules += "[[plc]]\nname = \"plc" + std::to_string(number) + "\"\nlisten = \"off\"\n";
    }
    modules += "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nbus = " + bus +
               "head = " + std::to_string(racks == Racks::one ? 32 * (number - 1) : 0) +
               "\nnode = 1\nmaster = true\nexchange = \"10ms\"\nslaves = \"all\"\n";
  }
  return text + modules;
}

struct Nobody final : plant::PlantObserver {};

enum class Records : std::uint8_t { nothing, waveform };

/// A second of plant time; per item: a frame on a bus.
void simulated_seconds(benchmark::State& state, const std::string& text, unsigned buses,
                       Records records = Records::nothing, const std::string& path = "bench.toml") {
  const plant::PlantReading reading = plant::read_plant(text, path);
  Nobody nobody;
  auto plant = plant::Plant::build(reading.plant, nobody);
  if (!reading.errors.empty() || !plant) return state.SkipWithError("the plant cannot be built");
  (*plant)->power_on();
  can::Timeline& timeline = (*plant)->timeline();
  timeline.run_until(can::Time{} + std::chrono::seconds(10));
  for (const plant::NodeStatus& node : (*plant)->nodes()) {
    if (node.state != canopen::NmtState::operational) return state.SkipWithError("a node is not operational");
  }
  const auto all_frames = [&] {
    std::uint64_t sum = 0;
    for (unsigned bus = 0; bus < buses; ++bus) sum += (*plant)->bus(bus).load(timeline.now()).frames;
    return sum;
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), std::fclose);
  if (!file) return state.SkipWithError("no file for the waveform");
  std::uint64_t bytes = 0;
  std::optional<sim::Waveform> waveform;
  if (records == Records::waveform) {
    waveform.emplace(*(*plant)->simulated_bus(0), timeline.now(), [&](std::string_view part) {
      bytes += std::fwrite(part.data(), 1, part.size(), file.get());
    });
  }
  const std::uint64_t frames_before = all_frames();
  for (auto _ : state) {
    timeline.run_until(timeline.now() + std::chrono::seconds(1));
    std::rewind(file.get());
  }
  const std::uint64_t frames = all_frames() - frames_before;
  bench::report(state, frames);
  const auto seconds = static_cast<double>(state.iterations());
  state.counters["frames_per_simulated_second"] = static_cast<double>(frames) / seconds;
  state.counters["simulated_seconds_per_second"] = benchmark::Counter(seconds, benchmark::Counter::kIsRate);
  if (!waveform) return;
  state.counters["waveform_bytes_per_simulated_second"] = static_cast<double>(bytes) / seconds;
}
void twenty_devices_simulated_seconds(benchmark::State& state) { simulated_seconds(state, plant_text(), 1); }
BENCHMARK(twenty_devices_simulated_seconds)->Apply(bench::standard)->Unit(benchmark::kMillisecond);

void simulated_seconds_by_nodes(benchmark::State& state) {
  const auto buses = static_cast<unsigned>(state.range(1));
  simulated_seconds(state, plant_text(static_cast<unsigned>(state.range(0)), buses, "50ms"), buses);
}
/// A program of 1,000 steps, as an instruction list counts them: 250 conditions of three operands and their results.
std::string program_text(bool has_devices) {
  std::string variables;
  std::string statements;
  for (int i = 0; i < 250; ++i) {
    const auto point = [has_devices](int number) {
      return (has_devices ? "M" : "label") + std::to_string(number);
    };
    variables += point(i) + ", ";
    statements += point(i) + " := " + point((i + 248) % 250) + " AND NOT " + point((i + 1) % 250) + " OR " +
                  point(7 * i % 250) + ";\n";
  }
  return "PROGRAM Main\n" + (has_devices ? "" : "VAR " + variables + "last : BOOL; END_VAR\n") + statements +
         "END_PROGRAM\n";
}

/// 32 devices, and a CPU that executes such a program in a scan of 1 ms: 0 without it, 1 of labels, 2 of devices.
void thirty_two_devices(benchmark::State& state) {
  std::string text = plant_text(32, 1, "50ms");
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "canopus-bench-plant";
  if (state.range(0) != 0) {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "main.st") << program_text(state.range(0) == 2);
    const std::string_view plc = "listen = \"off\"\n";
    text.insert(text.find(plc) + plc.size(), "program = [\"main.st\"]\nscan = \"1ms\"\n");
  }
  simulated_seconds(state, text, 1, Records::nothing, (folder / "bench.toml").string());
  std::filesystem::remove_all(folder);
}
BENCHMARK(thirty_two_devices)
    ->Apply(bench::standard)
    ->ArgName("program")
    ->DenseRange(0, 2)
    ->Unit(benchmark::kMillisecond);

BENCHMARK(simulated_seconds_by_nodes)->Apply(bench::nodes_and_buses)->Unit(benchmark::kMillisecond);

/// At 93 % load.
void simulated_seconds_at_full_load(benchmark::State& state) {
  simulated_seconds(state, plant_text(126, 1, "13ms"), 1);
}
BENCHMARK(simulated_seconds_at_full_load)->Apply(bench::standard)->Unit(benchmark::kMillisecond);

/// The same.
void simulated_seconds_with_a_waveform(benchmark::State& state) {
  simulated_seconds(state, plant_text(126, 1, "13ms"), 1, Records::waveform);
}
BENCHMARK(simulated_seconds_with_a_waveform)->Apply(bench::standard)->Unit(benchmark::kMillisecond);

/// 16 buses that share nothing, 126 devices each: together (0 threads), or apart in slices on so many threads.
void sixteen_buses_apart(benchmark::State& state) {
  constexpr unsigned buses = 16;
  const auto threads = static_cast<std::size_t>(state.range(0));
  const plant::PlantReading reading =
      plant::read_plant(plant_text(126, buses, "50ms", Racks::one_per_bus), "bench.toml");
  Nobody nobody;
  auto plant = plant::Plant::build(reading.plant, nobody);
  if (!reading.errors.empty() || !plant) return state.SkipWithError("the plant cannot be built");
  (*plant)->power_on();
  can::Timeline& timeline = (*plant)->timeline();
  if (timeline.partition_count() != buses) return state.SkipWithError("the buses are not apart");
  std::optional<serve::PlantSlices> slices;
  if (threads > 0) slices.emplace(**plant, serve::PlantSlices::Use{.threads = threads});
  const auto run_until = [&](can::Time end) {
    if (slices) return slices->run_until(end);
    timeline.run_until(end);
  };
  run_until(can::Time{} + std::chrono::seconds(10));
  for (const plant::NodeStatus& node : (*plant)->nodes()) {
    if (node.state != canopen::NmtState::operational) return state.SkipWithError("a node is not operational");
  }
  const auto all_frames = [&] {
    std::uint64_t sum = 0;
    for (unsigned bus = 0; bus < buses; ++bus) sum += (*plant)->bus(bus).load(timeline.now()).frames;
    return sum;
  };
  const std::uint64_t frames_before = all_frames();
  // As long as the longest slice: a run of any length has such ones.
  for (auto _ : state) run_until(timeline.now() + serve::PlantSlices::Use{}.most);
  bench::report(state, all_frames() - frames_before);
}
BENCHMARK(sixteen_buses_apart)
    ->Apply(bench::standard)
    ->ArgName("threads")
    ->Arg(0)
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// From the text of the plant file and the files of the devices to the first frame on the bus.
void twenty_devices_start(benchmark::State& state) {
  for (auto _ : state) {
    const plant::PlantReading reading = plant::read_plant(plant_text(), "bench.toml");
    Nobody nobody;
    auto plant = plant::Plant::build(reading.plant, nobody);
    if (!plant) return state.SkipWithError("the plant cannot be built");
    (*plant)->power_on();
    can::Timeline& timeline = (*plant)->timeline();
    while ((*plant)->bus(0).load(timeline.now()).frames == 0) timeline.run_until(timeline.next());
  }
  bench::report(state, static_cast<std::uint64_t>(state.iterations()));
}
BENCHMARK(twenty_devices_start)->Apply(bench::standard)->Unit(benchmark::kMillisecond);

/// Heap bytes of one more simulated device of a kind that is there already.
void bytes_per_device(benchmark::State& state) {
  std::ifstream stream(std::string(CANOPUS_SOURCE_DIR "/examples/devices/") + kinds[state.range(0)] + ".eds");
  std::ostringstream text;
  text << stream.rdbuf();
  const eds::ReadResult result = eds::read_device_file(text.str());
  if (!result.file) return state.SkipWithError("the device file cannot be read");
  struct Nowhere final : can::Sink {
    bool send(const can::Frame&) override { return true; }
  } nowhere;
  constexpr std::size_t count = 100;
  std::size_t bytes = 0;
  for (auto _ : state) {
    std::vector<std::unique_ptr<sim::Device>> devices;
    devices.reserve(count);
    const std::size_t before = mallinfo2().uordblks;
    for (std::size_t i = 0; i < count; ++i) {
      devices.push_back(
          std::make_unique<sim::Device>(result.file, static_cast<std::uint8_t>(i + 1), nowhere));
      devices.back()->power_on(can::Time{});
    }
    bytes = (mallinfo2().uordblks - before) / count;
  }
  state.SetLabel(kinds[state.range(0)]);
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(bytes_per_device)->DenseRange(0, 2)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
