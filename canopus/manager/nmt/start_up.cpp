#include "canopus/manager/nmt/start_up.hpp"

#include <algorithm>
#include <memory>

namespace canopus::manager {

using canopen::NmtCommand;
using canopen::NmtState;

bool StartUp::may_boot() const { return has_begun_boots() && master_.node.state() != NmtState::stopped; }

bool StartUp::waits_for_own_start() const noexcept {
  const bool is_that_far =
      phase_ == Phase::wait_operational || phase_ == Phase::wait_start_all || phase_ == Phase::running;
  return is_that_far && master_.node.state() != NmtState::operational;
}

void StartUp::request_begin(can::Time now) {
  begin_pending_ = true;
  alarm_.set(now);
}

void StartUp::own_state_changed(can::Time now) {
  own_state_changed_ = true;
  alarm_.set(now);
}

void StartUp::command_own_node(NmtCommand command, can::Time now) {
  own_command_ = static_cast<std::uint8_t>(command);
  alarm_.set(now);
}

void StartUp::obey(can::Time now) {
  alarm_.cancel();
  if (own_command_ != 0) {
    const auto command = static_cast<NmtCommand>(own_command_);
    own_command_ = 0;
    master_.node.command(command, now);
  }
  if (begin_pending_) begin(now);
  if (own_state_changed_) {
    own_state_changed_ = false;
    if (phase_ == Phase::wait_operational && master_.node.state() == NmtState::operational) {
      own_node_is_operational(now);
    }
  }
}

void StartUp::boot_assigned(can::Time now) {
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (!assigned_.test(n) || !master_.listener->sdo_channel_free(n)) continue;
    assigned_.reset(n);
    if (may_boot() && (master_.assignment(n) & assignment_bit::slave) != 0) start_boot(n, false, now);
  }
  assigned_due_ = assigned_.any() ? later(now, master_.options.busy_retry) : can::never;
}

void StartUp::tick(can::Time now) {
  if (assigned_due_ <= now) boot_assigned(now);
  if (boot_end_ <= now) boot_time_elapsed(now);
  if (search_.alarm() <= now) search_.tick(now);
  if (phase_end_ > now) return;
  phase_end_.cancel();
  switch (phase_) {
    case Phase::settling: return become_operational(now);
    case Phase::wait_start_all: return own_node_is_operational(now);
    default: return;
  }
}

// Steps 1 and 2.
void StartUp::begin(can::Time now) {
  begin_pending_ = false;
  bits_ = master_.dictionary().get<std::uint32_t>(0x1F80, 0);
  if ((bits_ & start_up_bit::nmt_master) == 0) {
    phase_ = Phase::slave;
    return;
  }
  if (!active() && (bits_ & start_up_bit::flying_master) != 0) {
    phase_ = Phase::slave;
    return master_.begin_flying(now);
  }
  start_network(network_was_reset_, now);
}

// Steps 3 to 5.
void StartUp::start_network(bool network_was_reset, can::Time now) {
  network_was_reset_ = network_was_reset;
  const bool was_active = active();
  enter(Phase::booting);
  if (!was_active) {
    show_active(true, now);
    if (phase_ != Phase::booting) return;
  }
  show_starting(now);
  reset_network(now);
  if (phase_ != Phase::booting) return;
  resets_took_time_ = master_.commands().start_up_waits();
  if (resets_took_time_) return enter(Phase::resetting);
  boot_all(now);
}

// Step 4. Nodes that are to be kept alive must not get a reset, so then each of the others is reset singly.
void StartUp::reset_network(can::Time now) {
  reset_time_ = now;
  all_were_reset_ = true;
  if (network_was_reset_) {
    network_was_reset_ = false;
    return;
  }
  constexpr std::uint32_t kept = assignment_bit::slave | assignment_bit::keep_alive;
  bool keep_any = false;
  for (std::uint8_t n = 1; n < 128; ++n) keep_any = keep_any || (master_.assignment(n) & kept) == kept;
  if (!keep_any) {
    return master_.commands().push_of_start_up(NmtCommand::reset_communication, all_nodes, now);
  }
  all_were_reset_ = false;
  for (std::uint8_t n = 1; n < 128; ++n) {
    const std::uint32_t bits = master_.assignment(n);
    const bool is_meant = !master_.options.resets_slaves_alone || (bits & assignment_bit::slave) != 0;
    if (n != master_.node.node_id() && is_meant && (bits & kept) != kept) {
      master_.commands().push_of_start_up(NmtCommand::reset_communication, n, now);
    }
  }
}

