#pragma once
// NMT slave [CiA 301 7.3.2]. The frame 000H, two bytes: command, node-ID (0 = all nodes).
//
//   Initialisation --boot-up message--> Pre-operational <--80H/01H--> Operational
//                                              ^  |02H                  |02H
//                                           80H|  v                     v
//                                            Stopped  <------------------   (01H: Stopped -> Operational)
//   81H (reset node) and 82H (reset communication) lead from every state back into Initialisation.

#include <optional>

#include "canopus/can/frame.hpp"
#include "canopus/canopen/service/nmt.hpp"

namespace canopus::canopen {

/// The command in an NMT frame if it is for this node: its own node-ID, or all nodes unless it is the active
/// NMT master, which does not obey broadcasts. Frames of another length and unknown commands are nothing.
[[nodiscard]] constexpr std::optional<NmtCommand> nmt_command_for(const can::Frame& frame,
                                                                  std::uint8_t node_id,
                                                                  bool active_master) noexcept {
  if (frame.dlc != 2) return std::nullopt;
  const bool is_addressed = frame.data[1] == node_id || (frame.data[1] == 0 && !active_master);
  if (!is_addressed) return std::nullopt;
  switch (const auto command = static_cast<NmtCommand>(frame.data[0])) {
    case NmtCommand::start:
    case NmtCommand::stop:
    case NmtCommand::enter_pre_operational:
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication: return command;
  }
  return std::nullopt;
}

/// State that a command other than a reset leads to.
[[nodiscard]] constexpr NmtState state_after(NmtCommand command, NmtState state) noexcept {
  switch (command) {
    case NmtCommand::start: return NmtState::operational;
    case NmtCommand::stop: return NmtState::stopped;
    case NmtCommand::enter_pre_operational: return NmtState::pre_operational;
    default: return state;
  }
}

}  // namespace canopus::canopen
