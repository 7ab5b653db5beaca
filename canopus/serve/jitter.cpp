#include "canopus/serve/jitter.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <ctime>
#include <memory>
#include <random>
#include <span>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>

#include "canopus/link/linked_bus.hpp"
#include "canopus/link/socket_pair.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/serve/real_time.hpp"

namespace canopus::serve {
namespace {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;
using std::chrono::nanoseconds;
using namespace std::chrono_literals;

constexpr std::uint32_t sync = 0x80;
constexpr std::uint32_t response = 0x581;
/// Longest time of a plant until its first SYNC, and of another bus until it carries frames.
constexpr can::Duration start_up = 2s;

/// As cyclictest does: sleeps until a moment and reads the clock.
Histogram sleep_jitter(const JitterOptions& options, std::vector<std::string>& refused) {
  Histogram histogram;
  std::thread thread([&] {
    if (options.real_time) refused = request_real_time(*options.real_time);
    timespec next{};
    ::clock_gettime(CLOCK_MONOTONIC, &next);
    const auto until = Clock::now() + options.length;
    while (Clock::now() < until) {
      const std::int64_t nanosecond = next.tv_nsec + options.period.count();
      next.tv_sec += nanosecond / 1'000'000'000;
      next.tv_nsec = nanosecond % 1'000'000'000;
      while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, nullptr) == EINTR) {
      }
      timespec now{};
      ::clock_gettime(CLOCK_MONOTONIC, &now);
      histogram.add(std::chrono::seconds(now.tv_sec - next.tv_sec) + nanoseconds(now.tv_nsec - next.tv_nsec));
    }
  });
  thread.join();
  return histogram;
}

/// The other program: records the times of SYNC, and reads an object periodically.
class Watcher final : private link::BusClientListener {
 public:
  Watcher(asio::io_context& io, link::BusClient& bus, nanoseconds period)
      : bus_(bus), period_(period), timer_(io) {
    bus_.set_user(this);
    schedule_request();
  }
  ~Watcher() { bus_.set_user(nullptr); }
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

  std::vector<nanoseconds> syncs;
  Histogram responses;
  std::string lost;

 private:
  void frame_received(const can::Frame& frame) override { frame_received_at(frame, std::nullopt); }
  void frame_received_at(const can::Frame& frame, std::optional<nanoseconds> received_at) override {
    const Clock::time_point now = Clock::now();
    if (frame.identifier == sync) {
      // A kernel that dates some frames dates all of them.
      syncs.push_back(received_at.value_or(now.time_since_epoch()));
    } else if (frame.identifier == response && asked_at_) {
      responses.add(now - *asked_at_);
      asked_at_.reset();
      schedule_request();
    }
  }
  void bus_lost(const std::string& reason) override { lost = reason; }

  /// At moments that have nothing to do with those of SYNC.
  void schedule_request() {
    std::uniform_int_distribution<std::int64_t> part(period_.count() / 2, 2 * period_.count());
    timer_.expires_after(nanoseconds(part(random_)));
    timer_.async_wait([this](const boost::system::error_code& failure) {
      if (failure) return;
      // One without an answer within a second counts for nothing: the plant is not up yet, or the bus is full.
      if (asked_at_ && Clock::now() - *asked_at_ < 1s) return schedule_request();
      asked_at_ = Clock::now();
      if (!bus_.send(can::data_frame(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}))) asked_at_.reset();
      schedule_request();
    });
  }

  link::BusClient& bus_;
  nanoseconds period_;
  asio::steady_timer timer_;
  std::minstd_rand random_{1};
  std::optional<Clock::time_point> asked_at_;
};

/// Gives a plant the end that is open already.
class OpenEnd final : public plant::BusOpener {
 public:
  explicit OpenEnd(std::unique_ptr<link::BusClient> client) : client_(std::move(client)) {}
  std::expected<std::unique_ptr<can::Bus>, std::string> open(const plant::BusSection& section,
                                                             can::Timeline& timeline) override {
    auto made =
        std::make_unique<link::LinkedBus>(section.name, section.bit_rate, timeline, std::move(client_));
    bus = made.get();
    return made;
  }
  link::LinkedBus* bus = nullptr;

