// The ME3CAN1-Q's data exchange at its largest: 1024 words each way over 256 RPDOs and 256 TPDOs, all valid,
// all values new each time.

#include <chrono>
#include <cstdint>
#include <ctime>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <benchmark/benchmark.h>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"

#include "measure.hpp"

namespace {

using namespace canopus;

struct FreeBus final : can::Controller {
  bool send(const can::Frame& frame) override {
    ++frames;
    last = frame;
    return true;
  }
  [[nodiscard]] std::uint16_t transmit_error_counter() const override { return 0; }
  [[nodiscard]] std::uint16_t receive_error_counter() const override { return 0; }
  [[nodiscard]] can::ErrorState error_state() const override { return can::ErrorState::error_active; }
  [[nodiscard]] std::uint32_t bit_rate() const override { return 1'000'000; }
  void restart(std::uint32_t) override {}
  [[nodiscard]] std::uint32_t transmit_overflows() const override { return 0; }
  std::uint64_t frames = 0;
  can::Frame last;
};

struct NoMemory final : module::NonVolatileMemory {
  [[nodiscard]] Content read(std::string_view) override { return {}; }
  bool write(std::string_view, std::span<const std::uint8_t>) override { return true; }
  bool erase(std::string_view) override { return true; }
};

class Exchange {
 public:
  explicit Exchange(std::uint16_t pdos) : pdos_(pdos) {
    const auto preset = [&](unsigned index, std::uint8_t sub, std::uint64_t value, unsigned length) {
      good_ =
          good_ && module_.preset_object(static_cast<std::uint16_t>(index), sub,
                                         canopen::little_endian(value, length)) == canopen::AbortCode::none;
    };
    for (std::uint16_t pdo = 0; pdo < 256; ++pdo) {
      const std::uint32_t invalid = pdo < pdos ? 0 : canopen_invalid;
      preset(0x1400U + pdo, 1, invalid | (first_rpdo + pdo), 4);
      preset(0x1800U + pdo, 1, invalid | 0x4000'0000 | (first_tpdo + pdo), 4);
    }
    module_.power_on(now_);
    run_for(std::chrono::seconds(3));
    module_.receive(can::data_frame(0x000, {0x01, 0x00}), now_);
    good_ = good_ && module_.node().state() == canopen::NmtState::operational;
  }
  [[nodiscard]] bool is_good() const { return good_; }

  /// The program writes its words, one by one.
  void write_words() {
    ++turn_;
    for (std::uint16_t word = 0; word < 4 * pdos_; ++word) {
      module_.write_word(transmit_first + word, static_cast<std::uint16_t>(turn_ * 31 + word), now_);
    }
  }
  /// A new frame for each RPDO.
  void receive_rpdos() {
    can::Frame frame = can::data_frame(first_rpdo, {0, 0, 0, 0, 0, 0, 0, 0});
    for (std::uint16_t pdo = 0; pdo < pdos_; ++pdo) {
      frame.identifier = first_rpdo + pdo;
      frame.data[0] = static_cast<std::uint8_t>(turn_);
      frame.data[6] = static_cast<std::uint8_t>(turn_ + pdo);
      module_.receive(frame, now_);
    }
  }
  /// Y01 on, until X01 is on; the TPDOs go out.
  void exchange() {
    module_.set_output(1, true, now_);
    while ((module_.inputs() & 2U) == 0) {
      now_ = module_.deadline();
      module_.tick(now_);
    }
  }
  void end() { module_.set_output(1, false, now_); }
  [[nodiscard]] bool is_right() {
    const unsigned words = 4U * pdos_;
    const auto received = [&](unsigned word) {
      return module_.program_read(receive_first + word, now_) & 0xFFU;
    };
    const unsigned sent = bus_.last.data[0] | static_cast<unsigned>(bus_.last.data[1]) << 8;
    return received(0) == (turn_ & 0xFFU) && received(words - 1) == ((turn_ + pdos_ - 1U) & 0xFFU) &&
           sent == ((turn_ * 31 + words - 4) & 0xFFFFU);
  }
  [[nodiscard]] std::uint64_t frames() const { return bus_.frames; }

 private:
  static constexpr std::uint32_t canopen_invalid = 0x8000'0000;
  static constexpr std::uint32_t first_rpdo = 0x200;
  static constexpr std::uint32_t first_tpdo = 0x300;
  static constexpr module::BufferAddress receive_first = 10000;
  static constexpr module::BufferAddress transmit_first = 13000;

  void run_for(can::Duration duration) {
    const can::Time end = now_ + duration;
    while (module_.deadline() <= end) {
      now_ = module_.deadline();
      module_.tick(now_);
    }
    now_ = end;
  }

  std::uint16_t pdos_;
  bool good_ = true;
  unsigned turn_ = 0;
  can::Time now_{};
  FreeBus bus_;
  NoMemory memory_;
  module::me3can1_q::Me3can1Q module_{bus_, memory_};
};

/// The processor's time for this thread, in seconds: what others do to a shared machine is not in it.
double processor_time() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

enum class From : std::uint8_t { words, rpdos, exchange };

/// range(1) modules take turns.
void data_exchange(benchmark::State& state, From from) {
  std::vector<std::unique_ptr<Exchange>> modules;
  for (std::int64_t i = 0; i < state.range(1); ++i) {
    modules.push_back(std::make_unique<Exchange>(static_cast<std::uint16_t>(state.range(0))));
    if (!modules.back()->is_good()) return state.SkipWithError("the module is not operational");
  }
  const auto frames = [&] {
    std::uint64_t sum = 0;
    for (const auto& module : modules) sum += module->frames();
    return sum;
  };
  const std::uint64_t before = frames();
  for (auto _ : state) {
    double time = 0;
    for (const auto& exchange : modules) {
      double start = processor_time();
      exchange->write_words();
      if (from == From::rpdos) start = processor_time();
      exchange->receive_rpdos();
      if (from == From::exchange) start = processor_time();
      exchange->exchange();
      time += processor_time() - start;
      exchange->end();
    }
    state.SetIterationTime(time);
  }
  for (const auto& exchange : modules) {
    if (!exchange->is_right()) state.SkipWithError("values are missing");
  }
  const std::int64_t exchanges = state.iterations() * state.range(1);
  if (frames() - before != static_cast<std::uint64_t>(exchanges * state.range(0))) {
    state.SkipWithError("frames are missing");
  }
  bench::report(state, static_cast<std::uint64_t>(exchanges));
}
/// From Y01 to X01 and the last TPDO.
void exchange_alone(benchmark::State& state) { data_exchange(state, From::exchange); }
/// From the first RPDO on.
void exchange_with_rpdos(benchmark::State& state) { data_exchange(state, From::rpdos); }
/// From the first word that the program writes on.
void exchange_cycle(benchmark::State& state) { data_exchange(state, From::words); }
void sizes(benchmark::internal::Benchmark* bench) {
  bench::standard(bench);
  bench->UseManualTime()->ArgNames({"pdos", "modules"});
}
BENCHMARK(exchange_alone)->Apply(sizes)->Args({256, 1});
BENCHMARK(exchange_with_rpdos)
    ->Apply(sizes)
    ->Args({1, 1})
    ->Args({2, 1})
    ->Args({8, 1})
    ->Args({32, 1})
    ->Args({256, 1})
    ->Args({256, 4})
    ->Args({256, 16});
BENCHMARK(exchange_cycle)->Apply(sizes)->Args({256, 1});

}  // namespace

BENCHMARK_MAIN();
