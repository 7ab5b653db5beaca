// Profile position, profile velocity and homing.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "canopus/sim/drive/servo.hpp"
#include "canopus/sim/drive/servo_values.hpp"

namespace canopus::sim {

using canopen::Entry;

namespace {

// 6098H.
constexpr int low_switch_and_index = 1, high_switch_and_index = 2, low_switch = 17, high_switch = 18,
              index_below = 33, index_above = 34, here = 35, here_too = 37;

}  // namespace

void Servo::approach_set_point(const Device& device, can::Time now) {
  const double speed = allowed_speed(device, value<std::uint32_t>(device, objects_.profile_speed));
  if (speed <= 0) return motion_.stop(limits(device, 0, objects_.acceleration).deceleration, now);
  motion_.move_to(origin_ + set_point_, limits(device, speed, objects_.acceleration), now);
}

void Servo::serve_position(const Device& device, const Asked& asked, can::Time now) {
  if ((asked.risen & controlword::new_set_point) != 0 && !next_set_point_) {
    const double base = (asked.word & controlword::relative) != 0 ? set_point_ : 0;
    const double asked_for = base + value<std::int32_t>(device, objects_.target_position);
    const auto low =
        value<std::int32_t>(device, objects_.low_limit, std::numeric_limits<std::int32_t>::min());
    const auto high =
        value<std::int32_t>(device, objects_.high_limit, std::numeric_limits<std::int32_t>::max());
    const double target = low < high ? std::clamp<double>(asked_for, low, high) : asked_for;
    beyond_ = target != asked_for;
    acknowledged_ = true;
    if ((asked.word & controlword::change_at_once) == 0 && motion_.moves(now) && !halted_) {
      next_set_point_ = target;
    } else {
      set_point_ = target;
      if (!halted_) approach_set_point(device, now);
    }
  }
  const bool halt = (asked.word & controlword::halt) != 0;
  if (halt != halted_) {
    halted_ = halt;
    if (halt) {
      motion_.stop(limits(device, 0, objects_.acceleration).deceleration, now);
    } else {
      approach_set_point(device, now);
    }
  }
  if (next_set_point_ && !motion_.moves(now) && !halted_) {
    set_point_ = *std::exchange(next_set_point_, std::nullopt);
    approach_set_point(device, now);
  }
  if ((asked.word & controlword::new_set_point) == 0 && !next_set_point_) acknowledged_ = false;
}

void Servo::serve_velocity(const Device& device, const Asked& asked, can::Time now) {
  const bool halt = (asked.word & controlword::halt) != 0;
  const double wanted =
      halt ? 0 : allowed_speed(device, value<std::int32_t>(device, objects_.target_velocity));
  if (running_at_ == wanted) return;
  running_at_ = wanted;
  motion_.run_at(wanted, limits(device, std::abs(wanted), objects_.acceleration), now);
}

double Servo::index_from(double position, double direction) const noexcept {
  const double turns = position / settings_.revolution;
  return settings_.revolution * (direction > 0 ? std::floor(turns) + 1 : std::ceil(turns) - 1);
}

void Servo::begin_homing(const Device& device, can::Time now) {
  const int method = value<std::int8_t>(device, objects_.homing_method, here);
  const Entry& speed_up = objects_.homing_acceleration ? objects_.homing_acceleration : objects_.acceleration;
  const double fast = value<std::uint32_t>(device, objects_.speed_to_switch);
  const double slow = value<std::uint32_t>(device, objects_.speed_to_zero);
  const double here_now = motion_.at(now).position;
  const auto seek = [&](bool high) {
    const auto& where = high ? settings_.high_switch : settings_.low_switch;
    if (!where || fast <= 0 || slow <= 0) {
      homing_ = Homing::failed;
      return;
    }
    homing_ = Homing::to_switch;
    motion_.run_at(high ? fast : -fast, limits(device, fast, speed_up), now);
  };
  switch (method) {
    case low_switch_and_index:
    case low_switch: return seek(false);
    case high_switch_and_index:
    case high_switch: return seek(true);
    case index_below:
    case index_above:
      homing_ = slow > 0 ? Homing::to_index : Homing::failed;
      if (slow > 0) {
        motion_.move_to(index_from(here_now, method == index_above ? 1 : -1), limits(device, slow, speed_up),
                        now);
      }
      return;
    case here:
    case here_too: return end_homing(device, here_now, now);
    default: homing_ = Homing::failed;  // no method of this drive
  }
}

void Servo::end_homing(const Device& device, double home, can::Time now) {
  homing_ = Homing::attained;
  origin_ = home - value<std::int32_t>(device, objects_.home_offset);
  motion_.stand(motion_.at(now).position);
}

void Servo::serve_homing(const Device& device, const Asked& asked, can::Time now) {
  const int method = value<std::int8_t>(device, objects_.homing_method, here);
  const bool upwards = method == high_switch || method == high_switch_and_index;
  const Entry& speed_up = objects_.homing_acceleration ? objects_.homing_acceleration : objects_.acceleration;
  const bool searches =
      homing_ == Homing::to_switch || homing_ == Homing::off_switch || homing_ == Homing::to_index;
  const bool wanted = (asked.word & controlword::new_set_point) != 0 && (asked.word & controlword::halt) == 0;
  if (searches && !wanted) {
    homing_ = Homing::interrupted;
    motion_.stop(positive(device, speed_up), now);
    return;
  }
  if ((asked.risen & controlword::new_set_point) != 0 && wanted && !motion_.moves(now))
    begin_homing(device, now);
  const double slow = value<std::uint32_t>(device, objects_.speed_to_zero);
  const double edge = (upwards ? settings_.high_switch : settings_.low_switch).value_or(0);
  const double position = motion_.at(now).position;
  const bool acts = upwards ? position >= edge : position <= edge;
  if (homing_ == Homing::to_switch && acts) {
    homing_ = Homing::off_switch;
    motion_.move_to(edge, limits(device, slow, speed_up), now);
  }
  if (homing_ == Homing::off_switch && !motion_.moves(now)) {
    if (method == low_switch || method == high_switch) return end_homing(device, edge, now);
    homing_ = Homing::to_index;
    motion_.move_to(index_from(edge, upwards ? -1 : 1), limits(device, slow, speed_up), now);
  }
  if (homing_ == Homing::to_index && !motion_.moves(now)) end_homing(device, position, now);
}

}  // namespace canopus::sim
