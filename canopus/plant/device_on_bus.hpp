#pragma once
// A simulated device in its place on a bus: what happens to it is passed on, and what changes is reported to
// the plant's observer.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/plant/node_registry.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/sim/device/device.hpp"
#include "canopus/store/parameter_file.hpp"

namespace canopus::plant {

struct DeviceSection;

class DeviceOnBus final : public can::Participant, private canopen::NodeListener, private sim::ForceListener {
 public:
  DeviceOnBus(std::shared_ptr<const eds::DeviceFile> file, const DeviceSection& section, std::uint8_t node_id,
              can::Port& port, PlantObserver& observer);

  sim::Device& device() noexcept { return device_; }
  /// The report of a value that is or was forced.
  [[nodiscard]] ForcedObject forced_object(const canopen::Entry& entry, can::Time until = can::never) const;
  /// The store of what 1010H saves. Call it before power_on().
  void set_store(std::unique_ptr<store::ParameterFile> store);
  /// Makes it an LSS slave with this non-volatile memory (nullptr: volatile). Call it before power_on().
  void enable_lss(std::unique_ptr<store::ParameterFile> store);
  /// `watch` is notified when the node-ID changes.
  void set_watch(NodeRegistry& watch) noexcept { watch_ = &watch; }
  /// A warning about the device in the plant's events.
  void warn(std::string_view sentence, can::Time now);
  NodeStatus& status() noexcept { return status_; }
  const NodeStatus& status() const noexcept { return status_; }

  /// The node that power_on() makes, of the file's values and what was saved.
  struct InitialNode {
    std::uint8_t node_id = 0;  ///< FFH: none
    canopen::ObjectDictionary objects;
  };
  /// Changes nothing. Call it before power_on().
  [[nodiscard]] InitialNode initial_node();

  void power_on(can::Time now);
  /// Its plug is pulled, without supply and off the bus; or in again.
  void unplug();
  void plug_in(can::Time now);
  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& frame, can::Time now) override;
  void controller_changed(can::Time now) override;
  void tick(can::Time now) override;

 private:
  // NodeListener, unless the device is an LSS slave, which does this by itself.
  void reset_requested(canopen::NmtCommand which, can::Time now) override;
  // sim::ForceListener
  void value_forced(const sim::Forcing::Force& force, can::Time now) override;
  void value_released(const canopen::Entry& entry, can::Time now) override;

  void update(can::Time now) {
    const canopen::Node& node = device_.node();
    const bool is_lss_slave = device_.lss() != nullptr;
    if (!is_lss_slave && node.identifiers_revision() == accepted_revision_ && node.state() == status_.state)
      return;
    update_state(now);
  }
  void update_state(can::Time now);
  void update_lss(can::Time now);
  void accept();

  // Members that each tick needs are in the first cache line, and in one of the device.
  std::uint32_t accepted_revision_ = 0;
  bool is_unplugged_ = false;
  NodeStatus status_;
  std::unique_ptr<store::ParameterFile> store_;  // of the device, which it outlives
  std::unique_ptr<store::ParameterFile> lss_store_;
  can::Port& port_;
  can::Time start_;
  std::uint32_t bit_rate_ = 0;
  sim::Device device_;
  std::string name_;
  NodeRegistry* watch_ = nullptr;
  PlantObserver& observer_;
};

}  // namespace canopus::plant
