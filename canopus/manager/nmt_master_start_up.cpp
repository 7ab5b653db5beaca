// The start-up of the network [CiA 302-2; ME3CAN1-Q 4.8.5, 4.8.6; notes B7].

#include "canopus/manager/nmt_master_engine.hpp"

namespace canopus::manager {

using canopen::NmtCommand;
using canopen::NmtState;

namespace {

constexpr std::uint8_t all_nodes = 0;

}  // namespace

NmtMaster::Engine::Engine(canopen::Node& node, can::Sink& sink, MasterOptions options)
    : options_(options),
      listener_(nullptr),
      requests_(static_cast<can::Sink&>(*this), *this),
      node_(&node),
      wire_(sink),
      flying_(static_cast<can::Sink&>(*this), *this),
      search_(wire_, *this) {
  static class : public MasterListener {
  } nobody;
  listener_ = &nobody;
  node.dictionary().attach(0x1F80, 0x1F83, *this);
  node.dictionary().attach(0x1F90, 0x1F90, *this);
}

void NmtMaster::Engine::start(can::Time now) {
  stop(now);
  begin_pending_ = true;
  wake(now);
}

void NmtMaster::Engine::stop(can::Time now) {
  const bool was_active = active();
  abandon_search(now);
  muted_ = true;
  abandon_boots();
  muted_ = false;
  line_.clear();
  kept_.clear();
  flying_.stop();
  standby_entry_ = 0;
  phase_ = Phase::off;
  muted_ = true;
  requests_.cancel(0, canopen::AbortCode::device_state, now);
  muted_ = false;
  phase_end_ = boot_end_ = can::never;
  begin_pending_ = network_was_reset_ = own_state_changed_ = false;
  own_command_ = 0;
  first_command_ = command_count_ = 0;
  heartbeat_alive_.reset();
  heartbeat_lost_pending_.reset();
  in_error_.reset();
  wrong_state_.reset();
  held_.reset();
  expected_state_.fill(0);
  for (std::uint8_t n = 1; n < 128; ++n) {
    guarding_[n].forget();
    set_flags(n, 0, 0xFFFF, now);
    set_state(n, node_state::unknown, now);
    refresh(n);
  }
  timers_.set(0, can::never);
  if (was_active) {
    node_->set_active_master(false, now);
    listener_->active_changed(false, now);
  }
  tell_starting(now);
}

// Steps 1 and 2.
void NmtMaster::Engine::begin(can::Time now) {
  begin_pending_ = false;
  start_up_ = node_->dictionary().get<std::uint32_t>(0x1F80, 0);
  if ((start_up_ & start_up_bit::nmt_master) == 0) {
    phase_ = Phase::slave;
    return;
  }
  if (!active() && (start_up_ & start_up_bit::flying_master) != 0) return begin_flying(now);
  start_network(now);
}

// Steps 3 to 5, as the active master.
void NmtMaster::Engine::start_network(can::Time now) {
  const bool was_active = active();
  enter(Phase::booting, now);
  if (!was_active) {
    node_->set_active_master(true, now);
    listener_->active_changed(true, now);
    if (phase_ != Phase::booting) return;
  }
  tell_starting(now);
  boot_all(reset_network(now), now);
}

// Nodes that want to be kept alive must not hear a reset, so then everybody else is reset singly.
bool NmtMaster::Engine::reset_network(can::Time now) {
  reset_time_ = now;
  if (network_was_reset_) {
    network_was_reset_ = false;
    return true;
  }
  constexpr std::uint32_t kept = assignment_bit::slave | assignment_bit::keep_alive;
  bool keep_any = false;
  for (std::uint8_t n = 1; n < 128; ++n) keep_any = keep_any || (assignment(n) & kept) == kept;
  if (!keep_any) {
    send_nmt(NmtCommand::reset_communication, all_nodes, now);
    return true;
  }
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (n != node_->node_id() && (assignment(n) & kept) != kept) {
      send_nmt(NmtCommand::reset_communication, n, now);
    }
  }
  return false;
}

