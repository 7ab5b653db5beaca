// The devices of a building: what their objects show, and what a controller has put into them.

#include <algorithm>
#include <cmath>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/sim/lift/building.hpp"

namespace canopus::sim::lift {

/// The application of one device.
class UnitApplication final : public DeviceApplication {
 public:
  UnitApplication(Building& building, std::size_t unit) : building_(building), unit_(unit) {}
  void start(Device& device, can::Time now) override { building_.start(unit_, device, now); }
  bool act(Device& device, can::Time now) override { return building_.act(unit_, device, now); }
  [[nodiscard]] can::Alarm& alarm() noexcept override { return building_.shown_[unit_].alarm; }

 private:
  Building& building_;
  std::size_t unit_;
};

std::unique_ptr<DeviceApplication> Building::application(std::size_t unit) {
  return std::make_unique<UnitApplication>(*this, unit);
}

void Building::start(std::size_t unit, Device& device, can::Time now) {
  const Unit& what = units_[unit];
  Shown& shown = shown_[unit];
  const canopen::DictionaryDescription& objects = *device.file().dictionary;
  const auto entry = [&](unsigned of_lift_1, unsigned sub) {
    return objects.find(static_cast<std::uint16_t>(of_lift_1 + 0x0800U * what.lift),
                        static_cast<std::uint8_t>(sub));
  };
  const unsigned door = what.door + 1U;
  switch (what.kind) {
    case UnitKind::hall_panel:
    case UnitKind::car_panel:
      shown.inputs = {objects.find(0x6011, 0), objects.find(0x6010, 0)};
      shown.output = {};
      panels_[unit].forget();
      break;
    case UnitKind::car_drive_unit:
      shown.inputs = {entry(0x6400, 0), entry(0x6403, 0), entry(0x6420, 0), entry(0x6423, 0),
                      entry(0x6430, 0)};
      shown.outputs = {entry(0x6401, 0), entry(0x6404, 0), entry(0x6406, 0), entry(0x6407, 0),
                       entry(0x6433, 0)};
      break;
    case UnitKind::car_position_unit:
      shown.outputs = {entry(0x6383, 1), entry(0x6390, 1), entry(0x6391, 1)};
      break;
    case UnitKind::load_unit:
      shown.outputs = {entry(0x6480, 1), entry(0x6480, 2), entry(0x6482, 1), entry(0x6482, 2)};
      break;
    case UnitKind::car_door_unit:
      shown.inputs = {entry(0x6300, door)};
      shown.outputs = {entry(0x6301, door), entry(0x6302, door), entry(0x6310, door)};
      break;
  }
  (void)act(unit, device, now);
}

bool Building::act(std::size_t unit, Device& device, can::Time now) {
  Shown& shown = shown_[unit];
  if (unit < panels_.size()) return act_as_panel(unit, device, now);
  shown.alarm.cancel();
  read_commands(unit, device, now);
  shown.values = values_of(unit, now);
  bool changed = false;
  for (std::size_t i = 0; i < shown.outputs.size(); ++i) {
    if (shown.outputs[i]) changed = device.put(shown.outputs[i], shown.values[i]) || changed;
  }
  if (shown.emergency != 0) {
    constexpr std::uint8_t generic_and_profile = 0x21;
    (void)device.emergency(std::exchange(shown.emergency, std::uint16_t{0}), generic_and_profile, {}, now);
  }
  if (std::exchange(shown.recovers, false)) (void)device.emergency_reset(now);
  return changed;
}

/// A virtual input is an event even when it equals the last one.
bool Building::act_as_panel(std::size_t unit, Device& device, can::Time now) {
  Shown& shown = shown_[unit];
  Panel& panel = panels_[unit];
  const std::span<const std::uint8_t> bytes = device.node().dictionary().bytes(shown.inputs[0]);
  Mapping output{};
  for (std::size_t i = 0; i < output.size(); ++i) output[i] = bytes[i];
  if (output != shown.output) {
    shown.output = output;
    const Panel before = panel;
    (void)panel.output(shown.output, now);
    for (unsigned sub = 1; sub <= settings_.floors.size(); ++sub) {
      const auto lamp = static_cast<std::uint8_t>(sub);
      const bool hall = panel.floor() != 0;
      if (hall && lamp > down) break;
      if (before.is_lit(lamp) == panel.is_lit(lamp)) continue;
      const Unit& what = units_[unit];
      report_event(
          {.kind = panel.is_lit(lamp) ? LiftEvent::Kind::call_registered : LiftEvent::Kind::call_answered,
           .time = now,
           .lift = hall ? std::uint8_t{0} : settings_.lifts[what.car],
           .floor = hall ? panel.floor() : lamp,
           .direction = hall ? lamp : std::uint8_t{0}});
    }
  }
  if (const auto input = panel.next_input(now)) {
    device.node().dictionary().assign(shown.inputs[1], *input);
    (void)device.node().tpdo_event(input_pdo, now);
    shown.alarm = panel.deadline(now);
  } else {
    shown.alarm.cancel();
  }
  return false;
}

void Building::read_commands(std::size_t unit, Device& device, can::Time now) {
  const Unit& what = units_[unit];
  const std::array<canopen::Entry, 5>& inputs = shown_[unit].inputs;
  const canopen::ObjectDictionary& objects = device.node().dictionary();
  Car& car = cars_[what.car];
  if (what.kind == UnitKind::car_drive_unit) {
    car.command = {.control_word = objects.get<std::uint16_t>(inputs[0]),
                   .mode = objects.get<std::int8_t>(inputs[1]),
                   .target_position = objects.get<std::int32_t>(inputs[2]),
                   .profile_velocity = objects.get<std::uint32_t>(inputs[3]),
                   .target_velocity = objects.get<std::int32_t>(inputs[4])};
    car.drive.command(car.command, now);
  }
  if (what.kind == UnitKind::car_door_unit)
    car.doors[what.door].command(objects.get<std::uint16_t>(inputs[0]));
}

Building::Values Building::values_of(std::size_t unit, can::Time now) const {
  const Unit& what = units_[unit];
  const Car& car = cars_[what.car];
  const MotionState is = car.drive.motion(now);
  const auto rounded = [](double value) { return static_cast<std::uint32_t>(std::lround(value)); };
  const auto word = [](double value) {
    return static_cast<std::uint16_t>(
        static_cast<std::int16_t>(std::clamp(std::lround(value), -32767L, 32767L)));
  };
  constexpr std::uint32_t not_available = 0xFFFFFFFF;
  switch (what.kind) {
    case UnitKind::hall_panel:
    case UnitKind::car_panel: break;
    case UnitKind::car_drive_unit:
      return {car.drive.status_word(), static_cast<std::uint8_t>(car.drive.mode_display()),
              rounded(effort(car, now)), rounded(is.position), rounded(is.velocity)};
    case UnitKind::car_position_unit:
      if (car.lost > 0) return {not_available, 0, 0};
      return {rounded(is.position), word(is.velocity), word(is.acceleration)};
    case UnitKind::load_unit: {
      constexpr std::uint32_t kilograms = 2;
      return {rounded(load_of(car)), kilograms, load_signal(car), 0};
    }
    case UnitKind::car_door_unit: {
      const DoorUnit& door = car.doors[what.door];
      constexpr std::uint32_t fixed = 0x3F, detected = 0x40, error = 0x80;
      const std::uint32_t barrier = car.defective > 0 ? error : is_blocked(car, what.door) ? detected : 0U;
      return {door.status_word(), rounded(door.position()), fixed | barrier};
    }
  }
  return {};
}

void Building::show_changes(can::Time now) {
  for (std::size_t unit = 0; unit < units_.size(); ++unit) {
    if (unit < panels_.size()) {
      shown_[unit].alarm = panels_[unit].deadline(now);
    } else if (values_of(unit, now) != shown_[unit].values) {
      shown_[unit].alarm = now;
    }
  }
}

}  // namespace canopus::sim::lift
