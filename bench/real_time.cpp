// Plants in real time: 126 devices under an ME3CAN1-Q on each of 1 and 16 buses, 68 % of 1 Mbit/s, as a user runs them,
// lines printed into a pipe that is read. Processor time of the process once all have booted, and how late it was at
// most, the boot included. A process of class SCHED_FIFO where that is allowed: others leave lateness alone.

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "canopus/cli/app/command_line.hpp"

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr unsigned devices = 126;
constexpr const char* kinds[] = {"io-block", "encoder", "drive"};
constexpr const char* moving[] = {"6000:01", "6004:00", "606C:00"};
constexpr auto booted = 3s;
constexpr auto end = 6s;

std::string plant_text(unsigned buses) {
  std::string text;
  std::string modules = "[[plc]]\nname = \"plc\"\nlisten = \"off\"\n";
  for (unsigned bus = 0; bus < buses; ++bus) {
    const std::string name = "\"line" + std::to_string(bus + 1) + "\"\n";
    text += "[[bus]]\nname = " + name + "bit_rate = 1_000_000\n";
    for (unsigned i = 0; i < devices; ++i) {
      text += "[[device]]\nbus = " + name + "node = " + std::to_string(i + 2) +
              "\neds = \"" CANOPUS_SOURCE_DIR "/examples/devices/" + kinds[i % 3] +
              ".eds\"\nobjects = { \"1017:00\" = 100 }\n[[device.behaviour]]\nobject = \"" + moving[i % 3] +
              "\"\nkind = \"counter\"\nhigh = 100\nperiod = \"20ms\"\n";
    }
    modules += "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nbus = " + name + "head = " + std::to_string(32 * bus) +
               "\nnode = 1\nmaster = true\nexchange = \"10ms\"\nslaves = \"all\"\n";
  }
  return text + modules;
}

/// `canopus run PLANT --for 6s`, printing into a pipe.
class Child {
 public:
  explicit Child(const std::string& plant_file) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) std::abort();
    process_ = ::fork();
    if (process_ == 0) {
      const sched_param parameters{.sched_priority = 20};
      (void)::sched_setscheduler(0, SCHED_FIFO, &parameters);
      ::dup2(ends[1], STDOUT_FILENO);
      ::dup2(::open("/dev/null", O_WRONLY | O_CLOEXEC), STDERR_FILENO);
      std::_Exit(canopus::cli::run_command_line(std::vector<std::string>{"run", plant_file, "--for", "6s"}));
    }
    ::close(ends[1]);
    reader_ = std::thread([this, from = ends[0]] {
      std::array<char, 65536> piece{};
      for (ssize_t size = 0; (size = ::read(from, piece.data(), piece.size())) > 0;) {
        text_.append(piece.data(), static_cast<std::size_t>(size));
      }
      ::close(from);
    });
  }
  ~Child() { (void)wait(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  [[nodiscard]] double processor_seconds() const {
    clockid_t clock{};
    timespec time{};
    if (::clock_getcpuclockid(process_, &clock) != 0) return 0;
    ::clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
  }
  /// Its exit code.
  int wait() {
    if (!reader_.joinable()) return code_;
    reader_.join();
    ::waitpid(process_, &code_, 0);
    return code_;
  }
  /// After wait(): "at most 1.4 ms late" in seconds.
  [[nodiscard]] std::optional<double> lateness() const {
    const std::string before = ", at most ";
    const std::size_t place = text_.rfind(before);
    if (place == std::string::npos) return std::nullopt;
    char* unit = nullptr;
    const double number = std::strtod(text_.c_str() + place + before.size(), &unit);
    return number * (unit[1] == 'u' ? 1e-6 : unit[1] == 'm' ? 1e-3 : 1);
  }
  [[nodiscard]] bool is_operational(unsigned nodes) const {
    return text_.ends_with("all " + std::to_string(nodes) + " nodes operational\n");
  }

 private:
  pid_t process_ = 0;
  std::thread reader_;
  std::string text_;
  int code_ = -1;
};

void real_time(benchmark::State& state) {
  const auto buses = static_cast<unsigned>(state.range(0));
  char path[] = "/tmp/canopus-bench-XXXXXX";
  const int file = ::mkstemp(path);
  if (file < 0) return state.SkipWithError("no file for the plant");
  ::close(file);
  std::ofstream(path) << plant_text(buses);
  for (auto _ : state) {
    const auto started = Clock::now();
    Child child(path);
    std::this_thread::sleep_until(started + booted);
    const auto first = Clock::now();
    const double before = child.processor_seconds();
    std::this_thread::sleep_until(started + end - 100ms);
    const double share =
        (child.processor_seconds() - before) / std::chrono::duration<double>(Clock::now() - first).count();
    const bool good = child.wait() == 0 && child.is_operational(buses * (devices + 1));
    const auto lateness = child.lateness();
    if (!good || !lateness) {
      state.SkipWithError("canopus run failed");
      break;
    }
    state.counters["share"] = share;
    state.counters["lateness"] = *lateness;
  }
  ::unlink(path);
}
// Some seconds each: three runs, however many of the others there are.
BENCHMARK(real_time)->ArgName("buses")->Arg(1)->Arg(16)->Iterations(1)->Repetitions(3);

}  // namespace

BENCHMARK_MAIN();
