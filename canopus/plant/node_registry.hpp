#pragma once
// NMT states and emergencies of the nodes of a bus, as received on it.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/plant/missing_ack_detector.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::plant {

/// True for a frame of the identifiers that PDOs have by default.
[[nodiscard]] inline bool is_pdo(const can::Frame& frame) {
  return !frame.extended && !frame.remote && frame.identifier >= 0x180 && frame.identifier < 0x580;
}

/// Reports boot-ups, NMT states and emergencies of all nodes of a bus, external ones included.
class NodeRegistry final : public can::BusObserver {
 public:
  /// bit_rate: of the bus, in bit/s.
  NodeRegistry(std::string_view bus, std::uint32_t bit_rate, PlantObserver& observer)
      : bus_(bus), bit_rate_(bit_rate), observer_(observer) {}
  /// Registers a node of the plant on this bus.
  void add_node(NodeStatus& status, const can::Port& port);
  /// The node has this node-ID from now on (FFH: none).
  void renumber(NodeStatus& status, std::uint8_t node_id);
  /// The label of the node with this node-ID (1..127) on the bus.
  [[nodiscard]] NodeLabel label(std::uint8_t node_id) const;
  /// This node if its bit rate is another one than the bus's, else the first such node.
  [[nodiscard]] manager::WrongBitRate wrong_bit_rate(std::uint8_t node_id) const;

  void frame_completed(const can::Frame& frame, can::Time start, can::Time end) override;
  void error_detected(const can::Port& port, can::BusError error, can::Time now) override;
  void errors_reported(std::span<const can::BusErrorReport> reports, can::Time now) override;
  void controller_changed(const can::ControllerReport& report, can::Time now) override;

 private:
  void add_number(NodeStatus& status);
  [[nodiscard]] NodeLabel label_of(const can::Port& port) const;
  [[nodiscard]] bool is_plain_can() const;
  void receive(const can::Frame& frame, can::Time end);
  void error_control(std::uint8_t node_id, std::uint8_t state, can::Time now);
  void emergency(std::uint8_t node_id, const can::Frame& frame, can::Time now);

  std::string_view bus_;
  std::uint32_t bit_rate_;
  PlantObserver& observer_;
  struct Occupant {
    const NodeStatus* status;
    const can::Port* port;
  };
  std::vector<Occupant> occupants_;
  MissingAckDetector unacknowledged_;
  std::vector<can::BusErrorReport> last_errors_;
  std::array<NodeStatus*, 128> known_{};
  std::array<std::uint8_t, 128> foreign_states_{};
};

}  // namespace canopus::plant
