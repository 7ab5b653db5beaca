#include "canopus/sim/drive/motion.hpp"

#include <algorithm>
#include <cmath>

namespace canopus::sim {

namespace {

constexpr double nanoseconds = 1e9;

double way_to_stop(double velocity, double deceleration) noexcept {
  return velocity * std::abs(velocity) / (2 * deceleration);
}

}  // namespace

void Motion::stand(double position) noexcept {
  count_ = 0;
  end_ = start_;
  first_ = last_ = {.position = position};
}

void Motion::begin(can::Time now) noexcept {
  first_ = at(now);
  first_.acceleration = 0;
  last_ = first_;
  start_ = now;
  count_ = 0;
}

/// Adds a segment to this velocity.
void Motion::add(double velocity, double acceleration) noexcept {
  const double change = velocity - last_.velocity;
  if (change == 0) return;
  const double seconds = std::abs(change) / acceleration;
  stretches_[count_++] = {.seconds = seconds, .acceleration = std::copysign(acceleration, change)};
  last_.position += (last_.velocity + velocity) / 2 * seconds;
  last_.velocity = velocity;
}

void Motion::extend(double seconds) noexcept {
  if (!(seconds > 0)) return;
  stretches_[count_++] = {.seconds = seconds, .acceleration = 0};
  last_.position += last_.velocity * seconds;
}

/// Sets the exact end position, without the sum of rounding errors.
void Motion::finish(double position) noexcept {
  last_.position = position;
  double seconds = 0;
  for (std::size_t i = 0; i < count_; ++i) seconds += stretches_[i].seconds;
  // More than a hundred years are for ever.
  end_ = seconds < 3e9 ? can::later(start_, can::Duration(std::llround(seconds * nanoseconds))) : can::never;
}

void Motion::move_to(double target, const MotionLimits& limits, can::Time now) noexcept {
  begin(now);
  const double stopped = last_.position + way_to_stop(last_.velocity, limits.deceleration);
  // Velocity against the way that would be left at rest: it has to turn round.
  if ((target - stopped) * last_.velocity < 0) add(0, limits.deceleration);
  const double direction = target >= last_.position ? 1 : -1;
  if (std::abs(last_.velocity) > limits.speed) add(direction * limits.speed, limits.deceleration);
  const double way = std::abs(target - last_.position);
  const double speed = std::abs(last_.velocity);
  const double sum = 1 / (2 * limits.acceleration) + 1 / (2 * limits.deceleration);
  const double highest = std::sqrt(std::max(0.0, (way + speed * speed / (2 * limits.acceleration)) / sum));
  const double peak = std::max(speed, std::min(limits.speed, highest));
  add(direction * peak, limits.acceleration);
  if (peak > 0) {
    const double left = std::abs(target - last_.position) - way_to_stop(peak, limits.deceleration);
    extend(left / peak);
  }
  add(0, limits.deceleration);
  finish(target);
}

void Motion::run_at(double velocity, const MotionLimits& limits, can::Time now) noexcept {
  begin(now);
  if (last_.velocity * velocity < 0 || std::abs(velocity) < std::abs(last_.velocity)) {
    const bool turns = last_.velocity * velocity < 0;
    add(turns ? 0 : velocity, limits.deceleration);
  }
  add(velocity, limits.acceleration);
  finish(last_.position);
}

void Motion::stop(double deceleration, can::Time now) noexcept {
  begin(now);
  add(0, deceleration);
  finish(last_.position);
}

Motion::State Motion::at(can::Time now) const noexcept {
  if (now >= end_) {
    State state = last_;
    state.position += state.velocity * std::chrono::duration<double>(now - end_).count();
    return state;
  }
  State state = first_;
  double left = std::chrono::duration<double>(std::max(now, start_) - start_).count();
  for (std::size_t i = 0; i < count_; ++i) {
    const double seconds = std::min(left, stretches_[i].seconds);
    const double acceleration = stretches_[i].acceleration;
    state.position += state.velocity * seconds + acceleration * seconds * seconds / 2;
    state.velocity += acceleration * seconds;
    state.acceleration = acceleration;
    if (left < stretches_[i].seconds) break;
    left -= seconds;
  }
  return state;
}

}  // namespace canopus::sim
