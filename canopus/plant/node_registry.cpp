#include "canopus/plant/node_registry.hpp"

#include <algorithm>
#include <tuple>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/plant/event.hpp"

namespace canopus::plant {

void NodeRegistry::add_node(NodeStatus& status, const can::Port& port) {
  occupants_.push_back({&status, &port});
  add_number(status);
}

void NodeRegistry::renumber(NodeStatus& status, std::uint8_t node_id) {
  std::ranges::replace(known_, &status, static_cast<NodeStatus*>(nullptr));
  status.label.node_id = node_id;
  add_number(status);
}

NodeLabel NodeRegistry::label(std::uint8_t node_id) const {
  NodeLabel label = known_[node_id] != nullptr ? known_[node_id]->label : NodeLabel{bus_, {}, node_id};
  label.node_id = node_id;  // a module has another one until its initialization is over
  return label;
}

manager::WrongBitRate NodeRegistry::wrong_bit_rate(std::uint8_t node_id) const {
  manager::WrongBitRate wrong;
  for (const auto& [status, port] : occupants_) {
    if (!status->is_on || port->bit_rate() == bit_rate_) continue;
    const bool is_it = status->label.node_id == node_id;
    if (is_it || wrong.node_id == 0) wrong = {status->label.node_id, port->bit_rate(), bit_rate_};
    if (is_it) break;
  }
  return wrong;
}

void NodeRegistry::frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) {
  unacknowledged_.frame_completed();
  last_errors_.clear();
  const std::uint32_t function = frame.identifier & 0x780;
  if (function == canopen::cob_id::error_control || function == canopen::cob_id::emcy) receive(frame, end);
}

/// Handles a frame with an identifier of error control or EMCY.
void NodeRegistry::receive(const can::Frame& frame, can::Time end) {
  const bool is_of_emcy = (frame.identifier & 0x780) == canopen::cob_id::emcy;
  const auto node_id = static_cast<std::uint8_t>(frame.identifier & 0x7F);
  if (frame.extended || frame.remote || node_id == 0 || is_plain_can()) return;
  if (!is_of_emcy && frame.dlc == 1) {
    error_control(node_id, static_cast<std::uint8_t>(frame.data[0] & 0x7F), end);
  } else if (is_of_emcy && frame.dlc == 8) {
    emergency(node_id, frame, end);
  }
}

void NodeRegistry::error_detected(const can::Port& port, can::BusError error, can::Time now) {
  if (!unacknowledged_.error_detected(port, error)) return;
  observer_.on({now, MissingAck{label_of(port)}});
}

NodeLabel NodeRegistry::label_of(const can::Port& port) const {
  const auto occupant = std::ranges::find(occupants_, &port, &Occupant::port);
  if (occupant != occupants_.end()) return occupant->status->label;
  return {bus_, port.name(), 0};  // a client
}

void NodeRegistry::errors_reported(std::span<const can::BusErrorReport> reports, can::Time now) {
  // A node that is alone finds one and the same error thousands of times a second.
  if (std::ranges::equal(reports, last_errors_)) return;
  last_errors_.assign(reports.begin(), reports.end());
  const auto place = [](const can::BusErrorReport& report) {
    return std::tuple(report.error, report.field, report.bit);
  };
  for (auto first = reports.begin(); first != reports.end(); ++first) {
    const auto is_same = [&](const can::BusErrorReport& report) { return place(report) == place(*first); };
    if (std::any_of(reports.begin(), first, is_same)) continue;
    BusErrorEvent event{.bus = bus_, .error = first->error, .field = first->field, .bit = first->bit};
    for (const can::BusErrorReport& report : reports) {
      if (is_same(report)) event.nodes.push_back({label_of(*report.port), report});
    }
    observer_.on({now, std::move(event)});
  }
}

void NodeRegistry::controller_changed(const can::ControllerReport& report, can::Time now) {
  observer_.on({now, ControllerChange{label_of(*report.port), report}});
}

void NodeRegistry::add_number(NodeStatus& status) {
  const std::uint8_t node_id = status.label.node_id;
  if (node_id >= 1 && node_id <= 127) known_[node_id] = &status;
}

/// All nodes of the plant are in a Layer 2 mode: identifiers have no CANopen meaning.
bool NodeRegistry::is_plain_can() const {
  return !occupants_.empty() && std::ranges::none_of(occupants_, [](const Occupant& occupant) {
    return occupant.status->layer2 == module::Layer2State::inactive;
  });
}

void NodeRegistry::error_control(std::uint8_t node_id, std::uint8_t state, can::Time now) {
  if (state == 0) observer_.on({now, BootUp{label(node_id)}});
  if (known_[node_id] != nullptr || foreign_states_[node_id] == state) return;
  foreign_states_[node_id] = state;
  if (state != 0) observer_.on({now, NmtStateChange{label(node_id), static_cast<canopen::NmtState>(state)}});
}

void NodeRegistry::emergency(std::uint8_t node_id, const can::Frame& frame, can::Time now) {
  canopen::Emergency message{.node_id = node_id};
  message.code = can::load_as<std::uint16_t>(&frame.data[0]);
  message.error_register = frame.data[2];
  std::copy_n(frame.data.begin() + 3, 5, message.manufacturer.begin());
  if (NodeStatus* status = known_[node_id]) {
    ++status->emergencies;
    status->last_emergency = message.code;
  }
  observer_.on({now, EmergencySent{label(node_id), message}});
}

}  // namespace canopus::plant
