#include "canopus/manager/boot/boot_slave.hpp"

#include "canopus/manager/boot/start_up_bits.hpp"

namespace canopus::manager {

namespace {

constexpr BootError identity_error(std::uint8_t sub) noexcept {
  switch (sub) {
    case 1: return BootError::vendor;
    case 2: return BootError::product;
    case 3: return BootError::revision;
    default: return BootError::serial;
  }
}

}  // namespace

bool BootSlave::running() const noexcept {
  switch (boot_.record.step) {
    case BootStep::idle:
    case BootStep::booted:
    case BootStep::failed: return false;
    default: return true;
  }
}

void BootSlave::start(bool after_reset, can::Time now) {
  abandon();
  boot_.record = BootRecord{};
  only_configure_ = false;
  found_operational_ = boot_.answered = false;
  boot_.transfer.allow_blocks(true);
  const can::Duration wait = boot_.host.boot_options().wait_after_reset;
  if (after_reset && wait > can::Duration{}) {
    boot_.enter(BootStep::wait_after_reset, now, wait);
  } else {
    begin(now);
  }
}

void BootSlave::suspend() {
  boot_.transfer.stop();
  boot_.step_end.cancel();
}

void BootSlave::abandon() {
  suspend();
  boot_.record.step = BootStep::idle;
}

void BootSlave::begin(can::Time now) {
  const std::uint32_t assignment = boot_.assignment();
  if ((assignment & assignment_bit::slave) == 0) return fail(BootError::not_assigned, now);
  if ((assignment & assignment_bit::boot_slave) == 0) return start_error_control(now);
  request_presence(now);
}

void BootSlave::boot_up(can::Time now) {
  switch (boot_.record.step) {
    case BootStep::wait_after_reset: return begin(now);
    // The question was lost; its time-out asks again at once.
    case BootStep::presence: rebooted_ = true; return;
    case BootStep::presence_pause: return request_presence(now);
    case BootStep::boot_up_after_reset: return on_software_step(software_.check(now), now);
    case BootStep::boot_up_after_restore: return follow_configuration(configuration_.compare(now), now);
    default: break;
  }
  if (facts(boot_.record.step).phase == BootPhase::software)
    return on_software_step(software_.boot_up(now), now);
  start(false, now);
}

void BootSlave::request_presence(can::Time now) {
  rebooted_ = false;
  ++boot_.record.attempts;
  boot_.request(BootStep::presence, 0x1000, 0, now);
}

void BootSlave::presence_answered(can::Time now) {
  BootRecord& record = boot_.record;
  if (!boot_.was_answered()) {
    record.error = BootError::no_answer;
    boot_.host.presence_known(boot_.node_id, false, now);
    if (rebooted_) return request_presence(now);
    return boot_.enter(BootStep::presence_pause, now, pause_before_retry(now));
  }
  record.error = BootError::none;
  boot_.host.presence_known(boot_.node_id, true, now);
  record.received = boot_.transfer.value();
  record.expected = boot_.expected(0x1F84);
  if (record.expected != 0 && record.expected != record.received) return fail(BootError::device_type, now);
  request_identity(1, now);
}

can::Duration BootSlave::pause_before_retry(can::Time now) const {
  const MasterOptions& options = boot_.host.boot_options();
  if (!options.presence_retry_counts_from_request) return options.presence_retry;
  constexpr can::Duration next_tick{1};
  return std::max(options.presence_retry - (now - boot_.transfer.requested_at()), next_tick);
}

void BootSlave::request_identity(std::uint8_t sub, can::Time now) {
  for (; sub <= 4; ++sub) {
    boot_.record.expected = boot_.expected(static_cast<std::uint16_t>(0x1F84 + sub));
    if (boot_.record.expected == 0) continue;
    return boot_.request(BootStep::identity, 0x1018, sub, now);
  }
  check_state(now);
}

void BootSlave::identity_answered(can::Time now) {
  BootRecord& record = boot_.record;
  if (!boot_.was_answered()) return fail(identity_error(record.sub), now);
  record.received = boot_.transfer.value();
  const bool newer_minor_will_do =
      record.sub == 3 && boot_.host.boot_options().revision_rule == RevisionRule::same_major_newer_minor;
  const bool fits = newer_minor_will_do ? record.received >> 16 == record.expected >> 16 &&
                                              (record.received & 0xFFFF) >= (record.expected & 0xFFFF)
                                        : record.received == record.expected;
  if (!fits) return fail(identity_error(record.sub), now);
  request_identity(static_cast<std::uint8_t>(record.sub + 1), now);
}

// Keep alive: a node that is Operational must not be disturbed.
void BootSlave::check_state(can::Time now) {
  if ((boot_.assignment() & assignment_bit::keep_alive) == 0) {
    return on_software_step(software_.check(now), now);
  }
  const can::Duration heartbeat = boot_.host.heartbeat_time(boot_.node_id);
  if (heartbeat > can::Duration{}) return boot_.enter(BootStep::state_by_heartbeat, now, heartbeat);
  boot_.enter(BootStep::state_by_guarding, now, boot_.host.boot_options().guarding_probe);
  boot_.host.request_state(boot_.node_id);
}

void BootSlave::state_seen(canopen::NmtState state, can::Time now) {
  switch (boot_.record.step) {
    case BootStep::state_by_heartbeat:
    case BootStep::state_by_guarding:
      if (state == canopen::NmtState::operational) {
        found_operational_ = true;
        return start_error_control(now);
      }
      boot_.enter(BootStep::boot_up_after_reset, now, boot_.host.boot_options().boot_up_time_out);
      boot_.answered = false;
      boot_.host.send_nmt(canopen::NmtCommand::reset_communication, boot_.node_id, now);
      return;
    case BootStep::heartbeat_start:
    case BootStep::guarding_start: return finish(now);
    default: return;
  }
}

void BootSlave::on_software_step(const BootOutcome& outcome, can::Time now) {
  if (!outcome) return fail(outcome.error(), now);
  switch (*outcome) {
    case StepResult::wait: return;
    case StepResult::go_on: return follow_configuration(configuration_.begin(now), now);
    case StepResult::from_presence: return begin(now);
    case StepResult::from_start: return start(false, now);
  }
}

void BootSlave::configure(can::Time now) {
  step_before_configuration_ = boot_.record.step;
  only_configure_ = true;
  follow_configuration(configuration_.download(now), now);
}

void BootSlave::follow_configuration(const BootOutcome& outcome, can::Time now) {
  if (!outcome) return fail(outcome.error(), now);
  if (*outcome == StepResult::go_on) configured(now);
}

void BootSlave::configured(can::Time now) {
  if (!only_configure_) return start_error_control(now);
  only_configure_ = false;
  boot_.enter(step_before_configuration_, now);
}

void BootSlave::start_error_control(can::Time now) {
  const can::Duration heartbeat = boot_.host.heartbeat_time(boot_.node_id);
  if (heartbeat > can::Duration{}) return boot_.enter(BootStep::heartbeat_start, now, heartbeat);
  if (!boot_.host.guards(boot_.node_id)) return finish(now);
  const can::Duration probe = boot_.host.boot_options().guarding_probe;
  boot_.enter(BootStep::guarding_start, now, probe);
  boot_.host.start_guarding(boot_.node_id, now);
  if (probe == can::Duration{}) finish(now);
}

void BootSlave::finish(can::Time now) {
  const BootError result = found_operational_ ? BootError::already_operational : BootError::none;
  boot_.record.error = result;
  software_.forget();
  boot_.enter(BootStep::booted, now);
  boot_.host.boot_ended(boot_.node_id, result, now);
}

void BootSlave::fail(BootError error, can::Time now) {
  boot_.transfer.stop();
  boot_.record.failed_step = boot_.record.step;
  boot_.record.error = error;
  if (only_configure_) {
    only_configure_ = false;
    boot_.enter(step_before_configuration_, now);
    return;
  }
  software_.forget();
  boot_.enter(BootStep::failed, now);
  boot_.host.boot_ended(boot_.node_id, error, now);
}

BootError BootSlave::error_of_step() const noexcept {
  const BootStep step = boot_.record.step;
  if (step == BootStep::identity) return identity_error(boot_.record.sub);
  if (step == BootStep::boot_up_after_reset && boot_.host.heartbeat_time(boot_.node_id) <= can::Duration{})
    return BootError::no_guarding_state;
  return facts(step).error;
}

void BootSlave::give_up(can::Time now) {
  if (running() && !only_configure_) fail(error_of_step(), now);
}

void BootSlave::tick(can::Time now) {
  boot_.transfer.tick(now);
  if (boot_.step_end > now) return;
  boot_.step_end.cancel();
  switch (boot_.record.step) {
    case BootStep::wait_after_reset: return begin(now);
    case BootStep::presence_pause: return request_presence(now);
    case BootStep::state_by_heartbeat:
    case BootStep::state_by_guarding:
    case BootStep::boot_up_after_reset:
    case BootStep::boot_up_after_restore:
    case BootStep::heartbeat_start:
    case BootStep::guarding_start: return fail(error_of_step(), now);
    default: return;
  }
}

void BootSlave::transfer_ended(can::Time now) {
  if (!boot_.was_silent()) boot_.answered = true;
  if (boot_.transfer.blocks_refused(software_.rebooted())) {
    boot_.transfer.allow_blocks(false);
    if (boot_.record.step != BootStep::program_download) return boot_.transfer.repeat(now);
    return on_software_step(software_.download(now), now);
  }
  switch (boot_.record.step) {
    case BootStep::presence: return presence_answered(now);
    case BootStep::identity: return identity_answered(now);
    default: break;
  }
  const BootStepFacts& step = facts(boot_.record.step);
  if (!step.asks_object) return;
  if (step.phase == BootPhase::software) return on_software_step(software_.answered(now), now);
  if (step.phase == BootPhase::configuration) follow_configuration(configuration_.answered(now), now);
}

}  // namespace canopus::manager