void StartUp::command_sent(can::Time now) {
  if (!master_.options.delay_before_each_command || master_.commands().start_up_waits()) return;
  if (phase_ == Phase::resetting) {
    enter(Phase::booting);
    boot_all(now);
  }
  show_starting(now);
}

// Step 5.
void StartUp::boot_all(can::Time now) {
  const auto boot_time = std::chrono::milliseconds(master_.dictionary().get<std::uint32_t>(0x1F89, 0));
  boot_end_ = boot_time.count() > 0 ? later(now, boot_time) : can::never;
  bool any = false;
  for (std::uint8_t n = 1; n < 128; ++n) {
    if ((master_.assignment(n) & assignment_bit::slave) == 0) continue;
    any = true;
    start_boot(n, awaits_boot_up(n), now);
    if (phase_ != Phase::booting) return;
  }
  if (any) {
    mandatory_done(now);  // none may be mandatory
  } else {
    enter(Phase::settling, later(reset_time_, master_.options.start_all_delay));
  }
}

// A slave that was reset some time ago may have sent it already.
bool StartUp::awaits_boot_up(std::uint8_t node_id) const {
  const bool kept_alive = (master_.assignment(node_id) & assignment_bit::keep_alive) != 0;
  return (all_were_reset_ || !kept_alive) && (!resets_took_time_ || master_.slaves[node_id].boot_up_due);
}

BootSlave& StartUp::boot_of(std::uint8_t node_id) {
  auto& boot = master_.slaves[node_id].boot;
  if (!boot) {
    boot = std::make_unique<BootSlave>(node_id, master_, *sink_);
    master_.alarms[node_id].add_part(boot->alarm());
  }
  return *boot;
}

void StartUp::start_boot(std::uint8_t node_id, bool after_reset, can::Time now) {
  BootSlave& boot = boot_of(node_id);
  Slave& slave = master_.slaves[node_id];
  if (!slave.boot_counted) {
    slave.boot_counted = true;
    ++running_boots_;
  }
  slave.wrong_state = false;
  master_.commands().withdraw_starts(node_id);
  boot.start(after_reset, now);
  show_starting(now);
}

void StartUp::boot_ended(std::uint8_t node_id, BootError error, can::Time now) {
  Slave& slave = master_.slaves[node_id];
  if (slave.boot_counted) {
    slave.boot_counted = false;
    --running_boots_;
  }
  const std::uint32_t bits = master_.assignment(node_id);
  if (!is_success(error)) {
    master_.set_error_bits(node_id, error_control::start_up_failed, 0, now);
    master_.listener->slave_failed(node_id, error, now);
    if (phase_ == Phase::booting && !giving_up_ && (bits & assignment_bit::mandatory) != 0) {
      halt_for(node_id, error, now);
    }
    return show_starting(now);
  }
  slave.in_error = false;
  master_.listener->slave_booted(node_id, now);
  if (error == BootError::already_operational) {
    slave.expected_state = node_state::operational;
    if (!slave.is_alive()) master_.set_state(node_id, node_state::operational, now);
  } else if (((bits & assignment_bit::boot_slave) != 0 || master_.options.boot_bit_is_for_recovery) &&
             !slave.held && (bits_ & start_up_bit::do_not_start_slaves) == 0 &&
             ((bits_ & start_up_bit::start_all_nodes) == 0 || phase_ == Phase::running)) {
    master_.commands().push_of_start_up(NmtCommand::start, node_id, now);
  }
  if (phase_ == Phase::booting) mandatory_done(now);
  show_starting(now);
}

