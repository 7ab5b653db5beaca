#pragma once
// Motion with limited speed, acceleration and jerk: the S-curve of a drive. A plan is a few segments of
// constant jerk, computed once; the position at any moment is a formula, so that it arrives exactly and does
// not depend on the sampling.

#include <array>
#include <cstddef>

#include "canopus/can/time.hpp"

namespace canopus::sim::lift {

/// In mm and s; each above 0.
struct MotionLimits {
  double speed = 1000;         ///< mm/s
  double acceleration = 1000;  ///< mm/s^2
  double jerk = 1000;          ///< mm/s^3
};

struct MotionState {
  double position = 0;      ///< mm
  double velocity = 0;      ///< mm/s
  double acceleration = 0;  ///< mm/s^2
};

class Motion {
 public:
  /// At rest there.
  explicit Motion(double position = 0) { hold({position, 0, 0}, can::Time{}); }

  /// From what it does now to rest at `target`. A speed or acceleration above the limits, which were wider before, is
  /// brought down first.
  void move_to(double target, const MotionLimits& limits, can::Time now);
  /// From what it does now to this velocity (mm/s, within the limits), and on with it.
  void run_at(double velocity, const MotionLimits& limits, can::Time now);

  [[nodiscard]] MotionState at(can::Time now) const;
  /// The plan is carried out: at rest, or at its velocity for good.
  [[nodiscard]] bool is_done(can::Time now) const { return now >= end_; }

 private:
  struct Piece {
    double duration = 0;  // s
    double jerk = 0;
    MotionState from{};
  };
  using Pieces = std::array<Piece, 7>;
  struct Ramp;
  static Ramp ramp(double velocity, double acceleration, double target, const MotionLimits& limits);
  static double distance(const MotionState& from, double peak, const MotionLimits& limits);
  void hold(const MotionState& state, can::Time now);
  void add(double duration, double jerk);
  void add(const Ramp& ramp);
  void finish();

  can::Time start_{};
  can::Time end_{};
  Pieces pieces_{};
  std::size_t count_ = 0;
  MotionState last_{};  // after the last piece
};

}  // namespace canopus::sim::lift
