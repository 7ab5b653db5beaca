#include "canopus/sim/lift/drive_unit.hpp"

#include <algorithm>
#include <cmath>

namespace canopus::sim::lift {

namespace {

// Control word [FX3U-CAN 5.10.7].
constexpr std::uint16_t switch_on = 0x0001, enable_voltage = 0x0002, no_quick_stop = 0x0004,
                        enable_operation = 0x0008;
constexpr std::uint16_t new_set_point = 0x0010, change_at_once = 0x0020, relative = 0x0040;
constexpr std::uint16_t fault_reset = 0x0080, halt = 0x0100;

// Status word [FX3U-CAN 5.10.8].
constexpr std::uint16_t voltage_enabled = 0x0010, remote = 0x0200, target_reached = 0x0400,
                        internal_limit = 0x0800, set_point_acknowledge = 0x1000;

constexpr std::int8_t profile_position = 1, profile_velocity = 3;

}  // namespace

bool DriveUnit::stands(can::Time now) const {
  return motion_.is_done(now) && std::abs(motion_.at(now).velocity) < 1e-6;
}

bool DriveUnit::moves(can::Time now) const { return !stands(now); }

/// By the brake: harder than any travel.
MotionLimits DriveUnit::braking() const {
  MotionLimits limits = settings_.limits;
  limits.acceleration *= 2;
  limits.jerk *= 4;
  return limits;
}

void DriveUnit::brake(can::Time now) {
  has_target_ = waits_ = false;
  speed_ = 0;
  if (!stands(now)) motion_.run_at(0, braking(), now);
}

void DriveUnit::fail(bool stays, can::Time now) {
  broken_ = broken_ || stays;
  if (state_ == State::fault || state_ == State::fault_reaction_active) return;
  state_ = State::fault_reaction_active;
  brake(now);
}

// The transitions of CiA 402 [FX3U-CAN 5.10.7, 5.10.8].
void DriveUnit::follow_state(std::uint16_t control, bool reset_edge, can::Time now) {
  const bool volts = (control & enable_voltage) != 0;
  const bool quick = volts && (control & no_quick_stop) == 0;
  const bool reset = (control & fault_reset) != 0;
  const bool ready = volts && !quick && !reset;
  const auto off = [&] {
    brake(now);
    state_ = State::switch_on_disabled;
  };
  switch (state_) {
    case State::switch_on_disabled:
      if (ready && (control & switch_on) == 0) state_ = State::ready_to_switch_on;
      break;
    case State::ready_to_switch_on:
      if (!volts || quick) return off();
      if (ready && (control & switch_on) != 0) state_ = State::switched_on;
      break;
    case State::switched_on:
      if (!volts || quick) return off();
      if (ready && (control & switch_on) == 0) {
        state_ = State::ready_to_switch_on;
      } else if (ready && (control & enable_operation) != 0) {
        state_ = State::operation_enabled;
        reached_ = acknowledged_ = halted_ = false;
      }
      break;
    case State::operation_enabled:
      if (!volts) return off();
      if (quick) {
        state_ = State::quick_stop_active;
        brake(now);
      } else if (ready && (control & switch_on) == 0) {
        brake(now);
        state_ = State::ready_to_switch_on;
      } else if (ready && (control & enable_operation) == 0) {
        brake(now);
        state_ = State::switched_on;
      }
      break;
    case State::quick_stop_active:
      if (!volts || stands(now)) off();
      break;
    case State::fault_reaction_active:
      if (stands(now)) state_ = State::fault;
      break;
    case State::fault:
      if (reset_edge && !broken_) state_ = State::switch_on_disabled;
      break;
  }
}

void DriveUnit::command(const DriveCommand& command, can::Time now) {
  const DriveCommand before = command_;
  command_ = command;
  const bool reset_edge = (command.control_word & ~before.control_word & fault_reset) != 0;
  const State was = state_;
  follow_state(command.control_word, reset_edge, now);
  // Switch on and enable operation may come in one command.
  if (was != state_ && state_ == State::switched_on) follow_state(command.control_word, false, now);
  if (state_ == State::operation_enabled) follow_target(before, now);
  const MotionState is = motion_.at(now);
  constexpr double overrun = 100;  // mm behind a final limit switch
  if ((is.position > settings_.highest + overrun && is.velocity > 0) ||
      (is.position < settings_.lowest - overrun && is.velocity < 0)) {
    fail(false, now);
  }
}

void DriveUnit::set_point(can::Time now) {
  const double from =
      (command_.control_word & relative) != 0 ? (has_target_ ? target_ : motion_.at(now).position) : 0;
  const double wanted = from + command_.target_position;
  target_ = std::clamp(wanted, settings_.lowest, settings_.highest);
  speed_ = std::min<double>(command_.profile_velocity, settings_.limits.speed);
  limited_ = wanted != target_ || command_.profile_velocity > settings_.limits.speed;
  has_target_ = true;
  waits_ = false;
  reached_ = false;
  if (!halted_) go(now);
}

void DriveUnit::go(can::Time now) {
  if (speed_ <= 0) return;
  MotionLimits limits = settings_.limits;
  limits.speed = speed_;
  motion_.move_to(target_, limits, now);
}

void DriveUnit::follow_target(const DriveCommand& before, can::Time now) {
  const std::uint16_t control = command_.control_word;
  if (command_.mode != before.mode) {
    has_target_ = waits_ = reached_ = limited_ = false;
    speed_ = 0;
    if (!stands(now)) motion_.run_at(0, settings_.limits, now);
  }
  const bool halts = (control & halt) != 0;
  if (halts != halted_) {
    halted_ = halts;
    if (halts) motion_.run_at(0, settings_.limits, now);
    if (!halts && has_target_) go(now);
  }
  if (command_.mode == profile_position) {
    follow_position((control & ~before.control_word & new_set_point) != 0, now);
  } else if (command_.mode == profile_velocity) {
    follow_velocity(now);
  }
}

void DriveUnit::follow_position(bool is_new, can::Time now) {
  if ((command_.control_word & new_set_point) == 0) acknowledged_ = false;
  if (is_new) acknowledged_ = waits_ = true;
  if (halted_) {
    reached_ = stands(now);
    return;
  }
  if (has_target_ && motion_.is_done(now) && motion_.at(now).position == target_) {
    has_target_ = false;
    reached_ = true;
  }
  if (waits_ && (!has_target_ || (command_.control_word & change_at_once) != 0)) set_point(now);
}

void DriveUnit::follow_velocity(can::Time now) {
  const double limit = settings_.limits.speed;
  const double wanted = halted_ ? 0 : std::clamp<double>(command_.target_velocity, -limit, limit);
  limited_ = std::abs(static_cast<double>(command_.target_velocity)) > limit;
  if (wanted != speed_) {
    speed_ = wanted;
    motion_.run_at(wanted, settings_.limits, now);
  }
  reached_ = motion_.is_done(now);
}

std::uint16_t DriveUnit::status_word() const {
  unsigned word = remote;
  switch (state_) {
    case State::switch_on_disabled: return static_cast<std::uint16_t>(word | 0x0040);
    case State::ready_to_switch_on: return static_cast<std::uint16_t>(word | voltage_enabled | 0x0021);
    case State::switched_on: return static_cast<std::uint16_t>(word | voltage_enabled | 0x0023);
    case State::operation_enabled: word |= voltage_enabled | 0x0027; break;
    case State::quick_stop_active: return static_cast<std::uint16_t>(word | voltage_enabled | 0x0007);
    case State::fault_reaction_active: return static_cast<std::uint16_t>(word | voltage_enabled | 0x000F);
    case State::fault: return static_cast<std::uint16_t>(word | 0x0008);
  }
  if (reached_) word |= target_reached;
  if (limited_) word |= internal_limit;
  if (acknowledged_) word |= set_point_acknowledge;
  return static_cast<std::uint16_t>(word);
}

}  // namespace canopus::sim::lift