void NmtMaster::Engine::boot_all(bool all_were_reset, can::Time now) {
  const auto boot_time = std::chrono::milliseconds(node_->dictionary().get<std::uint32_t>(0x1F89, 0));
  boot_end_ = boot_time.count() > 0 ? later(now, boot_time) : can::never;
  bool any = false;
  for (std::uint8_t n = 1; n < 128; ++n) {
    if ((assignment(n) & assignment_bit::slave) == 0) continue;
    any = true;
    const bool kept_alive = (assignment(n) & assignment_bit::keep_alive) != 0;
    start_boot(n, all_were_reset || !kept_alive, now);
    if (phase_ != Phase::booting) return;
  }
  if (any) {
    mandatory_done(now);  // none may be mandatory
  } else {
    enter(Phase::settling, now, later(reset_time_, options_.start_all_delay));
  }
}

void NmtMaster::Engine::start_boot(std::uint8_t node_id, bool after_reset, can::Time now) {
  auto& boot = boots_[node_id];
  if (!boot) boot = std::make_unique<BootSlave>(node_id, *this, static_cast<can::Sink&>(*this));
  if (!boot_counted_[node_id]) {
    boot_counted_[node_id] = true;
    ++running_boots_;
  }
  wrong_state_[node_id] = false;
  boot->start(after_reset, now);
  refresh(node_id);
  tell_starting(now);
}

void NmtMaster::Engine::presence_known(std::uint8_t node_id, bool present, can::Time now) {
  if (!present) {
    if (!heard(node_id)) set_state(node_id, node_state::missing, now);
  } else if (state_[node_id] <= node_state::missing &&
             (assignment(node_id) & assignment_bit::keep_alive) == 0) {
    set_state(node_id, node_state::pre_operational, now);
  }
}

void NmtMaster::Engine::boot_ended(std::uint8_t node_id, BootError error, can::Time now) {
  if (boot_counted_[node_id]) {
    boot_counted_[node_id] = false;
    --running_boots_;
  }
  const std::uint32_t bits = assignment(node_id);
  if (!is_success(error)) {
    set_flags(node_id, error_control::start_up_failed, 0, now);
    listener_->slave_failed(node_id, error, now);
    if (phase_ == Phase::booting && !giving_up_ && (bits & assignment_bit::mandatory) != 0) {
      halt(now);
      listener_->start_up_halted(node_id, error, now);
    }
    return tell_starting(now);
  }
  in_error_[node_id] = false;
  listener_->slave_booted(node_id, now);
  if (error == BootError::already_operational) {
    expected_state_[node_id] = node_state::operational;
    if (!heard(node_id)) set_state(node_id, node_state::operational, now);
  } else if ((bits & assignment_bit::boot_slave) != 0 && !held_[node_id] &&
             (start_up_ & start_up_bit::do_not_start_slaves) == 0 &&
             ((start_up_ & start_up_bit::start_all_nodes) == 0 || phase_ == Phase::running)) {
    send_nmt(NmtCommand::start, node_id, now);
  }
  if (phase_ == Phase::booting) mandatory_done(now);
  tell_starting(now);
}

bool NmtMaster::Engine::all_booted(std::uint32_t assignment_bits) const {
  for (std::uint8_t n = 1; n < 128; ++n) {
    if ((assignment(n) & assignment_bits) != assignment_bits) continue;
    if (!boots_[n] || !boots_[n]->booted()) return false;
  }
  return true;
}

// Step 6, checked after each slave.
void NmtMaster::Engine::mandatory_done(can::Time now) {
  if (phase_ != Phase::booting) return;
  if (!all_booted(assignment_bit::slave | assignment_bit::mandatory)) return;
  boot_end_ = can::never;
  become_operational(now);
}

void NmtMaster::Engine::boot_time_elapsed(can::Time now) {
  boot_end_ = can::never;
  if (!begin_searches(now)) start_up_failed(now);
}

void NmtMaster::Engine::start_up_failed(can::Time now) {
  constexpr std::uint32_t needed = assignment_bit::slave | assignment_bit::mandatory;
  // Every missing slave is to have its result before the first of them ends the start-up.
  std::uint8_t first = 0;
  giving_up_ = true;
  const Phase phase = phase_;
  for (std::uint8_t n = 1; n < 128 && phase_ == phase; ++n) {
    if ((assignment(n) & needed) != needed || !boots_[n] || boots_[n]->booted()) continue;
    if (first == 0) first = n;
    boots_[n]->give_up(now);
    refresh(n);
  }
  giving_up_ = false;
  if (phase_ != phase || first == 0) return;
  const BootError error = boots_[first]->record().error;
  halt(now);
  listener_->start_up_halted(first, error, now);
}

