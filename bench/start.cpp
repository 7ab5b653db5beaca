// Start and memory of whole plants: 126 devices of one EDS, of 126 EDS files, and 16 buses of 126 devices of one EDS,
// a PLC with an ME3CAN1-Q on each bus. Once in this process, to be counted by callgrind, and once as a user starts it.

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canopus/can/timeline.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/app/command_line.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"

#include "measure.hpp"

namespace {

using namespace canopus;

constexpr unsigned devices = 126;
constexpr const char* kinds[] = {"io-block", "encoder", "drive"};
constexpr const char* moving[] = {"6000:01", "6004:00", "606C:00"};

enum class Files : std::uint8_t { one, many };

/// A folder of its own with the plant file and its device files.
class Folder {
 public:
  Folder(unsigned buses, Files files) {
    char path[] = "/tmp/canopus-bench-XXXXXX";
    if (::mkdtemp(path) == nullptr) std::abort();
    path_ = path;
    const unsigned count = files == Files::one ? 1 : devices;
    for (unsigned i = 0; i < count; ++i) {
      std::ifstream original(std::string(CANOPUS_SOURCE_DIR "/examples/devices/") + kinds[i % 3] + ".eds");
      std::ostringstream text;
      text << original.rdbuf();
      std::string eds = text.str();
      const std::string key = "ProductName=";
      eds.insert(eds.find(key) + key.size(), std::to_string(i) + " ");
      std::ofstream(path_ / ("device" + std::to_string(i) + ".eds")) << eds;
    }
    std::string modules;
    for (unsigned bus = 1; bus <= buses; ++bus) {
      const std::string name = "\"line" + std::to_string(bus) + "\"\n";
      text_ += "[[bus]]\nname = " + name + "bit_rate = 1_000_000\n";
      for (unsigned i = 0; i < devices; ++i) {
        text_ += "[[device]]\nbus = " + name + "node = " + std::to_string(i + 2) + "\neds = \"device" +
                 std::to_string(i % count) +
                 ".eds\"\nobjects = { \"1017:00\" = 100 }\n[[device.behaviour]]\nobject = \"" +
                 moving[i % count % 3] + "\"\nkind = \"counter\"\nhigh = 100\nperiod = \"50ms\"\n";
      }
      modules += "[[plc]]\nname = \"plc" + std::to_string(bus) +
                 "\"\nlisten = \"off\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nbus = " + name +
                 "head = 0\nnode = 1\nmaster = true\nexchange = \"10ms\"\nslaves = \"all\"\n";
    }
    text_ += modules;
    std::ofstream(plant_file()) << text_;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  [[nodiscard]] std::string plant_file() const { return (path_ / "plant.toml").string(); }

 private:
  std::filesystem::path path_;
  std::string text_;
};

void plants(benchmark::internal::Benchmark* bench) {
  bench::standard(bench);
  bench->ArgNames({"buses", "files"})->Unit(benchmark::kMillisecond);
  bench->Args({1, 1})->Args({1, devices})->Args({16, 1});
}

Folder folder_of(const benchmark::State& state) {
  return {static_cast<unsigned>(state.range(0)), state.range(1) == 1 ? Files::one : Files::many};
}

struct Nobody final : plant::PlantObserver {};

std::unique_ptr<plant::Plant> started(const Folder& folder, Nobody& nobody) {
  plant::PlantReading reading = plant::read_plant(folder.text(), folder.plant_file());
  auto plant = plant::Plant::build(std::move(reading.plant), nobody);
  if (!reading.errors.empty() || !plant) return nullptr;
  (*plant)->power_on();
  return std::move(*plant);
}

/// From the text of the plant file and the files of the devices to all of it switched on.
void start(benchmark::State& state) {
  const Folder folder = folder_of(state);
  Nobody nobody;
  for (auto _ : state) {
    auto plant = started(folder, nobody);
    if (plant == nullptr) return state.SkipWithError("the plant cannot be built");
    state.PauseTiming();
    plant.reset();
    state.ResumeTiming();
  }
  bench::report(state, static_cast<std::uint64_t>(state.iterations()));
}
BENCHMARK(start)->Apply(plants);

std::size_t heap() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// Heap of a plant of which all nodes are operational.
void heap_of_plant(benchmark::State& state) {
  const Folder folder = folder_of(state);
  std::size_t bytes = 0;
  for (auto _ : state) {
    Nobody nobody;
    const std::size_t before = heap();
    auto plant = started(folder, nobody);
    if (plant == nullptr) return state.SkipWithError("the plant cannot be built");
    plant->timeline().run_until(can::Time{} + std::chrono::seconds(10));
    bytes = heap() - before;
    for (const plant::NodeStatus& node : plant->nodes()) {
      if (node.state != canopen::NmtState::operational)
        return state.SkipWithError("a node is not operational");
    }
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(heap_of_plant)->Apply(plants)->Iterations(1);

struct Usage {
  double seconds = 0;  ///< of a processor
  long kilobytes = 0;  ///< that were in memory at most, more than when main() began
  int exit_code = -1;
};

/// The most that this process had in memory; getrusage() would count what there was before exec.
long most_kilobytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stol(line.substr(6));
  }
  return 0;
}

double processor_seconds() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// The child of run_in_child(), from main() on.
int child(const std::string& plant_file, int answer) {
  Usage usage{.seconds = -processor_seconds(), .kilobytes = -most_kilobytes()};
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ::dup2(nowhere, STDOUT_FILENO);
  const std::vector<std::string> words{"run", plant_file, "--virtual", "--for", "0s", "--quiet"};
  usage.exit_code = cli::run_command_line(words);
  usage.seconds += processor_seconds();
  usage.kilobytes += most_kilobytes();
  return ::write(answer, &usage, sizeof usage) == sizeof usage ? 0 : 1;
}

constexpr const char* child_option = "--child";

/// `canopus run PLANT --virtual --for 0s --quiet` from main() on to its end, in a process of its own: reading,
/// building, switching on and removing. Loading and linking of the program are not in it.
Usage run_in_child(const std::string& plant_file) {
  int ends[2];
  if (::pipe(ends) != 0) std::abort();
  const std::string answer = std::to_string(ends[1]);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/proc/self/exe", "bench_start", child_option, plant_file.c_str(), answer.c_str(), nullptr);
    std::_Exit(1);
  }
  Usage usage;
  ::close(ends[1]);
  if (::read(ends[0], &usage, sizeof usage) != sizeof usage) usage.exit_code = -1;
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return usage;
}

void process(benchmark::State& state) {
  const Folder folder = folder_of(state);
  Usage usage;
  for (auto _ : state) {
    usage = run_in_child(folder.plant_file());
    if (usage.exit_code != 0) return state.SkipWithError("canopus run failed");
    state.SetIterationTime(usage.seconds);
  }
  bench::report(state, static_cast<std::uint64_t>(state.iterations()));
  state.counters["bytes"] = static_cast<double>(usage.kilobytes) * 1024;
}
BENCHMARK(process)->Apply(plants)->UseManualTime();

}  // namespace

int main(int count, char** words) {
  if (count == 4 && std::string(words[1]) == child_option) return child(words[2], std::stoi(words[3]));
  benchmark::Initialize(&count, words);
  if (benchmark::ReportUnrecognizedArguments(count, words)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
