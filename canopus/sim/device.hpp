#pragma once
// A simulated slave: behaves as the CANopen device its EDS or DCF describes, and moves the values it was told
// to move.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/node.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/sim/behaviour.hpp"
#include "canopus/sim/device_lss.hpp"

namespace canopus::sim {

struct DeviceOptions {
  /// How often moving values are looked at while the device is Operational.
  can::Duration sample_interval = std::chrono::milliseconds(10);
  canopen::NodeOptions node{};
};

class Device final : public can::Participant {
 public:
  /// Off until power_on(). `sink` must outlive the device. node_id 1..127, or FFH: none until an LSS master
  /// gives it one.
  Device(std::shared_ptr<const eds::DeviceFile> file, std::uint8_t node_id, can::Sink& sink,
         DeviceOptions options = {});

  /// Lets an object move from now on. Returns what is wrong with it instead, in words for the plant file's
  /// author: no such object, a string, high below low, a period of 0, an echo of another type.
  [[nodiscard]] std::optional<std::string> add_behaviour(const Behaviour& behaviour);

  /// Makes it an LSS slave, whose LSS address is its 1018H and which can be set to the bit rates that its
  /// file names. To be called once, before power_on(). `controller` is the one that `sink` belongs to; its
  /// bit rate now is the one from the shelf. `store`: see DeviceLss.
  void enable_lss(can::Controller& controller, canopen::ParameterStore* store = nullptr);
  /// nullptr: it is no LSS slave.
  [[nodiscard]] const manager::LssSlave* lss() const noexcept { return lss_ ? &lss_->slave() : nullptr; }

  void power_on(can::Time now);
  void power_off();

  /// True when it would do something with a frame of this base identifier (see Node::wants).
  [[nodiscard]] bool wants(std::uint32_t base_identifier) const {
    return node_.wants(base_identifier) || (lss_ && base_identifier == manager::lss::from_master);
  }

  [[nodiscard]] canopen::Node& node() noexcept { return node_; }
  [[nodiscard]] const canopen::Node& node() const noexcept { return node_; }
  [[nodiscard]] const eds::DeviceFile& file() const noexcept { return *file_; }

  /// Sends an emergency, as an error inside the device would. False when the node may not send now.
  bool emergency(std::uint16_t code, std::uint8_t error_register,
                 const std::array<std::uint8_t, 5>& manufacturer, can::Time now);
  /// The error is gone.
  bool emergency_reset(can::Time now);

  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& frame, can::Time now) override;
  void controller_changed(can::Time now) override;
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override;

 private:
  struct Motion {
    Behaviour behaviour;
    canopen::Entry target;
    canopen::Entry source;  // echo
  };
  bool move_values(can::Time now);
  bool echo_values();
  void after_event(can::Time now, bool moved);

  std::shared_ptr<const eds::DeviceFile> file_;
  can::Gate gate_;  // between the node and the sink
  canopen::Node node_;
  std::unique_ptr<DeviceLss> lss_;
  DeviceOptions options_;
  std::vector<Motion> motions_;
  can::Time next_sample_ = can::never;
  bool samples_ = false;  // something else than constants and echoes
  bool is_on_ = false;
};

}  // namespace canopus::sim
