#pragma once
// A servo drive as CiA 402 describes it, with its motor and its axis: state machine, profile position,
// profile velocity and homing. Positions are in the units of 6064H, speeds in those per second. The motor
// follows its demand exactly; a script that forces 6064H blocks it, and the drive then detects a following
// error.

#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/sim/device/application.hpp"
#include "canopus/sim/drive/drive_state.hpp"
#include "canopus/sim/drive/motion.hpp"

namespace canopus::sim {

/// The axis, in the units of 6064H from where the machine counts; the drive counts from where it was homed.
struct ServoSettings {
  double start = 0;                     ///< position at power-on
  std::optional<double> low_switch{};   ///< the negative limit switch acts from here down
  std::optional<double> high_switch{};  ///< the positive one from here up
  double revolution = 10'000;           ///< between two index pulses, > 0; one is at 0
  /// A fault: the drive reports this code (603FH, EMCY) and is in fault.
  struct Fault {
    can::Time at{};
    std::uint16_t code = 0;
  };
  std::vector<Fault> faults{};  ///< in any order
};

class Servo final : public DeviceApplication {
 public:
  /// Sampling interval of its motion while it moves.
  static constexpr can::Duration sample_interval = std::chrono::milliseconds(1);

  /// The error names the missing object, for the plant file's author. 6040H, 6041H, 6060H, 6061H and 6064H
  /// must be there; each other object is optional.
  [[nodiscard]] static std::expected<std::unique_ptr<Servo>, std::string> make(
      const canopen::DictionaryDescription& description, ServoSettings settings);

  /// Gets the sentence for each reason why the drive is to move and does not, once until the next start.
  using StandstillReport = std::function<void(std::string_view reason, can::Time now)>;
  void set_standstill_report(StandstillReport report) { standstill_report_ = std::move(report); }

  // DeviceApplication
  [[nodiscard]] bool owns(std::uint16_t index, std::uint8_t sub) const noexcept override;
  void start(Device& device, can::Time now) override;
  bool act(Device& device, can::Time now) override;
  [[nodiscard]] can::Alarm& alarm() noexcept override { return alarm_; }

 private:
  enum class Mode : std::int8_t { none = 0, profile_position = 1, profile_velocity = 3, homing = 6 };
  enum class Homing : std::uint8_t {
    never_done,
    to_switch,   // until the limit switch acts
    off_switch,  // back to where it begins to act
    to_index,    // to the index pulse
    attained,
    interrupted,
    failed,
  };
  /// Its objects; those that it has not are empty.
  struct Objects {
    canopen::Entry error_code, controlword, statusword, quick_stop_option, mode, mode_display,
        position_demand, position_actual, following_error_window, position_window, velocity_demand,
        velocity_actual, torque_actual, target_position, home_offset, low_limit, high_limit, highest_speed,
        profile_speed, acceleration, deceleration, quick_stop_deceleration, homing_method, speed_to_switch,
        speed_to_zero, homing_acceleration, digital_inputs, target_velocity, supported_modes;
  };
  /// The present command of the program.
  struct Asked {
    std::uint16_t word = 0;
    std::uint16_t risen = 0;  // bits of it
  };

  Servo(const Objects& objects, ServoSettings settings);

  [[nodiscard]] MotionLimits limits(const Device& device, double speed,
                                    const canopen::Entry& acceleration) const;
  [[nodiscard]] double quick_stop_deceleration(const Device& device) const;
  [[nodiscard]] double allowed_speed(const Device& device, double speed) const;

  void set_alarm(can::Time now) noexcept;
  void change_mode(const Device& device, can::Time now);
  void change_state(const Device& device, const Asked& asked, can::Time now);
  void enter(const Device& device, DriveState state, can::Time now);
  void fail(std::uint16_t code) noexcept;
  void serve_mode(const Device& device, const Asked& asked, can::Time now);
  void serve_position(const Device& device, const Asked& asked, can::Time now);
  void serve_velocity(const Device& device, const Asked& asked, can::Time now);
  void serve_homing(const Device& device, const Asked& asked, can::Time now);
  void begin_homing(const Device& device, can::Time now);
  void end_homing(const Device& device, double home, can::Time now);
  void obey_switches(const Device& device, can::Time now);
  void approach_set_point(const Device& device, can::Time now);
  [[nodiscard]] double index_from(double position, double direction) const noexcept;
  [[nodiscard]] std::uint16_t status(const Device& device, std::uint16_t word, can::Time now) const;
  bool show(Device& device, std::uint16_t word, can::Time now);
  bool report(Device& device, can::Time now);
  void explain_standstill(const Device& device, const Asked& asked, can::Time now);
  [[nodiscard]] std::string_view why_it_stands(const Device& device, bool is_to_move) const;

  Objects objects_;
  ServoSettings settings_;
  DriveState state_ = DriveState::not_ready_to_switch_on;
  Mode mode_ = Mode::none;
  std::uint16_t word_ = 0;  // what it was
  bool on_ = false;
  Motion motion_;      // of the axis, as the machine counts
  double origin_ = 0;  // 0 of the drive, as the machine counts
  bool at_low_ = false;
  bool at_high_ = false;
  bool beyond_ = false;  // a target was beyond a software limit

  // Profile position.
  double set_point_ = 0;  // as the drive counts
  std::optional<double> next_set_point_;
  bool acknowledged_ = false;
  bool halted_ = false;
  // Profile velocity.
  std::optional<double> running_at_;
  Homing homing_ = Homing::never_done;

  std::size_t next_fault_ = 0;
  std::uint16_t error_ = 0;           // code, 0: none
  std::uint16_t reported_error_ = 0;  // by EMCY
  StandstillReport standstill_report_;
  std::vector<std::string_view> explained_;  // reasons that were reported
  can::Alarm alarm_;
};

}  // namespace canopus::sim
