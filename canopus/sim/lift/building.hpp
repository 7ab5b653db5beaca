#pragma once
// A lift, or a group of equal lifts, in a building: cars, doors, panels and the people in it, behind CiA 417
// devices. It simulates physics and people; the lift controller is outside, and accesses only the devices'
// objects.
//
// The devices are simulated ones of their own (sim::Device) with an application() of this building each. The building is a
// participant of the timeline that moves everything in steps of 10 ms while something moves.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/sim/device/device.hpp"
#include "canopus/sim/lift/building_settings.hpp"
#include "canopus/sim/lift/door_unit.hpp"
#include "canopus/sim/lift/drive_unit.hpp"
#include "canopus/sim/lift/lift_report.hpp"
#include "canopus/sim/lift/panel.hpp"
#include "canopus/sim/lift/passengers.hpp"
#include "canopus/sim/lift/units.hpp"

namespace canopus::sim::lift {

/// The devices around a building, by their number in units().
class LiftDevices {
 public:
  /// Its plug is pulled, or in again.
  virtual void unit_plugged(std::size_t unit, bool plugged, can::Time now) = 0;

 protected:
  ~LiftDevices() = default;
};

class Building final : public can::Ticker {
 public:
  explicit Building(BuildingSettings settings);

  [[nodiscard]] const BuildingSettings& settings() const { return settings_; }
  [[nodiscard]] std::span<const Unit> units() const { return units_; }
  /// The application of this unit's device. The building must outlive it.
  [[nodiscard]] std::unique_ptr<DeviceApplication> application(std::size_t unit);
  /// Before the first tick; both must outlive it, nullptr for none.
  void connect(LiftDevices* devices, LiftObserver* observer) {
    devices_ = devices;
    observer_ = observer;
  }

  void tick(can::Time now) override;

  [[nodiscard]] LiftReport report() const;
  [[nodiscard]] std::span<const Passenger> passengers() const { return passengers_; }
  [[nodiscard]] CarView car(std::size_t car, can::Time now) const;
  /// Of a floor (1 ...), or with 0 of a car.
  [[nodiscard]] const Panel& panel(std::uint8_t floor, std::size_t car = 0) const;

 private:
  friend class UnitApplication;
  static constexpr std::size_t most_values = 6;
  using Values = std::array<std::uint32_t, most_values>;
  /// The device side of a unit.
  struct Shown {
    std::array<canopen::Entry, most_values> outputs{};
    std::array<canopen::Entry, 5> inputs{};
    Values values{};              // last put
    Mapping output{};             // 6011H, last seen
    std::uint16_t emergency = 0;  // to send
    bool recovers = false;        // emergency reset to send
    can::Alarm alarm;             // of the application
  };
  struct Transfer {
    std::size_t passenger = 0;
    bool enters = false;
    can::Time end{};
  };
  struct Car {
    DriveUnit drive;
    std::vector<DoorUnit> doors;
    DriveCommand command{};
    std::optional<Transfer> transfer{};
    double load = 0;  // kg, of people
    can::Time last_change{};
    bool moved = false;
    bool open_between = false, open_moving = false, overspeed = false, overloaded = false;
    std::array<bool, most_doors> was_open{}, was_closed{true, true, true};
    std::array<std::uint32_t, most_doors> reversals{};
    // Faults now.
    unsigned blocked = 0, defective = 0, lost = 0, weights = 0;
    CarCounts counts{};
  };

  // Devices.
  void start(std::size_t unit, Device& device, can::Time now);
  bool act(std::size_t unit, Device& device, can::Time now);
  bool act_as_panel(std::size_t unit, Device& device, can::Time now);
  void read_commands(std::size_t unit, Device& device, can::Time now);
  [[nodiscard]] Values values_of(std::size_t unit, can::Time now) const;
  void show_changes(can::Time now);

  // Cars.
  [[nodiscard]] bool is_blocked(const Car& car, std::size_t door) const;
  [[nodiscard]] std::optional<std::uint8_t> floor_of(const Car& car, can::Time now) const;
  [[nodiscard]] std::uint8_t nearest_floor(double position) const;
  [[nodiscard]] double load_of(const Car& car) const;
  [[nodiscard]] bool is_overloaded(const Car& car) const;
  [[nodiscard]] std::uint8_t load_signal(const Car& car) const;
  [[nodiscard]] double effort(const Car& car, can::Time now) const;
  void move_car(std::size_t number, can::Duration elapsed, can::Time now);
  void watch_doors(std::size_t number, can::Time now);
  void watch_safety(std::size_t number, can::Time now);

  // People.
  void people(can::Time now);
  void board_and_leave(std::size_t number, can::Time now);
  void end_transfer(std::size_t number, can::Time now);
  bool can_board(const Passenger& passenger, std::size_t car, std::uint8_t floor) const;
  void press_buttons(std::size_t index, can::Time now);
  [[nodiscard]] std::size_t panel_number(std::uint8_t floor, std::size_t car) const;

  // Faults.
  void carry_out_faults(can::Time now);
  void set_fault(const LiftFault& fault, bool begins, can::Time now);
  [[nodiscard]] std::size_t unit_of(UnitKind kind, std::size_t car, unsigned door = 0) const;

  void report_event(LiftEvent event);

  BuildingSettings settings_;
  std::vector<Unit> units_;
  std::vector<Shown> shown_;
  std::vector<Panel> panels_;  // of floors, then of cars: the first units
  std::vector<Car> cars_;
  std::vector<Passenger> passengers_;
  std::size_t coming_ = 0;                  // the next passenger who comes
  std::size_t present_ = 0;                 // all before have arrived
  std::vector<std::uint8_t> fault_states_;  // of each fault: 0 before, 1 now, 2 over
  LiftDevices* devices_ = nullptr;
  LiftObserver* observer_ = nullptr;
  can::Time last_{};
};

}  // namespace canopus::sim::lift
