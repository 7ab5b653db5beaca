#include "canopus/sim/lift/door_unit.hpp"

#include <algorithm>

namespace canopus::sim::lift {

namespace {

// Bits 12 to 15 of the control word [FX3U-CAN 5.10.4].
constexpr unsigned close_no_limit = 0, close_limit = 1, nudging = 2, open_no_limit = 3, open_limit = 4,
                   stop_no_torque = 7, stop_torque = 8, reset = 0xE;

// Bits 12 to 15 of the status word [FX3U-CAN 5.10.5].
constexpr unsigned closed_torque = 0, closed_no_torque = 1, closing = 2, opened_torque = 3,
                   opened_no_torque = 4, opening = 5, reopening = 6, stopped_torque = 7,
                   stopped_no_torque = 8;

constexpr std::uint16_t reduced_mask = 0x0C00, reduced_velocity = 0x0400;

}  // namespace

void DoorUnit::command(std::uint16_t control_word) {
  if (control_word == control_word_) return;
  const unsigned before = control_word_ >> 12U;
  control_word_ = control_word;
  if (control_word >> 12U == before) return;  // other bits, such as the velocity
  switch (control_word >> 12U) {
    case close_no_limit:
    case close_limit:
    case nudging:
      wants_to_close_ = true;
      forces_ = control_word >> 12U == nudging;
      has_torque_ = true;
      if (drive_ == Drive::opening || drive_ == Drive::reopening) drive_ = Drive::none;
      break;
    case open_no_limit:
    case open_limit:
      wants_to_close_ = false;
      has_torque_ = true;
      drive_ = is_open() ? Drive::none : Drive::opening;
      break;
    case stop_no_torque:
    case stop_torque:
    case reset:
      wants_to_close_ = false;
      has_torque_ = control_word >> 12U == stop_torque;
      drive_ = Drive::none;
      break;
    default: break;
  }
}

void DoorUnit::step(can::Duration elapsed, bool blocked) {
  if (drive_ == Drive::closing && blocked && !forces_) {
    drive_ = Drive::reopening;
    wants_to_close_ = false;
    ++reversals_;
  }
  if (wants_to_close_ && drive_ == Drive::none && (forces_ || !blocked)) {
    wants_to_close_ = false;
    if (!is_closed()) drive_ = Drive::closing;
  }
  if (drive_ == Drive::none) return;
  const bool closes = drive_ == Drive::closing;
  const double full =
      std::chrono::duration<double>(closes ? settings_.close_time : settings_.open_time).count();
  double way = settings_.width / full * std::chrono::duration<double>(elapsed).count();
  if ((control_word_ & reduced_mask) == reduced_velocity || (closes && forces_)) way /= 2;
  if (!closes && is_closed()) ++openings_;
  position_ = std::clamp(closes ? position_ - way : position_ + way, 0.0, settings_.width);
  if (closes ? is_closed() : is_open()) drive_ = Drive::none;
}

std::uint16_t DoorUnit::status_word() const {
  unsigned state = has_torque_ ? stopped_torque : stopped_no_torque;
  // An end position goes before stopped [FX3U-CAN 5.10.5].
  if (drive_ == Drive::none && is_closed()) state = has_torque_ ? closed_torque : closed_no_torque;
  if (drive_ == Drive::none && is_open()) state = has_torque_ ? opened_torque : opened_no_torque;
  if (drive_ == Drive::closing) state = closing;
  if (drive_ == Drive::opening) state = opening;
  if (drive_ == Drive::reopening) state = reopening;
  constexpr unsigned lock = 0x0010, contact = 0x0001;
  constexpr unsigned no_battery_finger_motion_force = 0;
  return static_cast<std::uint16_t>(state << 12U | no_battery_finger_motion_force |
                                    (is_closed() ? lock | contact : 0U));
}

}  // namespace canopus::sim::lift
