// "Check and update program software" [CiA 302-2, 302-3]: what 1F56H:01 of the slave says is compared with
// 1F55H; if it differs, and an update is allowed, the program of 1F58H goes to the slave.
//
// A device restarts when its program is stopped or started, and may not answer while its flash memory is
// cleared or written: there, no answer is no failure.

#include "canopus/manager/boot_slave.hpp"
#include "canopus/manager/start_up_bits.hpp"

namespace canopus::manager {

using canopen::AbortCode;

namespace {

constexpr std::uint16_t program_data = 0x1F50;
constexpr std::uint16_t program_control = 0x1F51;
constexpr std::uint16_t software_identification = 0x1F56;
constexpr std::uint16_t flash_status = 0x1F57;
constexpr std::uint8_t first_program = 1;

// 1F51H.
constexpr std::uint8_t stop = 0;  // reads: stopped
constexpr std::uint8_t run = 1;
constexpr std::uint8_t no_program = 2;
constexpr std::uint8_t clear = 3;

}  // namespace

void BootSlave::check_software(can::Time now) {
  if ((host_->assignment(node_id_) & assignment_bit::check_software) == 0) return restore(now);
  record_.expected = host_->dictionary().get<std::uint32_t>(0x1F55, node_id_);
  if (record_.expected == 0) {
    enter(BootStep::software_version, now);
    record_.index = 0;
    return fail(BootError::software_not_described, now);
  }
  ask(BootStep::software_version, software_identification, first_program, now);
}

void BootSlave::software_version_answered(can::Time now) {
  if (record_.abort_code != AbortCode::none) return fail(BootError::software_not_described, now);
  record_.received = received_value();
  if (record_.received == record_.expected) return restore(now);
  const std::uint32_t bits = host_->assignment(node_id_);
  if ((bits & assignment_bit::update_software) == 0 || (bits & assignment_bit::keep_alive) != 0) {
    return fail(BootError::software_not_allowed, now);
  }
  if (updated_ || updates_ >= host_->boot_options().program_attempts) {
    return fail(BootError::software_download, now);
  }
  ask(BootStep::program_state, program_control, first_program, now);
}

void BootSlave::program_state_answered(can::Time now) {
  if (record_.abort_code != AbortCode::none) return fail(BootError::software_download, now);
  record_.received = received_value();
  clear_attempts_ = 0;
  if (record_.received == stop || record_.received == no_program) {
    return control_program(BootStep::program_clear, clear, now);
  }
  control_program(BootStep::program_stop, stop, now);
}

void BootSlave::control_program(BootStep step, std::uint8_t command, can::Time now) {
  enter(step, now);
  program_command_ = command;
  download(program_control, first_program, {&program_command_, 1}, now);
}

void BootSlave::program_stopped(can::Time now) {
  if (record_.abort_code != AbortCode::none && record_.abort_code != AbortCode::timed_out) {
    return fail(BootError::software_download, now);
  }
  control_program(BootStep::program_clear, clear, now);
}

void BootSlave::program_cleared(can::Time now) {
  if (record_.abort_code == AbortCode::none) {
    ++updates_;
    rebooted_ = false;
    return download_program(now);
  }
  const MasterOptions& options = host_->boot_options();
  if (record_.abort_code != AbortCode::timed_out || ++clear_attempts_ >= options.program_clear_attempts) {
    return fail(BootError::software_download, now);
  }
  request_later(options.program_poll, now);
}

void BootSlave::download_program(can::Time now) {
  enter(BootStep::program_download, now);
  program_ = host_->open_program(node_id_);
  record_.bytes = 0;
  record_.size = program_.size.value_or(0);
  if (program_.bytes == nullptr) {
    record_.index = 0;
    return fail(BootError::software_download, now);
  }
  writes_program_ = true;
  download(program_data, first_program, {}, now);
}

std::expected<std::size_t, AbortCode> BootSlave::read(std::span<std::uint8_t> into) {
  const auto count = program_.bytes->read(into);
  if (count) record_.bytes += static_cast<std::uint32_t>(*count);
  return count;
}

void BootSlave::program_downloaded(can::Time now) {
  if (record_.abort_code != AbortCode::none && rebooted_) return start(false, now);
  if (record_.abort_code != AbortCode::none) return fail(BootError::software_download, now);
  record_.received = 0;
  ask(BootStep::program_flash, flash_status, first_program, now);
}

// Not every device has 1F57H; one without it is asked for its version at once.
void BootSlave::flash_status_answered(can::Time now) {
  const bool silent = record_.abort_code == AbortCode::timed_out;
  const bool absent =
      record_.abort_code == AbortCode::no_object || record_.abort_code == AbortCode::no_sub_index;
  if (record_.abort_code != AbortCode::none && !silent && !absent) {
    return fail(BootError::software_download, now);
  }
  record_.received = record_.abort_code == AbortCode::none ? received_value() : 0;
  const bool busy = silent || (record_.received & 1) != 0;
  if (busy) {
    const MasterOptions& options = host_->boot_options();
    const can::Duration limit = options.program_flash_limit;
    if (limit > can::Duration{} && now >= later(record_.since, limit)) {
      return fail(BootError::software_download, now);
    }
    return request_later(options.program_poll, now);
  }
  if ((record_.received & 0xFE) != 0) return fail(BootError::software_download, now);
  record_.expected = host_->dictionary().get<std::uint32_t>(0x1F55, node_id_);
  ask(BootStep::program_verify, software_identification, first_program, now);
}

void BootSlave::program_verified(can::Time now) {
  if (record_.abort_code != AbortCode::none) return fail(BootError::software_download, now);
  record_.received = received_value();
  if (record_.received != record_.expected) return fail(BootError::software_download, now);
  control_program(BootStep::program_start, run, now);
}

void BootSlave::program_start_answered(can::Time now) {
  if (record_.abort_code != AbortCode::none && record_.abort_code != AbortCode::timed_out) {
    return fail(BootError::software_download, now);
  }
  enter(BootStep::program_started, now);
  host_->boot_went_on(node_id_, record_, now);
  download_ = {};
  request_later(host_->boot_options().program_poll, now);
}

void BootSlave::program_run_answered(can::Time now) {
  const bool silent = record_.abort_code == AbortCode::timed_out;
  if (record_.abort_code != AbortCode::none && !silent) return fail(BootError::software_download, now);
  if (!silent && received_value() == run) {
    updated_ = true;
    return begin(now);
  }
  const MasterOptions& options = host_->boot_options();
  const can::Duration limit = options.program_start_limit;
  if (limit > can::Duration{} && now >= later(record_.since, limit)) {
    return fail(BootError::software_download, now);
  }
  request_later(options.program_poll, now);
}

}  // namespace canopus::manager
