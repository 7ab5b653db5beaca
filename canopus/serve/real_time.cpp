#include "canopus/serve/real_time.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <ctime>
#include <utility>

#include <fmt/format.h>

#include "canopus/can/timeline.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::serve {

using namespace std::chrono_literals;

namespace {

static_assert(std::atomic<bool>::is_always_lock_free);
std::atomic<bool> was_continued{false};  // the process was stopped (Ctrl-Z, SIGSTOP) and goes on

/// The time that the machine has slept since boot.
can::Duration time_asleep() {
  timespec with_sleep{};
  timespec without_sleep{};
  // In this order: a pause between the two makes the difference smaller, never larger than it is.
  if (::clock_gettime(CLOCK_BOOTTIME, &with_sleep) != 0) return {};
  ::clock_gettime(CLOCK_MONOTONIC, &without_sleep);
  return std::chrono::seconds(with_sleep.tv_sec - without_sleep.tv_sec) +
         std::chrono::nanoseconds(with_sleep.tv_nsec - without_sleep.tv_nsec);
}

}  // namespace

RealTime::RealTime(boost::asio::io_context& io, plant::Plant& plant, plant::PlantObserver& observer,
                   can::Time end)
    : timeline_(plant.timeline()), observer_(observer), timer_(io), io_(io), end_(end) {}

RealTime::~RealTime() { std::signal(SIGCONT, SIG_DFL); }

void RealTime::start() {
  struct sigaction action {};
  action.sa_handler = [](int) { was_continued = true; };
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGCONT, &action, nullptr);
  was_continued = false;
  started_ = WallClock::now();
  asleep_before_ = time_asleep();
  arm();
}

void RealTime::set_speed(double speed, can::Duration duration) {
  advance();
  const can::Time until =
      duration == can::Duration::max() ? can::never : can::later(timeline_.now(), duration);
  pace_.set_speed(speed, timeline_.now(), read_clocks().elapsed, until);
  arm();
}

can::Time RealTime::now() {
  advance();
  return timeline_.now();
}

void RealTime::touched() {
  pace_.attend(timeline_.now());
  if (std::min(timeline_.next(), end_) < armed_for_) arm();
}

// Each access runs what is due, so the timer need not be exact between consecutive accesses.
void RealTime::accessed() {
  if (timeline_.next() != next_) touched();
}

// Each clock costs as much as the rest of an access: a sleep of the machine is checked once a second, because
// CLOCK_MONOTONIC stops in a sleep anyway.
Pace::Reading RealTime::read_clocks() {
  Pace::Reading reading;
  reading.elapsed = std::chrono::duration_cast<can::Duration>(WallClock::now() - started_);
  if (reading.elapsed >= check_for_sleep_) {
    asleep_ = time_asleep() - asleep_before_;
    check_for_sleep_ = reading.elapsed + 1s;
  }
  reading.asleep = asleep_;
  if (was_continued.load(std::memory_order_relaxed)) {
    reading.continued = was_continued.exchange(false);
    continuations_ += reading.continued ? 1 : 0;
    // The process may have been stopped after the clock was read.
    reading.elapsed = std::chrono::duration_cast<can::Duration>(WallClock::now() - started_);
  }
  return reading;
}

void RealTime::arm() {
  armed_for_ = std::min(pace_.wake_for(timeline_.next(), timeline_.now()), end_);
  const can::Duration elapsed = pace_.elapsed_to_wake(armed_for_, timeline_.now());
  timer_.expires_at(elapsed == can::Duration::max() ? WallClock::time_point::max() : started_ + elapsed);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) wake();
  });
}

void RealTime::wake() {
  advance();
  if (timeline_.now() >= end_) return io_.stop();
  arm();
}

/// Runs what is due.
void RealTime::advance() {
  const Pace::Reading reading = read_clocks();
  next_ = timeline_.next();
  // Deadlines delayed by wake_together() are not late.
  const can::Time due = std::min(std::max(next_, armed_for_), end_);
  const Pace::Step step = pace_.step(reading, timeline_.now(), due);
  lag_ = step.lag;
  largest_lag_ = std::max(largest_lag_, lag_);
  if (step.lag != can::Duration{} || step.suspended != can::Duration{}) report(step, reading.elapsed);
  const can::Time until = std::min(step.run_until, end_);
  timeline_.run_until(until);
  if (next_ <= until) next_ = timeline_.next();
}

void RealTime::report(const Pace::Step& step, can::Duration elapsed) {
  constexpr can::Duration worth_reporting = 50ms;
  const auto report_failure = [this](std::string message) {
    observer_.on({timeline_.now(), plant::Failure{"real time", std::move(message)}});
  };
  if (step.suspended >= worth_reporting) {
    report_failure(fmt::format("the process was suspended for {}: plant time stood still",
                               text::describe_duration(step.suspended)));
    if (resumed_) resumed_();
  }
  if (step.lag >= worth_reporting && elapsed >= report_again_) {
    report_failure(fmt::format("the plant is {} late: this machine is too slow for it",
                               text::describe_duration(step.lag)));
    report_again_ = elapsed + 1s;
  }
}

}  // namespace canopus::serve
