#pragma once
// A car drive unit: the state machine of CiA 402 with the objects of CiA 417 (6400H control word ... 6433H velocity actual
// value), a machine with an S-curve, and its brake.

#include <cstdint>

#include "canopus/can/time.hpp"
#include "canopus/sim/lift/motion.hpp"

namespace canopus::sim::lift {

struct DriveSettings {
  MotionLimits limits{1000, 800, 1000};
  double lowest = 0;   ///< mm: final limit switches
  double highest = 0;  ///< mm
};

/// The command of a car drive controller.
struct DriveCommand {
  std::uint16_t control_word = 0;      ///< 6400H
  std::int8_t mode = 0;                ///< 6403H: 1 profile position, 3 profile velocity; others do nothing
  std::int32_t target_position = 0;    ///< 6420H, mm
  std::uint32_t profile_velocity = 0;  ///< 6423H, mm/s; 0: it does not move
  std::int32_t target_velocity = 0;    ///< 6430H, mm/s
};

class DriveUnit {
 public:
  enum class State : std::uint8_t {
    switch_on_disabled,
    ready_to_switch_on,
    switched_on,
    operation_enabled,
    quick_stop_active,
    fault_reaction_active,
    fault,
  };

  DriveUnit(const DriveSettings& settings, double position) : settings_(settings), motion_(position) {}

  /// Follows the controller's command. Call it at each step and after each command.
  void command(const DriveCommand& command, can::Time now);
  /// The safety circuit has opened, or the drive itself is broken: brake, then fault. `stays`: fault reset has no effect
  /// until repaired().
  void fail(bool stays, can::Time now);
  void repaired() { broken_ = false; }

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] std::uint16_t status_word() const;  ///< 6401H
  /// 6404H: 0 for a mode that it does not have.
  [[nodiscard]] std::int8_t mode_display() const {
    return command_.mode == 1 || command_.mode == 3 ? command_.mode : std::int8_t{0};
  }
  [[nodiscard]] MotionState motion(can::Time now) const { return motion_.at(now); }
  /// The car moves, or is about to.
  [[nodiscard]] bool moves(can::Time now) const;

 private:
  void follow_state(std::uint16_t control, bool reset_edge, can::Time now);
  void follow_target(const DriveCommand& before, can::Time now);
  void follow_position(bool is_new, can::Time now);
  void follow_velocity(can::Time now);
  void set_point(can::Time now);
  void go(can::Time now);
  void brake(can::Time now);
  [[nodiscard]] MotionLimits braking() const;
  [[nodiscard]] bool stands(can::Time now) const;

  DriveSettings settings_;
  Motion motion_;
  State state_ = State::switch_on_disabled;
  DriveCommand command_{};
  double target_ = 0;        // mm, absolute
  double speed_ = 0;         // mm/s, of this set-point; in profile velocity mode the signed target
  bool has_target_ = false;  // a set-point is being carried out
  bool waits_ = false;       // another one waits behind it
  bool acknowledged_ = false;
  bool reached_ = false;
  bool limited_ = false;
  bool halted_ = false;
  bool broken_ = false;
};

}  // namespace canopus::sim::lift
