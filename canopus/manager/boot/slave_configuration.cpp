#include "canopus/manager/boot/slave_configuration.hpp"

#include <array>

#include "canopus/manager/boot/start_up_bits.hpp"

namespace canopus::manager {

namespace {

constexpr std::array<std::uint8_t, 4> load_signature{0x6C, 0x6F, 0x61, 0x64};  // "load"

constexpr std::unexpected failed{BootError::configuration};

}  // namespace

BootOutcome SlaveConfiguration::begin(can::Time now) {
  const auto sub = static_cast<std::uint8_t>(boot_->expected(0x1F8A));
  if ((boot_->assignment() & assignment_bit::restore) == 0 || sub == 0) return compare(now);
  boot_->enter(BootStep::restore, now);
  boot_->transfer.write(0x1011, sub, load_signature, now);
  return StepResult::wait;
}

BootOutcome SlaveConfiguration::answered(can::Time now) {
  switch (boot_->record.step) {
    case BootStep::restore: return restored(now);
    case BootStep::configuration_date:
    case BootStep::configuration_time: return mark_answered(now);
    case BootStep::configuration: return entry_answered(now);
    default: return StepResult::wait;
  }
}

BootOutcome SlaveConfiguration::restored(can::Time now) {
  if (!boot_->was_answered()) return failed;
  boot_->enter(BootStep::boot_up_after_restore, now, boot_->host.boot_options().boot_up_time_out);
  boot_->answered = false;
  // Restored communication parameters (sub 02) need no more than a reset of the communication.
  const bool communication_alone = boot_->record.sub == 2;
  boot_->host.send_nmt(
      communication_alone ? canopen::NmtCommand::reset_communication : canopen::NmtCommand::reset_node,
      boot_->node_id, now);
  return StepResult::wait;
}

BootOutcome SlaveConfiguration::compare(can::Time now) {
  if (is_empty_concise_dcf(boot_->host.concise_dcf(boot_->node_id))) return StepResult::go_on;
  const std::uint32_t date = boot_->expected(0x1F26);
  const std::uint32_t time = boot_->expected(0x1F27);
  if (date == 0 || time == 0) return download(now);
  boot_->record.expected = date;
  boot_->request(BootStep::configuration_date, 0x1020, 1, now);
  return StepResult::wait;
}

BootOutcome SlaveConfiguration::mark_answered(can::Time now) {
  BootRecord& record = boot_->record;
  record.received = boot_->transfer.value();
  if (!boot_->was_answered() || record.received != record.expected) return download(now);
  if (record.step == BootStep::configuration_time) return StepResult::go_on;
  record.expected = boot_->expected(0x1F27);
  boot_->request(BootStep::configuration_time, 0x1020, 2, now);
  return StepResult::wait;
}

BootOutcome SlaveConfiguration::download(can::Time now) {
  boot_->enter(BootStep::configuration, now);
  file_ = ConciseDcfReader(boot_->host.concise_dcf(boot_->node_id));
  return next_entry(now);
}

BootOutcome SlaveConfiguration::next_entry(can::Time now) {
  // Recursion would follow the file's length when transfers end inside the call; they never do.
  if (const auto entry = file_.next()) {
    boot_->transfer.write(entry->index, entry->sub, entry->data, now);
    return StepResult::wait;
  }
  if (file_.intact()) return StepResult::go_on;
  boot_->record.abort_code = canopen::AbortCode::general;
  boot_->record.index = 0;
  return failed;
}

BootOutcome SlaveConfiguration::entry_answered(can::Time now) {
  const bool is_skipped = boot_->host.boot_options().configuration_skips_read_only &&
                          boot_->record.abort_code == canopen::AbortCode::write_of_read_only;
  if (!boot_->was_answered() && !is_skipped) return failed;
  return next_entry(now);
}

}  // namespace canopus::manager
