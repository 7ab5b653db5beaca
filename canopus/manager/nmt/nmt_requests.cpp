#include "canopus/manager/nmt/nmt_requests.hpp"

#include "canopus/can/little_endian.hpp"
#include "canopus/manager/nmt/nmt_command_queue.hpp"

namespace canopus::manager {

using canopen::AbortCode;
using canopen::NmtCommand;

namespace {

/// Sub-index of 1F82H and 1F83H for all nodes.
constexpr std::uint8_t all = 0x80;

// 04H..07H, 7FH; the same with bit 7 (8FH for 7FH) leave the own node out.
constexpr bool excludes_master(std::uint8_t value) noexcept { return (value & 0x80) != 0; }

constexpr bool is_request(std::uint8_t value) noexcept {
  switch (value) {
    case 0x04:
    case 0x05:
    case 0x06:
    case 0x07:
    case 0x7F:
    case 0x84:
    case 0x85:
    case 0x86:
    case 0x87:
    case 0x8F: return true;
    default: return false;
  }
}

constexpr NmtCommand command_of(std::uint8_t value) noexcept {
  switch (value & 0x0F) {
    case 0x04: return NmtCommand::stop;
    case 0x05: return NmtCommand::start;
    case 0x06: return NmtCommand::reset_node;
    case 0x07: return NmtCommand::reset_communication;
    default: return NmtCommand::enter_pre_operational;
  }
}

}  // namespace

NmtRequests::NmtRequests(MasterContext& master, StartUp& start_up, ErrorControl& error_control)
    : master_(master), start_up_(start_up), error_control_(error_control) {
  master.node.attach(0x1F80, 0x1F83, *this);
  master.node.attach(0x1F90, 0x1F90, *this);
}

AbortCode NmtRequests::request_nmt(std::uint8_t node_id, std::uint8_t value, can::Time now) {
  const AbortCode refusal = check_nmt(node_id, value);
  if (refusal == AbortCode::none) perform_nmt(node_id, value, now);
  return refusal;
}

AbortCode NmtRequests::request_guarding(std::uint8_t node_id, std::uint8_t value, can::Time now) {
  const AbortCode refusal = check_guarding(node_id, value);
  if (refusal == AbortCode::none) perform_guarding(node_id, value, now);
  return refusal;
}

std::uint8_t NmtRequests::node_state(std::uint8_t node_id) const noexcept {
  if (node_id >= master_.slaves.size()) return node_state::unknown;
  if (node_id != master_.node.node_id()) return master_.slaves[node_id].state;
  const canopen::NmtState own = master_.node.state();
  return own == canopen::NmtState::initialising ? node_state::reset_communication
                                                : static_cast<std::uint8_t>(own);
}

AbortCode NmtRequests::check_nmt(std::uint8_t node_id, std::uint8_t value) const noexcept {
  if (node_id == 0 || node_id > all) return AbortCode::no_sub_index;
  const bool may = start_up_.active() ||
                   (master_.options.slaves_request_nmt && start_up_.phase() == StartUp::Phase::slave);
  if (!may) return master_.options.not_master;
  return is_request(value) ? AbortCode::none : AbortCode::invalid_value;
}

// Nothing is expected of the nodes: they are the active master's.
void NmtRequests::perform_nmt_as_slave(std::uint8_t node_id, NmtCommand command, can::Time now) {
  const std::uint8_t own = master_.node.node_id();
  if (node_id != own) {
    const std::uint8_t target = node_id == all ? all_nodes : node_id;
    master_.send(can::data_frame(canopen::cob_id::nmt, {static_cast<std::uint8_t>(command), target}));
  }
  if (node_id == own || node_id == all) start_up_.command_own_node(command, now);
}

void NmtRequests::perform_nmt(std::uint8_t node_id, std::uint8_t value, can::Time now) {
  const NmtCommand command = command_of(value);
  if (!start_up_.active()) return perform_nmt_as_slave(node_id, command, now);
  // What was stopped by hand stays so; any other command gives it back to the start-up [ME3CAN1-Q 4.8.8].
  const bool hold = command == NmtCommand::stop || command == NmtCommand::enter_pre_operational;
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (node_id == all || node_id == n) master_.slaves[n].held = hold && master_.assignment(n) != 0;
  }
  const std::uint8_t own = master_.node.node_id();
  if (node_id != own) {
    const std::uint8_t target = node_id == all ? all_nodes : node_id;
    master_.commands().withdraw_starts(target);
    master_.send_nmt(command, target, now);
  }
  if ((node_id == own || node_id == all) && !excludes_master(value)) {
    start_up_.command_own_node(command, now);
  }
}

AbortCode NmtRequests::check_guarding(std::uint8_t node_id, std::uint8_t value) const noexcept {
  if (node_id == 0 || node_id > all) return AbortCode::no_sub_index;
  if (!start_up_.active()) return master_.options.not_master;
  return value <= 1 ? AbortCode::none : AbortCode::invalid_value;
}

void NmtRequests::perform_guarding(std::uint8_t node_id, std::uint8_t value, can::Time now) {
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (node_id != all && node_id != n) continue;
    if (value == 0) {
      error_control_.stop_guarding(n, now);
    } else if (!master_.slaves[n].guarding.running()) {
      error_control_.start_guarding(n, now);
    }
  }
}

AbortCode NmtRequests::before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                   can::Time) {
  if (entry.sub == 0 || entry.sub > 127) return AbortCode::none;
  if (entry.index == 0x1F82) dictionary.set(entry, node_state(entry.sub));
  if (entry.index == 0x1F83) {
    dictionary.set<std::uint8_t>(entry, master_.slaves[entry.sub].guarding.running() ? 1 : 0);
  }
  return AbortCode::none;
}

AbortCode NmtRequests::before_write(canopen::ObjectDictionary&, const canopen::Entry& entry,
                                    std::span<const std::uint8_t> value, can::Time) {
  const std::uint32_t number = can::load_u32(value);
  const auto byte = static_cast<std::uint8_t>(number);
  const auto valid_if = [](bool valid) { return valid ? AbortCode::none : AbortCode::invalid_value; };
  switch (entry.index) {
    case 0x1F80: return valid_if((number & ~master_.options.start_up_bits) == 0);
    case 0x1F81: return valid_if(entry.sub == 0 || (byte & ~master_.options.assignment_bits) == 0);
    case 0x1F82: return check_nmt(entry.sub, byte);
    case 0x1F83: return check_guarding(entry.sub, byte);
    case 0x1F90: return valid_if(entry.sub != 3 || number <= 2);  // level: 0 high, 1 medium, 2 low
    default: return AbortCode::none;
  }
}

void NmtRequests::after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                              can::Time now) {
  switch (entry.index) {
    case 0x1F81:
      // A slave that needs no boot is guarded from now on; others at the proper step of their boot.
      if (start_up_.has_begun_boots() && !master_.slaves[entry.sub & 0x7F].is_booting()) {
        perform_guarding(entry.sub, 0, now);
        if (master_.options.boot_bit_is_for_recovery && entry.sub != 0)
          return start_up_.slave_assigned(entry.sub & 0x7F, now);
        perform_guarding(entry.sub, 1, now);
      }
      return;
    case 0x1F82: return perform_nmt(entry.sub, dictionary.get<std::uint8_t>(entry), now);
    case 0x1F83: return perform_guarding(entry.sub, dictionary.get<std::uint8_t>(entry), now);
    default: return;
  }
}

}  // namespace canopus::manager