// Step 7.
void NmtMaster::Engine::become_operational(can::Time now) {
  enter(Phase::wait_operational, now);
  if ((start_up_ & start_up_bit::wait_for_application) == 0) node_->command(NmtCommand::start, now);
  if (phase_ == Phase::wait_operational && node_->state() == NmtState::operational)
    own_node_is_operational(now);
}

bool NmtMaster::Engine::waits_for_own_start() const noexcept {
  const bool is_that_far =
      phase_ == Phase::wait_operational || phase_ == Phase::wait_start_all || phase_ == Phase::running;
  return is_that_far && node_->state() != NmtState::operational;
}

// Step 8.
void NmtMaster::Engine::own_node_is_operational(can::Time now) {
  constexpr std::uint32_t rule = start_up_bit::start_all_nodes | start_up_bit::do_not_start_slaves;
  if ((start_up_ & rule) == start_up_bit::start_all_nodes) {
    const can::Time earliest = later(reset_time_, options_.start_all_delay);
    if (earliest > now) return enter(Phase::wait_start_all, now, earliest);
    return start_slaves(now);
  }
  enter(Phase::running, now);
  listener_->start_up_finished(now);
  tell_starting(now);
}

// One command for all, unless somebody must not be started or is not ready: then each one singly.
void NmtMaster::Engine::start_slaves(can::Time now) {
  enter(Phase::running, now);
  if (held_.none() && all_booted(assignment_bit::slave)) {
    send_nmt(NmtCommand::start, all_nodes, now);
  } else {
    constexpr std::uint32_t startable = assignment_bit::slave | assignment_bit::boot_slave;
    for (std::uint8_t n = 1; n < 128; ++n) {
      if ((assignment(n) & startable) == startable && boots_[n] && boots_[n]->booted() && !held_[n] &&
          boots_[n]->record().error != BootError::already_operational) {
        send_nmt(NmtCommand::start, n, now);
      }
    }
  }
  listener_->start_up_finished(now);
  tell_starting(now);
}

void NmtMaster::Engine::enter(Phase phase, can::Time now, can::Time until) {
  phase_ = phase;
  phase_end_ = until;
  refresh_master(now);
}

void NmtMaster::Engine::halt(can::Time now) {
  boot_end_ = can::never;
  enter(Phase::halted, now);
  abandon_boots();
  for (std::uint8_t n = 1; n < 128; ++n) refresh(n);
  tell_starting(now);
}

void NmtMaster::Engine::abandon_boots() {
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (boots_[n] && boots_[n]->running()) boots_[n]->abandon();
  }
  boot_counted_.reset();
  running_boots_ = 0;
}

bool NmtMaster::Engine::may_boot() const {
  return active() && phase_ != Phase::halted && phase_ != Phase::searching &&
         node_->state() != NmtState::stopped;
}

std::uint32_t NmtMaster::Engine::assignment(std::uint8_t node_id) const {
  return node_id == node_->node_id() ? 0 : node_->dictionary().get<std::uint32_t>(0x1F81, node_id);
}

can::Duration NmtMaster::Engine::heartbeat_time(std::uint8_t node_id) const {
  const auto entries = node_->dictionary().get<std::uint8_t>(0x1016, 0);
  for (unsigned sub = 1; sub <= entries; ++sub) {
    const auto entry = node_->dictionary().get<std::uint32_t>(0x1016, static_cast<std::uint8_t>(sub));
    if ((entry >> 16 & 0xFF) == node_id && (entry & 0xFFFF) != 0) {
      return std::chrono::milliseconds(entry & 0xFFFF);
    }
  }
  return {};
}

std::span<const std::uint8_t> NmtMaster::Engine::concise_dcf(std::uint8_t node_id) {
  return source_ != nullptr ? source_->concise_dcf(node_id) : std::span<const std::uint8_t>{};
}

Program NmtMaster::Engine::open_program(std::uint8_t node_id) {
  return source_ != nullptr ? source_->open_program(node_id) : Program{};
}

void NmtMaster::Engine::tell_starting(can::Time now) {
  if (starting() == was_starting_) return;
  was_starting_ = !was_starting_;
  listener_->starting_changed(was_starting_, now);
}

}  // namespace canopus::manager