 private:
  std::unique_ptr<link::BusClient> client_;
};

struct Ends {
  std::unique_ptr<link::BusClient> near;
  std::unique_ptr<link::BusClient> far;
};

std::expected<Ends, std::string> open_ends(asio::io_context& near_io, asio::io_context& far_io,
                                           const JitterOptions& options) {
  if (!options.bus) {
    auto pair = link::open_socket_pair(near_io, far_io);
    if (!pair) return std::unexpected(pair.error());
    return Ends{std::move(pair->first), std::move(pair->second)};
  }
  auto near = link::open_bus(near_io, *options.bus, {.bit_rate = options.bit_rate});
  if (!near) return std::unexpected(near.error());
  auto far = link::open_bus(far_io, *options.bus, {});
  if (!far) return std::unexpected(far.error());
  return Ends{std::move(*near), std::move(*far)};
}

/// An active NMT master, which alone produces SYNC; it has no slaves.
plant::PlantFile plant_of(const JitterOptions& options) {
  auto reading = plant::read_plant(
      fmt::format("[[bus]]\nname = \"bench\"\nbit_rate = {}\n[[plc]]\nlisten = \"off\"\n[[plc.module]]\n"
                  "model = \"ME3CAN1-Q\"\nnode = 1\nmaster = true\nrestart_time = \"0ms\"\n"
                  "objects = {{ \"1005:00\" = 0x4000_0080, \"1006:00\" = {} }}\n",
                  options.bit_rate,
                  std::chrono::duration_cast<std::chrono::microseconds>(options.period).count()),
      "bench");
  reading.plant.buses.front().address = link::BusAddress{};  // not simulated: OpenEnd has it
  return std::move(reading.plant);
}

}  // namespace

std::expected<JitterResult, std::string> measure_jitter(const JitterOptions& options) {
  JitterResult result;
  result.sleep = sleep_jitter(options, result.refused).relative();

  asio::io_context near_io{1};
  asio::io_context far_io{1};
  auto ends = open_ends(near_io, far_io, options);
  if (!ends) return std::unexpected(ends.error());
  OpenEnd opener(std::move(ends->near));
  struct Nobody final : plant::PlantObserver {
  } no_observer;
  auto plant = plant::Plant::build(plant_of(options), no_observer, std::nullopt, &opener);
  if (!plant) return std::unexpected(plant.error().front().message);

  Watcher watcher(far_io, *ends->far, options.period);
  auto work = asio::make_work_guard(far_io);
  std::thread other([&] {
    // The measuring thread must have no delay itself; but it must not run on the plant's processor.
    if (options.real_time) (void)request_real_time({.priority = options.real_time->priority});
    far_io.run();
  });
  std::thread of_plant([&] {
    if (options.real_time) (void)request_real_time(*options.real_time);
    RealTime clock(near_io, **plant, no_observer, can::Time{} + start_up + options.length);
    opener.bus->start(&clock, {});
    (*plant)->power_on();
    clock.start();
    near_io.run();
  });
  of_plant.join();
  asio::post(far_io, [&] { far_io.stop(); });
  other.join();
  (void)opener.bus->close(100ms);
  if (!watcher.lost.empty()) return std::unexpected(watcher.lost);
  if (watcher.syncs.empty()) return std::unexpected("no SYNC came: nothing is carried on this bus");
  // The start-up is not what is measured.
  const auto wanted = static_cast<std::size_t>(options.length / options.period);
  const std::span<const nanoseconds> syncs = watcher.syncs;
  result.sync = lateness(syncs.last(std::min(wanted, syncs.size())), options.period);
  result.response = watcher.responses;
  return result;
}

}  // namespace canopus::serve
