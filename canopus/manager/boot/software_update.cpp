#include "canopus/manager/boot/software_update.hpp"

#include "canopus/manager/boot/start_up_bits.hpp"

namespace canopus::manager {

using canopen::AbortCode;

namespace {

constexpr std::uint16_t program_data = 0x1F50;
constexpr std::uint16_t program_control = 0x1F51;
constexpr std::uint16_t expected_version = 0x1F55;
constexpr std::uint16_t software_identification = 0x1F56;
constexpr std::uint16_t flash_status = 0x1F57;
constexpr std::uint8_t first_program = 1;

// 1F51H.
constexpr std::uint8_t stop = 0;  // reads: stopped
constexpr std::uint8_t run = 1;
constexpr std::uint8_t no_program = 2;
constexpr std::uint8_t clear = 3;

constexpr std::unexpected not_described{BootError::software_not_described};
constexpr std::unexpected download_failed{BootError::software_download};

// A step that has begun at `since` and may take `limit`, 0 = any time.
bool is_over(can::Time since, can::Duration limit, can::Time now) {
  return limit > can::Duration{} && now >= later(since, limit);
}

}  // namespace

void SoftwareUpdate::forget() noexcept {
  updates_ = 0;
  updated_ = false;
}

BootOutcome SoftwareUpdate::check(can::Time now) {
  if ((boot_->assignment() & assignment_bit::check_software) == 0) return StepResult::go_on;
  boot_->record.expected = boot_->expected(expected_version);
  if (boot_->record.expected == 0) {
    boot_->enter(BootStep::software_version, now);
    boot_->record.index = 0;
    return not_described;
  }
  boot_->request(BootStep::software_version, software_identification, first_program, now);
  return StepResult::wait;
}

BootOutcome SoftwareUpdate::answered(can::Time now) {
  switch (boot_->record.step) {
    case BootStep::software_version: return version_answered(now);
    case BootStep::program_state: return state_answered(now);
    case BootStep::program_stop: return stopped(now);
    case BootStep::program_clear: return cleared(now);
    case BootStep::program_download: return downloaded(now);
    case BootStep::program_flash: return flash_status_answered(now);
    case BootStep::program_verify: return verified(now);
    case BootStep::program_start: return start_answered(now);
    case BootStep::program_started: return run_answered(now);
    default: return StepResult::wait;
  }
}

BootOutcome SoftwareUpdate::boot_up(can::Time) {
  switch (boot_->record.step) {
    // Some devices restart to take a program.
    case BootStep::program_stop:
    case BootStep::program_clear: return StepResult::wait;
    // The boot-up message of that restart, late, or another one: the transfer will show.
    case BootStep::program_download: rebooted_ = true; return StepResult::wait;
    case BootStep::program_start:
    case BootStep::program_started:
      boot_->transfer.stop();
      updated_ = true;
      return StepResult::from_presence;
    default: return StepResult::from_start;
  }
}

BootOutcome SoftwareUpdate::version_answered(can::Time now) {
  if (!boot_->was_answered()) return not_described;
  boot_->record.received = boot_->transfer.value();
  if (boot_->record.received == boot_->record.expected) return StepResult::go_on;
  const std::uint32_t bits = boot_->assignment();
  if ((bits & assignment_bit::update_software) == 0 || (bits & assignment_bit::keep_alive) != 0) {
    return std::unexpected(BootError::software_not_allowed);
  }
  if (updated_ || updates_ >= boot_->host.boot_options().program_attempts) return download_failed;
  boot_->request(BootStep::program_state, program_control, first_program, now);
  return StepResult::wait;
}

BootOutcome SoftwareUpdate::state_answered(can::Time now) {
  if (!boot_->was_answered()) return download_failed;
  boot_->record.received = boot_->transfer.value();
  clear_attempts_ = 0;
  if (boot_->record.received == stop || boot_->record.received == no_program) {
    return control(BootStep::program_clear, clear, now);
  }
  return control(BootStep::program_stop, stop, now);
}

BootOutcome SoftwareUpdate::control(BootStep step, std::uint8_t command, can::Time now) {
  boot_->enter(step, now);
  command_ = command;
  boot_->transfer.write(program_control, first_program, {&command_, 1}, now);
  return StepResult::wait;
}

BootOutcome SoftwareUpdate::stopped(can::Time now) {
  if (!boot_->was_answered() && !boot_->was_silent()) return download_failed;
  return control(BootStep::program_clear, clear, now);
}

BootOutcome SoftwareUpdate::cleared(can::Time now) {
  if (boot_->was_answered()) {
    ++updates_;
    rebooted_ = false;
    return download(now);
  }
  const MasterOptions& options = boot_->host.boot_options();
  if (!boot_->was_silent() || ++clear_attempts_ >= options.program_clear_attempts) return download_failed;
  boot_->transfer.repeat_later(options.program_poll, now);
  return StepResult::wait;
}

BootOutcome SoftwareUpdate::download(can::Time now) {
  boot_->enter(BootStep::program_download, now);
  const Program program = boot_->host.open_program(boot_->node_id);
  boot_->record.bytes = 0;
  boot_->record.size = program.size.value_or(0);
  if (program.bytes == nullptr) {
    boot_->record.index = 0;
    return download_failed;
  }
  boot_->transfer.write_program(program_data, first_program, program, now);
  return StepResult::wait;
}

BootOutcome SoftwareUpdate::downloaded(can::Time now) {
  if (!boot_->was_answered()) {
    if (rebooted_) return StepResult::from_start;
    return download_failed;
  }
  boot_->record.received = 0;
  boot_->request(BootStep::program_flash, flash_status, first_program, now);
  return StepResult::wait;
}

// Not every device has 1F57H; one without it is asked for its version at once.
BootOutcome SoftwareUpdate::flash_status_answered(can::Time now) {
  BootRecord& record = boot_->record;
  const bool is_absent =
      record.abort_code == AbortCode::no_object || record.abort_code == AbortCode::no_sub_index;
  if (!boot_->was_answered() && !boot_->was_silent() && !is_absent) return download_failed;
  record.received = boot_->was_answered() ? boot_->transfer.value() : 0;
  const bool is_busy = boot_->was_silent() || (record.received & 1) != 0;
  if (is_busy) {
    const MasterOptions& options = boot_->host.boot_options();
    if (is_over(record.since, options.program_flash_limit, now)) return download_failed;
    boot_->transfer.repeat_later(options.program_poll, now);
    return StepResult::wait;
  }
  if ((record.received & 0xFE) != 0) return download_failed;
  record.expected = boot_->expected(expected_version);
  boot_->request(BootStep::program_verify, software_identification, first_program, now);
  return StepResult::wait;
}

BootOutcome SoftwareUpdate::verified(can::Time now) {
  if (!boot_->was_answered()) return download_failed;
  boot_->record.received = boot_->transfer.value();
  if (boot_->record.received != boot_->record.expected) return download_failed;
  return control(BootStep::program_start, run, now);
}

BootOutcome SoftwareUpdate::start_answered(can::Time now) {
  if (!boot_->was_answered() && !boot_->was_silent()) return download_failed;
  boot_->enter(BootStep::program_started, now);
  boot_->host.boot_went_on(boot_->node_id, boot_->record, now);
  boot_->transfer.read_later(boot_->host.boot_options().program_poll, now);
  return StepResult::wait;
}

BootOutcome SoftwareUpdate::run_answered(can::Time now) {
  if (!boot_->was_answered() && !boot_->was_silent()) return download_failed;
  if (boot_->was_answered() && boot_->transfer.value() == run) {
    updated_ = true;
    return StepResult::from_presence;
  }
  const MasterOptions& options = boot_->host.boot_options();
  if (is_over(boot_->record.since, options.program_start_limit, now)) return download_failed;
  boot_->transfer.repeat_later(options.program_poll, now);
  return StepResult::wait;
}

}  // namespace canopus::manager
