#include "canopus/sim/lift/motion.hpp"

#include <algorithm>
#include <cmath>

namespace canopus::sim::lift {

namespace {

double in_seconds(can::Duration span) { return std::chrono::duration<double>(span).count(); }

MotionState after(const MotionState& from, double jerk, double t) {
  return {from.position + t * (from.velocity + t * (from.acceleration / 2 + t * jerk / 6)),
          from.velocity + t * (from.acceleration + t * jerk / 2), from.acceleration + t * jerk};
}

}  // namespace

/// To another velocity: jerk, constant acceleration, jerk.
struct Motion::Ramp {
  std::array<double, 3> duration{};
  std::array<double, 3> jerk{};

  [[nodiscard]] double distance(double velocity, double acceleration) const {
    MotionState state{0, velocity, acceleration};
    for (std::size_t i = 0; i < duration.size(); ++i) state = after(state, jerk[i], duration[i]);
    return state.position;
  }
};

Motion::Ramp Motion::ramp(double velocity, double acceleration, double target, const MotionLimits& limits) {
  const double jerk = limits.jerk;
  // The remaining change of velocity after the acceleration has returned to 0.
  const double rest = target - velocity - acceleration * std::abs(acceleration) / (2 * jerk);
  const double sign = rest < 0 ? -1 : 1;
  const double from = sign * acceleration;
  const double change = sign * (target - velocity);
  const double most = std::max(limits.acceleration, std::abs(acceleration));
  double peak = std::sqrt(std::max(0.0, jerk * change + from * from / 2));
  double hold = 0;
  if (peak > most) {
    peak = most;
    hold = std::max(0.0, (change - (2 * peak * peak - from * from) / (2 * jerk)) / peak);
  }
  return {{std::max(0.0, (peak - from) / jerk), hold, peak / jerk}, {sign * jerk, 0, -sign * jerk}};
}

/// From `from` over the velocity `peak` to rest.
double Motion::distance(const MotionState& from, double peak, const MotionLimits& limits) {
  return ramp(from.velocity, from.acceleration, peak, limits).distance(from.velocity, from.acceleration) +
         ramp(peak, 0, 0, limits).distance(peak, 0);
}

void Motion::hold(const MotionState& state, can::Time now) {
  start_ = end_ = now;
  count_ = 0;
  last_ = state;
}

void Motion::add(double duration, double jerk) {
  if (duration <= 0) return;
  pieces_[count_++] = {duration, jerk, last_};
  last_ = after(last_, jerk, duration);
}

void Motion::add(const Ramp& ramp) {
  for (std::size_t i = 0; i < ramp.duration.size(); ++i) add(ramp.duration[i], ramp.jerk[i]);
}

void Motion::finish() {
  double seconds = 0;
  for (std::size_t i = 0; i < count_; ++i) seconds += pieces_[i].duration;
  end_ = start_ + std::chrono::ceil<can::Duration>(std::chrono::duration<double>(seconds));
}

void Motion::run_at(double velocity, const MotionLimits& limits, can::Time now) {
  const MotionState from = at(now);
  hold(from, now);
  add(ramp(from.velocity, from.acceleration, velocity, limits));
  last_.velocity = velocity;
  last_.acceleration = 0;
  finish();
}

void Motion::move_to(double target, const MotionLimits& limits, can::Time now) {
  const MotionState from = at(now);
  hold(from, now);
  const double way = target - from.position;
  double peak = 0;
  double cruise = 0;
  const double far_up = distance(from, limits.speed, limits);
  const double far_down = distance(from, -limits.speed, limits);
  if (way >= far_up) {
    peak = limits.speed;
    cruise = (way - far_up) / limits.speed;
  } else if (way <= far_down) {
    peak = -limits.speed;
    cruise = (far_down - way) / limits.speed;
  } else {
    double low = -limits.speed, high = limits.speed;
    constexpr int halvings = 80;  // a double has 53 bits
    for (int i = 0; i < halvings; ++i) {
      peak = (low + high) / 2;
      (distance(from, peak, limits) < way ? low : high) = peak;
    }
  }
  add(ramp(from.velocity, from.acceleration, peak, limits));
  add(cruise, 0);
  add(ramp(peak, 0, 0, limits));
  last_ = {target, 0, 0};
  finish();
}

MotionState Motion::at(can::Time now) const {
  if (now < end_) {
    double t = in_seconds(now - start_);
    for (std::size_t i = 0; i < count_; ++i) {
      if (t < pieces_[i].duration) return after(pieces_[i].from, pieces_[i].jerk, std::max(t, 0.0));
      t -= pieces_[i].duration;
    }
  }
  return after(last_, 0, std::max(0.0, in_seconds(now - end_)));
}

}  // namespace canopus::sim::lift
