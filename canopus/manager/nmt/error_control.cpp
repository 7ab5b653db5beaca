#include "canopus/manager/nmt/error_control.hpp"

namespace canopus::manager {

using canopen::NmtCommand;
using canopen::NmtState;

namespace {

// What a slave reports of itself, as 1F82H shows it: a reserved value is no state.
constexpr std::uint8_t shown_state(std::uint8_t state) noexcept {
  switch (static_cast<NmtState>(state)) {
    case NmtState::stopped:
    case NmtState::operational:
    case NmtState::pre_operational: return state;
    case NmtState::initialising: break;
  }
  return node_state::unknown;
}

}  // namespace

void ErrorControl::heartbeat_received(std::uint8_t node_id, NmtState state, can::Time now) {
  if (node_id == 0 || node_id > 127) return;
  Slave& slave = master_.slaves[node_id];
  if (state == NmtState::initialising) {
    slave.heartbeat_alive = false;  // reset: watched again from its first heartbeat on
    slave.commanded = false;
    return master_.set_state(node_id, node_state::pre_operational, now);
  }
  const bool begins = !slave.heartbeat_alive;
  slave.heartbeat_alive = true;
  slave.heartbeat_lost = false;
  master_.set_error_bits(node_id, error_control::heartbeat_active, 0, now);
  master_.set_state(node_id, shown_state(static_cast<std::uint8_t>(state)), now);
  resolve(node_id, now);
  if (!master_.options.heartbeat_state_is_checked) return;
  if (begins && !slave.commanded) slave.expected_state = static_cast<std::uint8_t>(state);
  if (is_newly_wrong(node_id, static_cast<std::uint8_t>(state), now)) {
    master_.set_error_bits(node_id, error_control::unexpected_state, 0, now);
  }
}

void ErrorControl::heartbeat_lost(std::uint8_t node_id, can::Time now) {
  if (node_id == 0 || node_id > 127) return;
  Slave& slave = master_.slaves[node_id];
  slave.heartbeat_alive = false;
  master_.set_error_bits(node_id, error_control::heartbeat_missing,
                         master_.options.time_out_ends_activity ? error_control::heartbeat_active : 0, now);
  slave.heartbeat_lost = true;
  alarm_ = now;
}

void ErrorControl::forget_lost_heartbeats() noexcept {
  for (Slave& slave : master_.slaves) slave.heartbeat_lost = false;
  alarm_.cancel();
}

void ErrorControl::tick(can::Time now) {
  if (alarm_ > now) return;
  alarm_.cancel();
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (!master_.slaves[n].heartbeat_lost) continue;
    master_.slaves[n].heartbeat_lost = false;
    event(n, ErrorControlEvent::heartbeat_lost, now);
  }
}

void ErrorControl::boot_up(std::uint8_t node_id, can::Time now) {
  Slave& slave = master_.slaves[node_id];
  slave.guarding.boot_up();
  slave.wrong_state = slave.commanded = false;
  slave.expected_state = node_state::pre_operational;
  slave.expected_since = now;
  master_.set_state(node_id, node_state::pre_operational, now);
}

bool ErrorControl::state_message(std::uint8_t node_id, std::uint8_t byte, can::Time now) {
  Slave& slave = master_.slaves[node_id];
  const auto state = static_cast<std::uint8_t>(byte & 0x7F);
  const bool begins = !slave.guarding.alive();
  const NodeGuarding::Answer answer = slave.guarding.answer(byte, now);
  if (!slave.guarding.running()) return true;
  if (!answer.accepted) {
    const bool shown = master_.options.toggle_error_is_shown;
    master_.set_error_bits(node_id, shown ? error_control::toggle_error : error_control::guarding_miss, 0,
                           now);
    return false;
  }
  master_.set_state(node_id, shown_state(state), now);
  if (slave.guarding.alive()) master_.set_error_bits(node_id, error_control::guarding_active, 0, now);
  if (answer.resolved) resolve(node_id, now);
  // The option's other half: a slave that was not commanded is expected in its first state [RJ71CN91 1.8 note 1].
  if (begins && !slave.commanded && master_.options.heartbeat_state_is_checked) slave.expected_state = state;
  check_guarded_state(node_id, state, now);
  return true;
}

// The command itself wins every arbitration, but an answer may have been on its way, and a slave needs its
// time.
bool ErrorControl::is_newly_wrong(std::uint8_t node_id, std::uint8_t state, can::Time now) {
  Slave& slave = master_.slaves[node_id];
  if (slave.expected_state == 0 || slave.expected_state == state) {
    slave.wrong_state = false;
    return false;
  }
  if (slave.wrong_state) return false;
  slave.wrong_state = now >= later(slave.expected_since, master_.options.state_change_grace);
  return slave.wrong_state;
}

void ErrorControl::check_guarded_state(std::uint8_t node_id, std::uint8_t state, can::Time now) {
  if (!is_newly_wrong(node_id, state, now)) return;
  master_.set_error_bits(node_id, error_control::unexpected_state, 0, now);
  event(node_id, ErrorControlEvent::unexpected_state, now);
}

