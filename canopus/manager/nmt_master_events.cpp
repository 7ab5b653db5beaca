// What comes from the bus: boot-up messages, states, lost slaves [CiA 302-2; ME3CAN1-Q 4.8.7, notes B9], and
// the NMT commands that go out.

#include "canopus/manager/nmt_master_engine.hpp"

namespace canopus::manager {

using canopen::NmtCommand;
using canopen::NmtState;

namespace {

constexpr std::uint8_t all_nodes = 0;
constexpr std::uint32_t base_function = 0x780;
constexpr can::Duration send_retry = std::chrono::milliseconds(1);

// What a slave says of itself, as 1F82H shows it: a reserved value is no state.
constexpr std::uint8_t told_state(std::uint8_t state) noexcept {
  switch (static_cast<NmtState>(state)) {
    case NmtState::stopped:
    case NmtState::operational:
    case NmtState::pre_operational: return state;
    case NmtState::initialising: break;
  }
  return node_state::unknown;
}

}  // namespace

// A Stopped node sends no SDO and takes none, and nobody is told so [CiA 301 7.3.2.2.4; ME3CAN1-Q 4.8.1]: the
// start-up finds no answer and goes on asking.
bool NmtMaster::Engine::send(const can::Frame& frame) {
  if (muted_) return true;
  if ((frame.identifier & base_function) != canopen::cob_id::sdo_request) return wire_.send(frame);
  if (node_->state() == NmtState::stopped) return true;
  return line_.send(frame, wire_, now_);
}

void NmtMaster::Engine::transmitted(const can::Frame& frame, can::Time now) {
  now_ = now;
  if (frame.extended || frame.remote) return;
  if ((frame.identifier & base_function) != canopen::cob_id::sdo_request) return;
  const auto node_id = static_cast<std::uint8_t>(frame.identifier & 0x7F);
  if (boots_[node_id] && boots_[node_id]->sdo_busy()) boots_[node_id]->transmitted(now);
  line_.transmitted(frame.identifier, wire_, now);
}

void NmtMaster::Engine::receive(const can::Frame& frame, can::Time now) {
  now_ = now;
  if (frame.extended || frame.remote) return;
  if (wire_.is_sending()) {
    kept_.push_back(frame);
    return wake(now);
  }
  hear_kept(now);
  hear(frame, now);
}

void NmtMaster::Engine::hear_kept(can::Time now) {
  if (kept_.empty() || !hearing_.empty()) return;
  std::swap(kept_, hearing_);  // what is sent now may be answered at once again
  for (const can::Frame& frame : hearing_) hear(frame, now);
  hearing_.clear();
}

void NmtMaster::Engine::hear(const can::Frame& frame, can::Time now) {
  if (phase_ == Phase::searching) {
    search_.receive(frame, now);
    refresh_master(now);
    if (muted_) return;  // not this network's
  }
  if (flying_.state() != FlyingMaster::State::off || frame.identifier == canopen::cob_id::nmt) {
    flying_.receive(frame, now);
    refresh_master(now);
  }
  if (phase_ == Phase::off) return;
  const auto node_id = static_cast<std::uint8_t>(frame.identifier & 0x7F);
  if (node_id == 0 || node_id == node_->node_id()) return;
  switch (frame.identifier & base_function) {
    case canopen::cob_id::sdo_response:
      if (boots_[node_id] && boots_[node_id]->sdo_busy() && node_->state() != NmtState::stopped) {
        boots_[node_id]->receive(frame, now);
        boot_may_have_ended_transfer(node_id, now);
        refresh(node_id);
      } else {
        requests_.receive(frame, now);
      }
      return;
    case canopen::cob_id::error_control:
      if (!active() || frame.length() != 1) return;
      if (frame.data[0] == 0) {
        boot_up_message(node_id, now);
      } else {
        state_message(node_id, frame.data[0], now);
      }
      refresh(node_id);
      return;
    default: return;
  }
}

void NmtMaster::Engine::tick(can::Time now) {
  now_ = now;
  for (;;) {
    if (!kept_.empty() && hearing_.empty()) {
      hear_kept(now);
    } else if (timers_.earliest() <= now) {
      const std::uint8_t number = timers_.first();
      if (number == 0) {
        master_tick(now);
      } else {
        node_tick(number, now);
        refresh(number);
      }
    } else if (requests_.deadline() <= now) {
      requests_.tick(now);
    } else {
      return;
    }
  }
}

void NmtMaster::Engine::boot_may_have_ended_transfer(std::uint8_t node_id, can::Time now) {
  if (!boots_[node_id]->sdo_busy() && requests_.pending(node_id) > 0) requests_.channel_freed(node_id, now);
}

void NmtMaster::Engine::guarding_tick(std::uint8_t node_id, can::Time now) {
  const NodeGuarding::Due due = guarding_[node_id].tick(now);
  if (due.request) ask_state(node_id);
  if (due.missed) set_flags(node_id, error_control::guarding_miss, 0, now);
  if (due.lost) {
    set_flags(node_id, error_control::node_lost, 0, now);
    error_event(node_id, ErrorControlEvent::node_lost, now);
  }
}

void NmtMaster::Engine::node_tick(std::uint8_t node_id, can::Time now) {
  if (guarding_[node_id].deadline() <= now) guarding_tick(node_id, now);
  if (boots_[node_id] && boots_[node_id]->deadline() <= now) {
    boots_[node_id]->tick(now);
    boot_may_have_ended_transfer(node_id, now);
  }
}

void NmtMaster::Engine::master_tick(can::Time now) {
  timers_.set(0, can::never);
  if (own_command_ != 0) {
    const auto command = static_cast<NmtCommand>(own_command_);
    own_command_ = 0;
    node_->command(command, now);
  }
  if (begin_pending_) begin(now);
  if (own_state_changed_) {
    own_state_changed_ = false;
    if (phase_ == Phase::wait_operational && node_->state() == NmtState::operational) {
      own_node_is_operational(now);
    }
  }
  if (heartbeat_lost_pending_.any()) {
    for (std::uint8_t n = 1; n < 128; ++n) {
      if (!heartbeat_lost_pending_[n]) continue;
      heartbeat_lost_pending_[n] = false;
      error_event(n, ErrorControlEvent::heartbeat_lost, now);
    }
  }
  if (flying_.deadline() <= now) flying_.tick(now);
  if (boot_end_ <= now) boot_time_elapsed(now);
  if (search_.deadline() <= now) search_.tick(now);
  if (phase_end_ <= now) {
    phase_end_ = can::never;
    if (phase_ == Phase::settling) {
      become_operational(now);
    } else if (phase_ == Phase::wait_start_all) {
      start_slaves(now);
    }
  }
  if (command_count_ > 0) flush_commands(now);
  refresh_master(now);
}

void NmtMaster::Engine::refresh(std::uint8_t node_id) {
  can::Time next = guarding_[node_id].deadline();
  if (boots_[node_id]) next = std::min(next, boots_[node_id]->deadline());
  timers_.set(node_id, next);
}

void NmtMaster::Engine::refresh_master(can::Time now) {
  can::Time next = std::min({boot_end_, phase_end_, flying_.deadline(), search_.deadline()});
  if (command_count_ > 0) next = std::min(next, next_command_);
  if (begin_pending_ || own_state_changed_ || own_command_ != 0 || heartbeat_lost_pending_.any()) next = now;
  if (!kept_.empty()) next = now;
  timers_.set(0, next);
}

// --- from the node's listener

void NmtMaster::Engine::own_state_changed(can::Time now) {
  own_state_changed_ = true;
  wake(now);
}

void NmtMaster::Engine::heartbeat_received(std::uint8_t node_id, NmtState state, can::Time now) {
  if (node_id == 0 || node_id > 127) return;
  if (state == NmtState::initialising) {
    heartbeat_alive_[node_id] = false;  // reset: watched again from its first heartbeat on
    return set_state(node_id, node_state::pre_operational, now);
  }
  heartbeat_alive_[node_id] = true;
  heartbeat_lost_pending_[node_id] = false;
  set_flags(node_id, error_control::heartbeat_active, 0, now);
  set_state(node_id, told_state(static_cast<std::uint8_t>(state)), now);
  if (in_error_[node_id]) {
    in_error_[node_id] = false;
    listener_->error_control_resolved(node_id, now);
  }
}

void NmtMaster::Engine::heartbeat_lost(std::uint8_t node_id, can::Time now) {
  if (node_id == 0 || node_id > 127) return;
  heartbeat_alive_[node_id] = false;
  set_flags(node_id, error_control::heartbeat_missing, 0, now);
  heartbeat_lost_pending_[node_id] = true;
  wake(now);
}

// --- slaves

void NmtMaster::Engine::boot_up_message(std::uint8_t node_id, can::Time now) {
  const bool due = boot_up_due_[node_id] && now < later(reset_since_[node_id], options_.late_boot_up);
  boot_up_due_[node_id] = false;
  const BootSlave* boot = boots_[node_id].get();
  if (due && boot != nullptr && boot->answered() && (boot->running() || boot->booted())) return;
  guarding_[node_id].boot_up();
  wrong_state_[node_id] = false;
  expected_state_[node_id] = node_state::pre_operational;
  expected_since_[node_id] = now;
  set_state(node_id, node_state::pre_operational, now);
  if ((assignment(node_id) & assignment_bit::slave) == 0 || !may_boot()) return;
  if (boots_[node_id] && boots_[node_id]->running()) {
    boots_[node_id]->boot_up(now);
  } else {
    start_boot(node_id, false, now);
  }
}

void NmtMaster::Engine::state_message(std::uint8_t node_id, std::uint8_t byte, can::Time now) {
  const auto state = static_cast<std::uint8_t>(byte & 0x7F);
  const NodeGuarding::Answer answer = guarding_[node_id].answer(byte, now);
  if (guarding_[node_id].running()) {
    if (!answer.accepted) return set_flags(node_id, error_control::guarding_miss, 0, now);
    set_state(node_id, told_state(state), now);
    if (answer.resolved && in_error_[node_id]) {
      in_error_[node_id] = false;
      listener_->error_control_resolved(node_id, now);
    }
    check_guarded_state(node_id, state, now);
  }
  if (boots_[node_id] && phase_ != Phase::searching)
    boots_[node_id]->state_seen(static_cast<NmtState>(state), now);
}

// The command itself wins every arbitration, but an answer may have been on its way, and a slave needs its
// time.
void NmtMaster::Engine::check_guarded_state(std::uint8_t node_id, std::uint8_t state, can::Time now) {
  const std::uint8_t expected = expected_state_[node_id];
  if (expected == 0 || expected == state) {
    wrong_state_[node_id] = false;
    return;
  }
  if (wrong_state_[node_id] || now < later(expected_since_[node_id], options_.state_change_grace)) return;
  wrong_state_[node_id] = true;
  set_flags(node_id, error_control::unexpected_state, 0, now);
  error_event(node_id, ErrorControlEvent::unexpected_state, now);
}

void NmtMaster::Engine::error_event(std::uint8_t node_id, ErrorControlEvent event, can::Time now) {
  in_error_[node_id] = true;
  listener_->error_control_event(node_id, event, now);
  const std::uint32_t bits = assignment(node_id);
  if ((bits & assignment_bit::slave) == 0 || !may_boot() || begin_pending_) return;
  if (boots_[node_id] && boots_[node_id]->running()) return;  // it is being brought back already
  if ((bits & assignment_bit::mandatory) != 0) {
    if ((start_up_ & start_up_bit::stop_all_nodes) != 0) {
      send_nmt(NmtCommand::stop, all_nodes, now);
      halt(now);
      own_command_ = static_cast<std::uint8_t>(NmtCommand::stop);
      return wake(now);
    }
    if ((start_up_ & start_up_bit::reset_all_nodes) != 0) {
      abandon_boots();
      send_nmt(NmtCommand::reset_communication, all_nodes, now);
      network_was_reset_ = true;
      begin_pending_ = true;
      // The own node must not be Operational before the mandatory slaves are booted again.
      if (node_->state() == NmtState::operational) {
        own_command_ = static_cast<std::uint8_t>(NmtCommand::enter_pre_operational);
      }
      return wake(now);
    }
  }
  send_nmt(options_.error_reset, node_id, now);
  start_boot(node_id, true, now);
}

bool NmtMaster::Engine::heard(std::uint8_t node_id) const {
  return heartbeat_alive_[node_id] || guarding_[node_id].alive();
}

void NmtMaster::Engine::ask_state(std::uint8_t node_id) {
  send(can::remote_frame(canopen::cob_id::error_control + node_id, 1));
}

// Heartbeat has priority: no guarding of a node that 1016H watches [ME3CAN1-Q 4.6.7].
bool NmtMaster::Engine::guards(std::uint8_t node_id) const {
  const std::uint32_t bits = assignment(node_id);
  return (bits & assignment_bit::slave) != 0 && guard_time(bits) > can::Duration{} &&
         retry_factor(bits) > 0 && heartbeat_time(node_id) == can::Duration{};
}

void NmtMaster::Engine::start_guarding(std::uint8_t node_id, can::Time now) {
  if (!guards(node_id)) return;
  const std::uint32_t bits = assignment(node_id);
  guarding_[node_id].start(guard_time(bits), retry_factor(bits), now);
  set_flags(node_id, error_control::guarding_active, 0, now);
  guarding_tick(node_id, now);
  refresh(node_id);
}

// --- commands

void NmtMaster::Engine::send_nmt(NmtCommand command, std::uint8_t node_id, can::Time now) {
  if (command_count_ == queue_size) return;
  commands_[(first_command_ + command_count_) % queue_size] = {command, node_id};
  ++command_count_;
  flush_commands(now);
  refresh_master(now);
}

void NmtMaster::Engine::flush_commands(can::Time now) {
  if (flushes_commands_) return;  // asked for from inside send(): it comes after the one that goes out
  flushes_commands_ = true;
  while (command_count_ > 0 && next_command_ <= now) {
    const Command next = commands_[first_command_];
    first_command_ = (first_command_ + 1) % queue_size;  // before, for stop() may come from inside
    --command_count_;
    const bool sent =
        send(can::data_frame(canopen::cob_id::nmt, {static_cast<std::uint8_t>(next.command), next.node_id}));
    if (!sent) {
      first_command_ = (first_command_ + queue_size - 1) % queue_size;
      ++command_count_;
      next_command_ = later(now, send_retry);
      break;
    }
    next_command_ =
        later(now, std::chrono::microseconds(100) * node_->dictionary().get<std::uint16_t>(0x102A, 0));
    command_was_sent(next, now);
  }
  flushes_commands_ = false;
}

void NmtMaster::Engine::command_was_sent(Command command, can::Time now) {
  const bool reset =
      command.command == NmtCommand::reset_node || command.command == NmtCommand::reset_communication;
  if (reset && (command.node_id == all_nodes || phase_ == Phase::booting)) reset_time_ = now;
  for (std::uint8_t n = 1; reset && n < 128; ++n) {
    if (command.node_id != all_nodes && command.node_id != n) continue;
    boot_up_due_[n] = true;
    reset_since_[n] = now;
    if (boots_[n]) boots_[n]->was_reset();
  }
  if (command.node_id != all_nodes) return show_commanded(command.command, command.node_id, now);
  for (std::uint8_t n = 1; n < 128; ++n) {
    // A command to all says nothing of nodes that were never seen.
    if (n != node_->node_id() && state_[n] > node_state::missing) show_commanded(command.command, n, now);
  }
}

void NmtMaster::Engine::show_commanded(NmtCommand command, std::uint8_t node_id, can::Time now) {
  std::uint8_t state = node_state::unknown;
  switch (command) {
    case NmtCommand::start: state = node_state::operational; break;
    case NmtCommand::stop: state = node_state::stopped; break;
    case NmtCommand::enter_pre_operational: state = node_state::pre_operational; break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication: guarding_[node_id].expect_silence(); break;
  }
  expected_state_[node_id] = state;
  expected_since_[node_id] = now;
  wrong_state_[node_id] = false;
  if (state == node_state::unknown || !heard(node_id)) set_state(node_id, state, now);
  refresh(node_id);
}

// --- what is shown

std::uint8_t NmtMaster::Engine::node_state(std::uint8_t node_id) const noexcept {
  if (node_id >= state_.size()) return node_state::unknown;
  if (node_id != node_->node_id()) return state_[node_id];
  const NmtState own = node_->state();
  return own == NmtState::initialising ? node_state::reset_communication : static_cast<std::uint8_t>(own);
}

std::uint16_t NmtMaster::Engine::error_control(std::uint8_t node_id) const noexcept {
  return node_id < flags_.size() ? flags_[node_id] : std::uint16_t{0};
}

void NmtMaster::Engine::clear_error_control(std::uint8_t node_id, can::Time now) {
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (node_id == 0 || node_id == n) set_flags(n, 0, error_control::errors, now);
  }
}

void NmtMaster::Engine::set_state(std::uint8_t node_id, std::uint8_t state, can::Time now) {
  if (state_[node_id] == state) return;
  state_[node_id] = state;
  listener_->node_state_changed(node_id, state, now);
}

void NmtMaster::Engine::set_flags(std::uint8_t node_id, std::uint16_t set, std::uint16_t clear,
                                  can::Time now) {
  const auto flags = static_cast<std::uint16_t>((flags_[node_id] & ~clear) | set);
  if (flags == flags_[node_id]) return;
  flags_[node_id] = flags;
  listener_->error_control_changed(node_id, flags, now);
}

}  // namespace canopus::manager
