#include "canopus/sim/drive/servo.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "canopus/eds/problems.hpp"
#include "canopus/sim/drive/servo_values.hpp"

namespace canopus::sim {

using canopen::Entry;

namespace {

constexpr std::uint16_t following_error_code = 0x8611;
constexpr std::uint32_t no_window = 0xFFFF'FFFF;

/// The bit of 1001H for an error code [CiA 301 7.2.7.1].
std::uint8_t error_register(std::uint16_t code) noexcept {
  constexpr std::uint8_t generic = 0x01;
  switch (static_cast<unsigned>(code) >> 12U) {
    case 0x2: return generic | 0x02;  // current
    case 0x3: return generic | 0x04;  // voltage
    case 0x4: return generic | 0x08;  // temperature
    case 0x7:
    case 0x8: return (code & 0xFF00U) == 0x8100 ? 0x11 : 0x21;  // communication; device profile
    default: return generic;
  }
}

}  // namespace

std::expected<std::unique_ptr<Servo>, std::string> Servo::make(
    const canopen::DictionaryDescription& description, ServoSettings settings) {
  const auto find = [&](std::uint16_t index, std::uint8_t sub = 0) {
    const Entry entry = description.find(index, sub);
    return entry && entry.description->length != 0 ? entry : Entry{};
  };
  for (const std::uint16_t index :
       std::initializer_list<std::uint16_t>{0x6040, 0x6041, 0x6060, 0x6061, 0x6064}) {
    if (!find(index)) return std::unexpected("a drive needs the object " + eds::object_text(index, 0));
  }
  const Objects objects{.error_code = find(0x603F),
                        .controlword = find(0x6040),
                        .statusword = find(0x6041),
                        .quick_stop_option = find(0x605A),
                        .mode = find(0x6060),
                        .mode_display = find(0x6061),
                        .position_demand = find(0x6062),
                        .position_actual = find(0x6064),
                        .following_error_window = find(0x6065),
                        .position_window = find(0x6067),
                        .velocity_demand = find(0x606B),
                        .velocity_actual = find(0x606C),
                        .torque_actual = find(0x6077),
                        .target_position = find(0x607A),
                        .home_offset = find(0x607C),
                        .low_limit = find(0x607D, 1),
                        .high_limit = find(0x607D, 2),
                        .highest_speed = find(0x607F),
                        .profile_speed = find(0x6081),
                        .acceleration = find(0x6083),
                        .deceleration = find(0x6084),
                        .quick_stop_deceleration = find(0x6085),
                        .homing_method = find(0x6098),
                        .speed_to_switch = find(0x6099, 1),
                        .speed_to_zero = find(0x6099, 2),
                        .homing_acceleration = find(0x609A),
                        .digital_inputs = find(0x60FD),
                        .target_velocity = find(0x60FF),
                        .supported_modes = find(0x6502)};
  return std::unique_ptr<Servo>(new Servo(objects, std::move(settings)));
}

Servo::Servo(const Objects& objects, ServoSettings settings)
    : objects_(objects), settings_(std::move(settings)) {
  std::ranges::stable_sort(settings_.faults, {}, &ServoSettings::Fault::at);
  constexpr std::size_t number_of_reasons = 5;
  explained_.reserve(number_of_reasons);  // act() allocates nothing
  motion_.stand(settings_.start);
}

bool Servo::owns(std::uint16_t index, std::uint8_t sub) const noexcept {
  const std::array shown{objects_.error_code,      objects_.statusword,      objects_.mode_display,
                         objects_.position_demand, objects_.position_actual, objects_.velocity_demand,
                         objects_.velocity_actual, objects_.torque_actual,   objects_.digital_inputs};
  return std::ranges::any_of(
      shown, [&](const Entry& entry) { return entry && entry.index == index && entry.sub == sub; });
}

// The supply came, or the node was reset: the axis keeps its position, and is not homed any more after a
// reset of the supply alone, which a simulated device has only once.
void Servo::start(Device&, can::Time now) {
  motion_.stand(motion_.at(now).position);
  state_ = DriveState::not_ready_to_switch_on;
  mode_ = Mode::none;
  word_ = 0;
  next_set_point_.reset();
  running_at_.reset();
  acknowledged_ = halted_ = beyond_ = false;
  homing_ = Homing::never_done;
  error_ = reported_error_ = 0;
  explained_.clear();
  on_ = true;
  set_alarm(now);
}

bool Servo::act(Device& device, can::Time now) {
  if (!on_) return false;
  while (next_fault_ < settings_.faults.size() && settings_.faults[next_fault_].at <= now) {
    fail(settings_.faults[next_fault_++].code);
  }
  const auto word = value<std::uint16_t>(device, objects_.controlword);
  const Asked asked{.word = word, .risen = static_cast<std::uint16_t>(word & ~word_)};
  word_ = word;
  change_state(device, asked, now);
  change_mode(device, now);
  if (state_ == DriveState::operation_enabled) serve_mode(device, asked, now);
  obey_switches(device, now);
  const bool seen = show(device, word, now);
  set_alarm(now);
  explain_standstill(device, asked, now);
  return report(device, now) || seen;
}

void Servo::set_alarm(can::Time now) noexcept {
  can::Time next = next_fault_ < settings_.faults.size() ? settings_.faults[next_fault_].at : can::never;
  if (motion_.moves(now)) {
    next = std::min(next, can::later(now, sample_interval));
    if (motion_.end() > now) next = std::min(next, motion_.end());
  }
  alarm_ = next;
}

MotionLimits Servo::limits(const Device& device, double speed, const Entry& acceleration) const {
  const double first = positive(device, acceleration);
  const Entry& second = acceleration.index == objects_.acceleration.index && objects_.deceleration
                            ? objects_.deceleration
                            : acceleration;
  return {.speed = speed, .acceleration = first, .deceleration = positive(device, second)};
}

double Servo::quick_stop_deceleration(const Device& device) const {
  return positive(
      device, objects_.quick_stop_deceleration ? objects_.quick_stop_deceleration : objects_.deceleration);
}

double Servo::allowed_speed(const Device& device, double speed) const {
  const auto highest = value<std::uint32_t>(device, objects_.highest_speed);
  return highest == 0 ? speed
                      : std::clamp(speed, -static_cast<double>(highest), static_cast<double>(highest));
}

void Servo::fail(std::uint16_t code) noexcept {
  if (error_ == 0) error_ = code;
}

/// 6061H follows 6060H where 6502H allows it.
void Servo::change_mode(const Device& device, can::Time now) {
  const int asked = value<std::int8_t>(device, objects_.mode);
  const std::uint32_t supported = value<std::uint32_t>(device, objects_.supported_modes, 0x25);
  if (asked != 1 && asked != 3 && asked != 6) return;
  if ((supported >> (asked - 1) & 1U) == 0 || static_cast<Mode>(asked) == mode_) return;
  const Mode left = std::exchange(mode_, static_cast<Mode>(asked));
  next_set_point_.reset();
  running_at_.reset();
  acknowledged_ = halted_ = false;
  if (homing_ != Homing::attained) homing_ = Homing::never_done;
  // Only the velocity mode takes over a motion as it is.
  if (left != Mode::none && mode_ != Mode::profile_velocity && motion_.moves(now)) {
    motion_.stop(limits(device, 0, objects_.acceleration).deceleration, now);
  }
}

void Servo::change_state(const Device& device, const Asked& asked, can::Time now) {
  if (error_ != 0 && state_ != DriveState::fault && state_ != DriveState::fault_reaction_active) {
    enter(device, DriveState::fault_reaction_active, now);
  }
  const auto option = value<std::int16_t>(device, objects_.quick_stop_option, 2);
  if (state_ == DriveState::fault_reaction_active && !motion_.moves(now))
    enter(device, DriveState::fault, now);
  if (state_ == DriveState::quick_stop_active && option < 5 && !motion_.moves(now)) {
    enter(device, DriveState::switch_on_disabled, now);
  }
  if (state_ == DriveState::not_ready_to_switch_on) state_ = DriveState::switch_on_disabled;
  const bool resets = (asked.risen & controlword::fault_reset) != 0;
  const DriveState next = next_state(state_, asked.word, resets, option >= 5);
  if (state_ == DriveState::fault && next != state_) error_ = 0;
  if (next != state_) enter(device, next, now);
}

void Servo::enter(const Device& device, DriveState state, can::Time now) {
  const DriveState left = std::exchange(state_, state);
  switch (state) {
    case DriveState::operation_enabled:
      set_point_ = motion_.at(now).position - origin_;
      next_set_point_.reset();
      running_at_.reset();
      acknowledged_ = halted_ = beyond_ = false;
      return;
    case DriveState::quick_stop_active: {
      const auto option = value<std::int16_t>(device, objects_.quick_stop_option, 2);
      const bool ramp = option == 1 || option == 5;
      motion_.stop(
          ramp ? limits(device, 0, objects_.acceleration).deceleration : quick_stop_deceleration(device),
          now);
      break;
    }
    case DriveState::fault_reaction_active: motion_.stop(quick_stop_deceleration(device), now); break;
    default:
      // Without torque the brake holds the axis.
      if (left == DriveState::operation_enabled || left == DriveState::quick_stop_active) {
        motion_.stop(quick_stop_deceleration(device), now);
      }
      break;
  }
  const bool searches =
      homing_ == Homing::to_switch || homing_ == Homing::off_switch || homing_ == Homing::to_index;
  if (searches) homing_ = Homing::interrupted;
}

void Servo::serve_mode(const Device& device, const Asked& asked, can::Time now) {
  switch (mode_) {
    case Mode::profile_position: return serve_position(device, asked, now);
    case Mode::profile_velocity: return serve_velocity(device, asked, now);
    case Mode::homing: return serve_homing(device, asked, now);
    case Mode::none: return;
  }
}

/// A limit switch stops a motion towards it, except homing on this switch.
void Servo::obey_switches(const Device& device, can::Time now) {
  const Motion::State is = motion_.at(now);
  at_low_ = settings_.low_switch && is.position <= *settings_.low_switch;
  at_high_ = settings_.high_switch && is.position >= *settings_.high_switch;
  if (homing_ == Homing::to_switch || homing_ == Homing::off_switch) return;
  const double speeding = is.velocity != 0 ? is.velocity : is.acceleration;
  if (!((at_low_ && speeding < 0) || (at_high_ && speeding > 0))) return;
  if (state_ != DriveState::operation_enabled) return;
  motion_.stop(quick_stop_deceleration(device), now);
  set_point_ = motion_.at(motion_.end()).position - origin_;
  next_set_point_.reset();
}

std::uint16_t Servo::status(const Device& device, std::uint16_t word, can::Time now) const {
  unsigned bits = status_bits(state_) | statusword::voltage_enabled | statusword::remote;
  const Motion::State is = motion_.at(now);
  const bool stands = !motion_.moves(now);
  const auto set = [&](unsigned bit, bool on) { bits |= on ? bit : 0; };
  set(statusword::internal_limit, at_low_ || at_high_ || beyond_);
  if (state_ == DriveState::quick_stop_active) {
    set(statusword::target_reached, stands);
    return static_cast<std::uint16_t>(bits);
  }
  if (state_ != DriveState::operation_enabled) return static_cast<std::uint16_t>(bits);
  const bool halt = (word & controlword::halt) != 0;
  switch (mode_) {
    case Mode::profile_position: {
      const auto window = value<std::uint32_t>(device, objects_.position_window, no_window);
      const double away = std::abs(value<std::int32_t>(device, objects_.position_actual) - set_point_);
      set(statusword::target_reached,
          halt ? stands : stands && (window == no_window || away <= window) && !next_set_point_);
      set(statusword::set_point_acknowledge, acknowledged_);
      break;
    }
    case Mode::profile_velocity:
      set(statusword::target_reached, now >= motion_.end() && is.velocity == running_at_.value_or(0));
      set(statusword::set_point_acknowledge, is.velocity == 0 && now >= motion_.end());
      break;
    case Mode::homing: {
      const bool searches =
          homing_ == Homing::to_switch || homing_ == Homing::off_switch || homing_ == Homing::to_index;
      set(statusword::target_reached, !searches && stands);
      set(statusword::set_point_acknowledge, homing_ == Homing::attained);
      set(statusword::following_error, homing_ == Homing::failed);
      break;
    }
    case Mode::none: break;
  }
  return static_cast<std::uint16_t>(bits);
}

bool Servo::show(Device& device, std::uint16_t word, can::Time now) {
  const Motion::State is = motion_.at(now);
  const double position = is.position - origin_;
  bool seen = put(device, objects_.position_demand, position);
  seen = put(device, objects_.position_actual, position) || seen;
  seen = put(device, objects_.velocity_demand, is.velocity) || seen;
  seen = put(device, objects_.velocity_actual, is.velocity) || seen;
  // 30 % to speed up or brake, 5 % of friction, in 0.1 %.
  const auto sign = [](double number) { return number > 0 ? 1.0 : number < 0 ? -1.0 : 0.0; };
  seen = put(device, objects_.torque_actual, 300 * sign(is.acceleration) + 50 * sign(is.velocity)) || seen;
  seen = put(device, objects_.digital_inputs, (at_low_ ? 1 : 0) + (at_high_ ? 2 : 0)) || seen;
  seen = put(device, objects_.mode_display, static_cast<double>(mode_)) || seen;

  // A forced position may differ from the motor's demand.
  const auto window = value<std::uint32_t>(device, objects_.following_error_window, no_window);
  const double behind = std::abs(position - value<std::int32_t>(device, objects_.position_actual));
  if (state_ == DriveState::operation_enabled && window != no_window && behind > window + 1.0) {
    fail(following_error_code);
    enter(device, DriveState::fault_reaction_active, now);
  }
  const bool reacted = state_ == DriveState::fault_reaction_active && !motion_.moves(now);
  if (reacted) enter(device, DriveState::fault, now);
  seen = put(device, objects_.statusword, status(device, word, now)) || seen;
  return put(device, objects_.error_code, error_) || seen;
}

/// Empty: nothing that a program overlooks easily. `is_to_move`: a set point or a speed was given.
std::string_view Servo::why_it_stands(const Device& device, bool is_to_move) const {
  constexpr std::uint32_t simulated = 0b10'0101;
  const std::uint32_t supported = value<std::uint32_t>(device, objects_.supported_modes, simulated);
  if (state_ == DriveState::operation_enabled && (supported & simulated) == 0)
    return "does not move: its 6502:00 (supported drive modes) has neither profile position nor profile "
           "velocity "
           "nor homing, so 6061:00 stays \"no mode\"";
  if (!is_to_move) return {};
  if (state_ != DriveState::operation_enabled) {
    return "does not move: a set point or a speed comes while it is not enabled; expected 6040:00 = 6, 7 and "
           "15 "
           "one after the other, until 6041:00 shows \"operation enabled\"";
  }
  const int asked = value<std::int8_t>(device, objects_.mode);
  if (mode_ == Mode::none && asked == 0)
    return "does not move: 6060:00 (modes of operation) is 0, and no PDO or SDO selects a mode; expected 1 "
           "(profile "
           "position), 3 (profile velocity) or 6 (homing)";
  if (mode_ == Mode::none)
    return "does not move: 6060:00 (modes of operation) asks for a mode that is not simulated, or that "
           "6502:00 does "
           "not have; expected 1 (profile position), 3 (profile velocity) or 6 (homing)";
  const bool has_no_speed =
      mode_ == Mode::profile_position && value<std::uint32_t>(device, objects_.profile_speed) == 0;
  if (has_no_speed)
    return "does not move: 6081:00 (profile velocity) is 0, or the drive has no such object; expected a "
           "speed";
  return {};
}

void Servo::explain_standstill(const Device& device, const Asked& asked, can::Time now) {
  if (!standstill_report_) return;
  const bool is_velocity = mode_ == Mode::profile_velocity || mode_ == Mode::none;
  const bool has_speed = is_velocity && value<std::int32_t>(device, objects_.target_velocity) != 0;
  const bool has_set_point =
      mode_ != Mode::profile_velocity && (asked.risen & controlword::new_set_point) != 0;
  const bool is_enabled = state_ == DriveState::operation_enabled;
  if (!has_set_point && !is_enabled) return;  // a speed may be there before the drive is enabled
  const std::string_view why = why_it_stands(device, has_speed || has_set_point);
  if (why.empty() || std::ranges::find(explained_, why) != explained_.end()) return;
  explained_.push_back(why);
  standstill_report_(why, now);
}

/// Emergency messages, once for each error and once when it is gone.
bool Servo::report(Device& device, can::Time now) {
  if (error_ == reported_error_) return false;
  reported_error_ = error_;
  if (error_ != 0) {
    device.emergency(error_, error_register(error_), {}, now);
  } else {
    device.emergency_reset(now);
  }
  return false;
}

}  // namespace canopus::sim