bool StartUp::all_booted(std::uint32_t assignment_bits) const {
  for (std::uint8_t n = 1; n < 128; ++n) {
    if ((master_.assignment(n) & assignment_bits) != assignment_bits) continue;
    if (!master_.slaves[n].is_booted()) return false;
  }
  return true;
}

// Step 6, checked after each slave.
void StartUp::mandatory_done(can::Time now) {
  if (phase_ != Phase::booting) return;
  if (!all_booted(assignment_bit::slave | assignment_bit::mandatory)) return;
  boot_end_.cancel();
  become_operational(now);
}

void StartUp::boot_time_elapsed(can::Time now) {
  boot_end_.cancel();
  if (!search_.begin(now)) fail(now);
}

void StartUp::fail(can::Time now) {
  constexpr std::uint32_t needed = assignment_bit::slave | assignment_bit::mandatory;
  // Every missing slave is to have its result before the first of them ends the start-up.
  std::uint8_t first = 0;
  giving_up_ = true;
  const Phase phase = phase_;
  for (std::uint8_t n = 1; n < 128 && phase_ == phase; ++n) {
    const Slave& slave = master_.slaves[n];
    if ((master_.assignment(n) & needed) != needed || !slave.boot || slave.boot->booted()) continue;
    if (first == 0) first = n;
    slave.boot->give_up(now);
  }
  giving_up_ = false;
  if (phase_ != phase || first == 0) return;
  const BootError error = master_.slaves[first].boot->record().error;
  halt_for(first, error, now);
}

// Step 7.
void StartUp::become_operational(can::Time now) {
  enter(Phase::wait_operational);
  if ((bits_ & start_up_bit::wait_for_application) == 0) master_.node.command(NmtCommand::start, now);
  if (phase_ == Phase::wait_operational && master_.node.state() == NmtState::operational) {
    own_node_is_operational(now);
  }
}

// Step 8.
void StartUp::own_node_is_operational(can::Time now) {
  constexpr std::uint32_t rule = start_up_bit::start_all_nodes | start_up_bit::do_not_start_slaves;
  if ((bits_ & rule) == start_up_bit::start_all_nodes) {
    const can::Time earliest =
        std::max(later(reset_time_, master_.options.start_all_delay), master_.commands().start_up_due());
    if (earliest > now) return enter(Phase::wait_start_all, earliest);
    return start_slaves(now);
  }
  enter(Phase::running);
  finish(now);
}

// One command for all, unless a slave must not be started or is not ready: then each one singly.
void StartUp::start_slaves(can::Time now) {
  enter(Phase::running);
  const bool none_held = std::ranges::none_of(master_.slaves, &Slave::held);
  if (none_held && all_booted(assignment_bit::slave)) {
    master_.commands().push_of_start_up(NmtCommand::start, all_nodes, now);
  } else {
    const std::uint32_t startable =
        assignment_bit::slave |
        (master_.options.boot_bit_is_for_recovery ? 0U : std::uint32_t{assignment_bit::boot_slave});
    for (std::uint8_t n = 1; n < 128; ++n) {
      const Slave& slave = master_.slaves[n];
      if ((master_.assignment(n) & startable) == startable && slave.is_booted() && !slave.held &&
          slave.boot->record().error != BootError::already_operational) {
        master_.commands().push_of_start_up(NmtCommand::start, n, now);
      }
    }
  }
  finish(now);
}

void StartUp::finish(can::Time now) {
  master_.listener->start_up_finished(now);
  show_starting(now);
}

void StartUp::enter(Phase phase, can::Time until) {
  phase_ = phase;
  phase_end_ = until;
}

void StartUp::halt(can::Time now) {
  boot_end_.cancel();
  enter(Phase::halted);
  master_.commands().withdraw_starts(all_nodes);
  abandon_boots();
  show_starting(now);
}

void StartUp::halt_for(std::uint8_t node_id, BootError error, can::Time now) {
  for (std::uint8_t n = 1; n < 128; ++n) {
    const Slave& slave = master_.slaves[n];
    if (n != node_id && (slave.is_booting() || slave.is_booted())) slave.boot->start_up_halted_by(node_id);
  }
  halt(now);
  master_.listener->start_up_halted(node_id, error, now);
}

