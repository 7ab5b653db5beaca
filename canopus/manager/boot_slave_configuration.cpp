// The configuration of a slave in the course of its boot: restore, compare, download [CiA 302-2, 302-3;
// ME3CAN1-Q 4.8.12].

#include <array>

#include "canopus/manager/boot_slave.hpp"
#include "canopus/manager/start_up_bits.hpp"

namespace canopus::manager {

namespace {

constexpr std::array<std::uint8_t, 4> load_signature{0x6C, 0x6F, 0x61, 0x64};  // "load"

}  // namespace

void BootSlave::restore(can::Time now) {
  const auto sub = host_->dictionary().get<std::uint8_t>(0x1F8A, node_id_);
  if ((host_->assignment(node_id_) & assignment_bit::restore) == 0 || sub == 0)
    return check_configuration(now);
  enter(BootStep::restore, now);
  download(0x1011, sub, load_signature, now);
}

void BootSlave::restore_answered(can::Time now) {
  if (record_.abort_code != canopen::AbortCode::none) return fail(BootError::configuration, now);
  enter(BootStep::boot_up_after_restore, now, host_->boot_options().boot_up_time_out);
  answered_ = false;
  // Restored communication parameters (sub 02) need no more than a reset of the communication.
  host_->send_nmt(
      record_.sub == 2 ? canopen::NmtCommand::reset_communication : canopen::NmtCommand::reset_node, node_id_,
      now);
}

void BootSlave::check_configuration(can::Time now) {
  if (is_empty_concise_dcf(host_->concise_dcf(node_id_))) return start_error_control(now);
  const auto date = host_->dictionary().get<std::uint32_t>(0x1F26, node_id_);
  const auto time = host_->dictionary().get<std::uint32_t>(0x1F27, node_id_);
  if (date == 0 || time == 0) return start_configuration(now);
  record_.expected = date;
  ask(BootStep::configuration_date, 0x1020, 1, now);
}

void BootSlave::configuration_mark_answered(can::Time now) {
  record_.received = received_value();
  if (record_.abort_code != canopen::AbortCode::none || record_.received != record_.expected) {
    return start_configuration(now);
  }
  if (record_.step == BootStep::configuration_time) return start_error_control(now);
  record_.expected = host_->dictionary().get<std::uint32_t>(0x1F27, node_id_);
  ask(BootStep::configuration_time, 0x1020, 2, now);
}

void BootSlave::start_configuration(can::Time now) {
  enter(BootStep::configuration, now);
  configuration_ = ConciseDcfReader(host_->concise_dcf(node_id_));
  next_configuration_entry(now);
}

void BootSlave::configure(can::Time now) {
  step_before_configuration_ = record_.step;
  only_configure_ = true;
  start_configuration(now);
}

void BootSlave::next_configuration_entry(can::Time now) {
  // Recursion would follow the file's length when transfers end inside the call; they never do.
  const auto entry = configuration_.next();
  if (!entry) return configuration_finished(now);
  download(entry->index, entry->sub, entry->data, now);
}

// Read-only objects in the file are passed over [ME3CAN1-Q 4.8.12].
void BootSlave::configuration_entry_answered(can::Time now) {
  if (record_.abort_code != canopen::AbortCode::none &&
      record_.abort_code != canopen::AbortCode::write_of_read_only) {
    return fail(BootError::configuration, now);
  }
  next_configuration_entry(now);
}

void BootSlave::configuration_finished(can::Time now) {
  if (!configuration_.intact()) {
    record_.abort_code = canopen::AbortCode::general;
    record_.index = 0;
    return fail(BootError::configuration, now);
  }
  if (!only_configure_) return start_error_control(now);
  only_configure_ = false;
  enter(step_before_configuration_, now);
}

}  // namespace canopus::manager
