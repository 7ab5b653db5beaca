#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/can/timeline.hpp"
#include "canopus/link/loop_clock.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/serve/pace.hpp"

namespace canopus::serve {

/// Keeps a plant in step with the machine's clock. One at a time in a process: it watches SIGCONT.
class RealTime final : public link::LoopClock {
 public:
  /// `io` is stopped when the plant's time reaches `end`; `observer` gets reports of lag and of suspensions
  /// of the process.
  RealTime(boost::asio::io_context& io, plant::Plant& plant, plant::PlantObserver& observer, can::Time end);
  ~RealTime();
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  void start();
  /// Called after each suspension: plant time stood still, so what shows the time of day is behind.
  void set_resumed_handler(std::function<void()> handler) { resumed_ = std::move(handler); }
  /// For a plant without external receivers of its frames: Pace::wake_together(). Call it before start().
  void wake_together(can::Duration longest) noexcept { pace_.wake_together(longest); }
  /// Plant time runs at this multiple of the clock from now on (0: stopped), for this long, and then stops.
  /// Not for a plant with a bus outside. After start(), not inside of the timeline.
  void set_speed(double speed, can::Duration duration = can::Duration::max());
  /// 0: stopped.
  [[nodiscard]] double speed() const noexcept { return timeline_.now() < pace_.until() ? pace_.speed() : 0; }
  can::Time now() override;
  void touched() override;
  /// Nothing to do, unless the access has changed the plant's next deadline.
  void accessed() override;
  [[nodiscard]] can::Duration largest_lag() const noexcept { return largest_lag_; }
  [[nodiscard]] can::Duration lag() const noexcept { return lag_; }
  /// The number of times that the process was stopped and continued.
  [[nodiscard]] std::uint64_t continuations() const noexcept { return continuations_; }

 private:
  using WallClock = std::chrono::steady_clock;

  [[nodiscard]] Pace::Reading read_clocks();
  void arm();
  void wake();
  void advance();
  void report(const Pace::Step& step, can::Duration elapsed);

  can::Timeline& timeline_;
  plant::PlantObserver& observer_;
  boost::asio::steady_timer timer_;
  boost::asio::io_context& io_;
  can::Time end_;
  Pace pace_;
  std::function<void()> resumed_;
  WallClock::time_point started_{};
  can::Duration asleep_before_{};
  can::Duration asleep_{};           // since the start, as read last
  can::Duration check_for_sleep_{};  // elapsed time from which on it is read again
  can::Time armed_for_ = can::never;
  can::Time next_{};  // deadline of the plant when the present was asked for last
  can::Duration lag_{};
  can::Duration largest_lag_{};
  std::uint64_t continuations_ = 0;
  can::Duration report_again_{};  // elapsed time from which on lag is reported again
};

}  // namespace canopus::serve
