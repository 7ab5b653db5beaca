#include "canopus/app/real_time.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/app/text_values.hpp"

namespace canopus::app {

using namespace std::chrono_literals;

RealTime::RealTime(boost::asio::io_context& io, Plant& plant, PlantObserver& observer, can::Time end)
    : timeline_(plant.timeline()), observer_(observer), timer_(io), io_(io), end_(end) {}

void RealTime::start() {
  started_ = WallClock::now();
  arm();
}

can::Time RealTime::now() {
  advance(clock());
  return timeline_.now();
}

void RealTime::touched() {
  if (std::min(timeline_.next(), end_) < armed_for_) arm();
}

can::Time RealTime::clock() const {
  return can::Time{} + std::chrono::duration_cast<can::Duration>(WallClock::now() - started_);
}

void RealTime::arm() {
  armed_for_ = std::min(timeline_.next(), end_);
  timer_.expires_at(armed_for_ == can::never ? WallClock::time_point::max()
                                             : started_ + armed_for_.time_since_epoch());
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) wake();
  });
}

void RealTime::wake() {
  advance(clock());
  if (timeline_.now() >= end_) return io_.stop();
  arm();
}

/// Runs what is due. A plant that is behind catches up in slices, so that clients and Ctrl-C are heard.
void RealTime::advance(can::Time wall) {
  const can::Time due = std::min(timeline_.next(), end_);
  lag_ = std::max(can::Duration{}, wall - std::min(due, wall));
  largest_lag_ = std::max(largest_lag_, lag_);
  constexpr can::Duration worth_telling = 50ms;
  if (lag_ >= worth_telling && wall >= tell_again_) {
    observer_.error("real time",
                    fmt::format("the plant is {} late: this machine is too slow for it", describe(lag_)),
                    timeline_.now());
    tell_again_ = wall + 1s;
  }
  constexpr can::Duration slice = 20ms;
  timeline_.run_until(
      std::min({wall, end_, can::later(std::max(timeline_.now(), std::min(due, wall)), slice)}));
}

}  // namespace canopus::app
