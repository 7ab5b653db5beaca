#pragma once
// The motion of one axis over time: segments of constant acceleration. The position at any moment follows
// from the formula, not from steps, so it does not depend on the sampling.

#include <array>
#include <cstddef>

#include "canopus/can/time.hpp"

namespace canopus::sim {

/// Units of length per second, and per second squared; all > 0.
struct MotionLimits {
  double speed = 0;
  double acceleration = 0;
  double deceleration = 0;
};

class Motion {
 public:
  struct State {
    double position = 0;
    double velocity = 0;
    double acceleration = 0;
  };

  /// Sets the position, with velocity 0.
  void stand(double position) noexcept;
  /// From what it does now to rest at `target`, in the shortest time within the limits. A motion that is too fast, or that
  /// goes the other way or past the target, brakes first.
  void move_to(double target, const MotionLimits& limits, can::Time now) noexcept;
  /// From what it does now to this velocity, signed, and on with it. `limits.speed` does not apply.
  void run_at(double velocity, const MotionLimits& limits, can::Time now) noexcept;
  /// Decelerates to rest.
  void stop(double deceleration, can::Time now) noexcept;

  [[nodiscard]] State at(can::Time now) const noexcept;
  /// When the velocity is the last one: at rest at the target, or running evenly.
  [[nodiscard]] can::Time end() const noexcept { return end_; }
  /// It moves now, or will.
  [[nodiscard]] bool moves(can::Time now) const noexcept { return now < end_ || last_.velocity != 0; }

 private:
  struct Stretch {
    double seconds = 0;
    double acceleration = 0;
  };
  // Brake first, down to the speed; accelerate, go evenly, brake.
  static constexpr std::size_t most_stretches = 5;

  void begin(can::Time now) noexcept;
  void add(double velocity, double acceleration) noexcept;
  void extend(double seconds) noexcept;
  void finish(double position) noexcept;

  can::Time start_{};
  can::Time end_{};
  State first_{};
  State last_{};  // at the end
  std::array<Stretch, most_stretches> stretches_{};
  std::size_t count_ = 0;
};

}  // namespace canopus::sim
