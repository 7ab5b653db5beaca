#pragma once
// A lift, or group of lifts, in its plant: its building on the timeline, its devices on their seats.

#include <memory>
#include <string_view>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/file/lift_section.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/sim/lift/building.hpp"

namespace canopus::plant {

class LiftOnBus final : private sim::lift::LiftDevices, private sim::lift::LiftObserver {
 public:
  /// Everything must outlive it.
  LiftOnBus(const LiftSection& section, sim::lift::BuildingSettings settings, can::Timeline& timeline,
            PlantObserver& observer);

  [[nodiscard]] std::string_view bus() const { return section_->bus; }
  [[nodiscard]] const sim::lift::Building& building() const { return building_; }
  [[nodiscard]] std::shared_ptr<const eds::DeviceFile> device_file(std::size_t unit) const {
    return sim::lift::device_file(building_.units()[unit]);
  }
  /// Adds the device of the next unit. Call it for all units before power_on().
  void add_unit(DeviceOnBus& seat);
  /// An additional observer of all events; it must outlive the plant's run.
  void set_listener(sim::lift::LiftObserver* listener) noexcept { listener_ = listener; }

 private:
  void unit_plugged(std::size_t unit, bool plugged, can::Time now) override;
  void lift_event(const sim::lift::LiftEvent& event) override;
  void car_moved(std::uint8_t lift, double position, double door, can::Time now) override;

  const LiftSection* section_;
  PlantObserver* observer_;
  sim::lift::LiftObserver* listener_ = nullptr;
  sim::lift::Building building_;
  std::vector<DeviceOnBus*> units_;
};

}  // namespace canopus::plant