// --- slaves that come and go

void StartUp::reset_sent(std::uint8_t node_id, can::Time now) {
  if (node_id == all_nodes || phase_ == Phase::booting) reset_time_ = now;
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (node_id != all_nodes && node_id != n) continue;
    Slave& slave = master_.slaves[n];
    slave.boot_up_due = true;
    slave.reset_since = now;
    if (slave.boot) slave.boot->was_reset();
  }
}

bool StartUp::is_late_boot_up(std::uint8_t node_id, can::Time now) {
  Slave& slave = master_.slaves[node_id];
  const bool due = slave.boot_up_due && now < later(slave.reset_since, master_.options.late_boot_up);
  slave.boot_up_due = false;
  return due && (slave.is_booting() || slave.is_booted()) && slave.boot->answered();
}

void StartUp::boot_up(std::uint8_t node_id, can::Time now) {
  if ((master_.assignment(node_id) & assignment_bit::slave) == 0 || !may_boot()) return;
  if (is_unmanaged(node_id)) return;
  const Slave& slave = master_.slaves[node_id];
  if (slave.is_booting()) {
    slave.boot->boot_up(now);
  } else {
    start_boot(node_id, false, now);
  }
}

void StartUp::state_seen(std::uint8_t node_id, NmtState state, can::Time now) {
  const Slave& slave = master_.slaves[node_id];
  if (slave.boot && phase_ != Phase::searching) slave.boot->state_seen(state, now);
}

// [ME3CAN1-Q 4.8.7]
void StartUp::slave_lost(std::uint8_t node_id, can::Time now) {
  const std::uint32_t bits = master_.assignment(node_id);
  if ((bits & assignment_bit::slave) == 0 || !may_boot() || begin_pending_) return;
  if (is_unmanaged(node_id)) return;
  if (master_.slaves[node_id].is_booting()) return;  // it is being brought back already
  if ((bits & assignment_bit::mandatory) != 0) {
    if ((bits_ & start_up_bit::stop_all_nodes) != 0) {
      master_.send_nmt(NmtCommand::stop, all_nodes, now);
      halt(now);
      return command_own_node(NmtCommand::stop, now);
    }
    if ((bits_ & start_up_bit::reset_all_nodes) != 0) {
      abandon_boots();
      master_.commands().withdraw_starts(all_nodes);
      master_.send_nmt(NmtCommand::reset_communication, all_nodes, now);
      network_was_reset_ = true;
      // The own node must not be Operational before the mandatory slaves are booted again.
      if (master_.node.state() == NmtState::operational) {
        command_own_node(NmtCommand::enter_pre_operational, now);
      }
      return request_begin(now);
    }
  }
  master_.send_nmt(master_.options.error_reset, node_id, now);
  start_boot(node_id, true, now);
}

// --- giving up

void StartUp::abandon_boots() {
  for (Slave& slave : master_.slaves) {
    if (slave.is_booting()) slave.boot->abandon();
    slave.boot_counted = false;
  }
  running_boots_ = 0;
}

void StartUp::withdraw(can::Time now) {
  search_.abandon(now);
  abandon_boots();
  boot_end_.cancel();
  begin_pending_ = network_was_reset_ = false;
}

void StartUp::forget() noexcept {
  for (can::Alarm* alarm : {&phase_end_, &boot_end_, &assigned_due_, &alarm_}) alarm->cancel();
  begin_pending_ = network_was_reset_ = own_state_changed_ = false;
  own_command_ = 0;
  assigned_.reset();
}

void StartUp::show_active(bool active, can::Time now) {
  master_.node.set_active_master(active, now);
  master_.listener->active_changed(active, now);
}

void StartUp::show_starting(can::Time now) {
  if (starting() == was_starting_) return;
  was_starting_ = !was_starting_;
  master_.listener->starting_changed(was_starting_, now);
}

}  // namespace canopus::manager