void ErrorControl::event(std::uint8_t node_id, ErrorControlEvent event, can::Time now) {
  master_.slaves[node_id].in_error = true;
  master_.listener->error_control_event(node_id, event, now);
  master_.slave_lost(node_id, now);
}

void ErrorControl::resolve(std::uint8_t node_id, can::Time now) {
  if (!master_.slaves[node_id].in_error) return;
  master_.slaves[node_id].in_error = false;
  master_.listener->error_control_resolved(node_id, now);
}

void ErrorControl::presence_known(std::uint8_t node_id, bool present, can::Time now) {
  const Slave& slave = master_.slaves[node_id];
  if (!present) {
    // An FX3U-CAN shows a node as missing only where it is mandatory and the boot time is limited [FX3U-CAN 6.22].
    const bool is_expected = (master_.assignment(node_id) & assignment_bit::mandatory) != 0 &&
                             master_.dictionary().get<std::uint32_t>(0x1F89, 0) != 0;
    const bool is_shown = is_expected || !master_.options.commands_show_all_nodes;
    if (is_shown && !slave.is_alive()) master_.set_state(node_id, node_state::missing, now);
  } else if (slave.state <= node_state::missing &&
             (master_.assignment(node_id) & assignment_bit::keep_alive) == 0) {
    master_.set_state(node_id, node_state::pre_operational, now);
  }
}

void ErrorControl::commanded(NmtCommand command, std::uint8_t node_id, can::Time now) {
  if (node_id != all_nodes) return show_commanded(command, node_id, now);
  for (std::uint8_t n = 1; n < 128; ++n) {
    // A command to all says nothing of nodes that were never seen, but where a manual has it so.
    const bool is_shown =
        master_.options.commands_show_all_nodes || master_.slaves[n].state > node_state::missing;
    if (n != master_.node.node_id() && is_shown) {
      show_commanded(command, n, now);
    }
  }
}

void ErrorControl::show_commanded(NmtCommand command, std::uint8_t node_id, can::Time now) {
  Slave& slave = master_.slaves[node_id];
  std::uint8_t state = node_state::unknown;
  switch (command) {
    case NmtCommand::start: state = node_state::operational; break;
    case NmtCommand::stop: state = node_state::stopped; break;
    case NmtCommand::enter_pre_operational: state = node_state::pre_operational; break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication: slave.guarding.expect_silence(); break;
  }
  slave.expected_state = state;
  slave.expected_since = now;
  slave.wrong_state = false;
  slave.commanded = state != node_state::unknown;
  if (state == node_state::unknown || !slave.is_alive()) master_.set_state(node_id, state, now);
}

// --- guarding

// Heartbeat has priority: no guarding of a node that 1016H watches [ME3CAN1-Q 4.6.7].
bool ErrorControl::guards(std::uint8_t node_id) const {
  const std::uint32_t bits = master_.assignment(node_id);
  return (bits & assignment_bit::slave) != 0 && guard_time(bits) > can::Duration{} &&
         retry_factor(bits) > 0 && master_.heartbeat_time(node_id) == can::Duration{};
}

void ErrorControl::request_state(std::uint8_t node_id) {
  master_.send(can::remote_frame(canopen::cob_id::error_control + node_id, 1));
}

void ErrorControl::start_guarding(std::uint8_t node_id, can::Time now) {
  if (!guards(node_id)) return;
  const std::uint32_t bits = master_.assignment(node_id);
  master_.slaves[node_id].guarding.start(guard_time(bits), retry_factor(bits),
                                         master_.options.guarding_is_repeated, now);
  master_.set_error_bits(node_id, error_control::guarding_active, 0, now);
  guarding_tick(node_id, now);
}

void ErrorControl::stop_guarding(std::uint8_t node_id, can::Time now) {
  master_.slaves[node_id].guarding.stop();
  master_.set_error_bits(node_id, 0, error_control::guarding_active, now);
}

void ErrorControl::guarding_tick(std::uint8_t node_id, can::Time now) {
  const NodeGuarding::Due due = master_.slaves[node_id].guarding.tick(now);
  if (due.request) request_state(node_id);
  if (due.missed) master_.set_error_bits(node_id, error_control::guarding_miss, 0, now);
  if (due.lost) {
    master_.set_error_bits(node_id, error_control::node_lost,
                           master_.options.time_out_ends_activity ? error_control::guarding_active : 0, now);
    event(node_id, ErrorControlEvent::node_lost, now);
  }
}

// --- all nodes

void ErrorControl::forget(can::Time now) {
  forget_lost_heartbeats();
  for (Slave& slave : master_.slaves) {
    slave.heartbeat_alive = slave.in_error = slave.wrong_state = slave.held = slave.commanded = false;
    slave.expected_state = 0;
  }
  for (std::uint8_t n = 1; n < 128; ++n) {
    master_.slaves[n].guarding.forget();
    master_.set_error_bits(n, 0, 0xFFFF, now);
    master_.set_state(n, node_state::unknown, now);
  }
}

void ErrorControl::clear(std::uint8_t node_id, can::Time now) {
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (node_id == 0 || node_id == n) master_.set_error_bits(n, 0, error_control::errors, now);
  }
}

}  // namespace canopus::manager
