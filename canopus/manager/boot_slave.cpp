#include "canopus/manager/boot_slave.hpp"

#include "canopus/can/little_endian.hpp"
#include "canopus/manager/start_up_bits.hpp"

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

BootSlave::BootSlave(std::uint8_t node_id, BootHost& host, can::Sink& sink)
    : node_id_(node_id), host_(&host), client_(sink) {
  client_.set_server(node_id);
}

bool BootSlave::running() const noexcept {
  switch (record_.step) {
    case BootStep::idle:
    case BootStep::booted:
    case BootStep::failed: return false;
    default: return true;
  }
}

void BootSlave::enter(BootStep step, can::Time now, can::Duration limit) {
  record_.step = step;
  record_.since = now;
  request_pending_ = wants_channel_ = writes_program_ = false;
  deadline_ = limit > can::Duration{} ? later(now, limit) : can::never;
  if (!asks_object(step)) host_->boot_went_on(node_id_, record_, now);
}

void BootSlave::download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data,
                         can::Time now) {
  record_.index = index;
  record_.sub = sub;
  download_ = data;
  host_->boot_went_on(node_id_, record_, now);
  request(now);
}

void BootSlave::start(bool after_reset, can::Time now) {
  abandon();
  record_ = BootRecord{};
  only_configure_ = false;
  found_operational_ = answered_ = no_blocks_ = false;
  const can::Duration wait = host_->boot_options().wait_after_reset;
  if (after_reset && wait > can::Duration{}) {
    enter(BootStep::wait_after_reset, now, wait);
  } else {
    begin(now);
  }
}

void BootSlave::suspend() {
  if (client_.busy()) client_.cancel(canopen::AbortCode::general);
  deadline_ = can::never;
  request_pending_ = wants_channel_ = writes_program_ = false;
}

void BootSlave::abandon() {
  suspend();
  record_.step = BootStep::idle;
}

void BootSlave::begin(can::Time now) {
  const std::uint32_t assignment = host_->assignment(node_id_);
  if ((assignment & assignment_bit::slave) == 0) return fail(BootError::not_assigned, now);
  if ((assignment & assignment_bit::boot_slave) == 0) return start_error_control(now);
  ask_presence(now);
}

void BootSlave::boot_up(can::Time now) {
  switch (record_.step) {
    case BootStep::wait_after_reset: begin(now); break;
    case BootStep::presence:
      rebooted_ = true;
      break;  // the question was lost; its time-out asks again at once
    case BootStep::presence_pause: ask_presence(now); break;
    case BootStep::boot_up_after_reset: check_software(now); break;
    case BootStep::boot_up_after_restore: check_configuration(now); break;
    // Some devices restart to take a program.
    case BootStep::program_stop:
    case BootStep::program_clear: break;
    case BootStep::program_download:
      rebooted_ = true;
      break;  // the boot-up message of that restart, late, or another one: the transfer will show
    case BootStep::program_start:
    case BootStep::program_started:
      if (client_.busy()) client_.cancel(canopen::AbortCode::general);
      updated_ = true;
      begin(now);
      break;
    default: start(false, now); break;
  }
}

void BootSlave::ask(BootStep step, std::uint16_t index, std::uint8_t sub, can::Time now) {
  enter(step, now);
  download(index, sub, {}, now);
}

void BootSlave::request(can::Time now) {
  wants_channel_ = false;
  const MasterOptions& options = host_->boot_options();
  if (takes_blocks() && host_->blocks_running() >= options.blocks_at_once) {
    return request_later(options.busy_retry, now);
  }
  if (host_->sdo_channel_free(node_id_, now) && start_transfer(now)) {
    request_pending_ = false;
    deadline_ = can::never;
    return;
  }
  request_later(options.busy_retry, now);
  wants_channel_ = true;
}

void BootSlave::channel_freed(can::Time now) {
  if (request_pending_ && wants_channel_) request(now);
}

void BootSlave::request_later(can::Duration pause, can::Time now) {
  request_pending_ = true;
  deadline_ = later(now, pause);
}

bool BootSlave::takes_blocks() const {
  const std::size_t block_from = host_->boot_options().block_from;
  return !no_blocks_ && (writes_program_ || (block_from != 0 && download_.size() >= block_from));
}

bool BootSlave::start_transfer(can::Time now) {
  using Mode = canopen::SdoClient::Mode;
  const MasterOptions& options = host_->boot_options();
  const bool slow = record_.step == BootStep::program_clear || record_.step == BootStep::program_download;
  const can::Duration time_out = slow ? options.program_time_out : options.sdo_time_out;
  in_blocks_ = takes_blocks();
  if (!writes_program_ && download_.data() == nullptr) {
    return client_.upload(record_.index, record_.sub, *this, now, time_out);
  }
  const Mode mode = in_blocks_ ? Mode::block : Mode::segmented;
  if (writes_program_) {
    return client_.download(record_.index, record_.sub, *this, program_.size, *this, now, time_out, mode);
  }
  return client_.download(record_.index, record_.sub, download_, *this, now, time_out, mode);
}

// Also a slave that knows no blocks and does not even say so is tried without them once.
bool BootSlave::blocks_refused() const noexcept {
  // What breaks off in the middle of a program is no question of blocks.
  const bool is_program = record_.step == BootStep::program_download;
  switch (record_.abort_code) {
    case canopen::AbortCode::timed_out: return in_blocks_ && (!is_program || record_.bytes == 0);
    case canopen::AbortCode::command_specifier:
    case canopen::AbortCode::block_size:
    case canopen::AbortCode::sequence_number:
    case canopen::AbortCode::crc:
    case canopen::AbortCode::unsupported_access: return in_blocks_ && !(is_program && rebooted_);
    default: return false;
  }
}

void BootSlave::ask_presence(can::Time now) {
  rebooted_ = false;
  ++record_.attempts;
  ask(BootStep::presence, 0x1000, 0, now);
}

void BootSlave::presence_answered(can::Time now) {
  if (record_.abort_code != canopen::AbortCode::none) {
    record_.error = BootError::no_answer;
    host_->presence_known(node_id_, false, now);
    if (rebooted_) return ask_presence(now);
    return enter(BootStep::presence_pause, now, host_->boot_options().presence_retry);
  }
  record_.error = BootError::none;
  host_->presence_known(node_id_, true, now);
  record_.received = received_value();
  record_.expected = host_->dictionary().get<std::uint32_t>(0x1F84, node_id_);
  if (record_.expected != 0 && record_.expected != record_.received) return fail(BootError::device_type, now);
  ask_identity(1, now);
}

void BootSlave::ask_identity(std::uint8_t sub, can::Time now) {
  for (; sub <= 4; ++sub) {
    const auto index = static_cast<std::uint16_t>(0x1F84 + sub);
    record_.expected = host_->dictionary().get<std::uint32_t>(index, node_id_);
    if (record_.expected == 0) continue;
    return ask(BootStep::identity, 0x1018, sub, now);
  }
  check_state(now);
}

void BootSlave::identity_answered(can::Time now) {
  if (record_.abort_code != canopen::AbortCode::none) return fail(identity_error(record_.sub), now);
  record_.received = received_value();
  const bool newer_minor_will_do =
      record_.sub == 3 && host_->boot_options().revision_rule == RevisionRule::same_major_newer_minor;
  const bool fits = newer_minor_will_do ? record_.received >> 16 == record_.expected >> 16 &&
                                              (record_.received & 0xFFFF) >= (record_.expected & 0xFFFF)
                                        : record_.received == record_.expected;
  if (!fits) return fail(identity_error(record_.sub), now);
  ask_identity(static_cast<std::uint8_t>(record_.sub + 1), now);
}

// Keep alive: a node that is Operational must not be disturbed.
void BootSlave::check_state(can::Time now) {
  if ((host_->assignment(node_id_) & assignment_bit::keep_alive) == 0) return check_software(now);
  const can::Duration heartbeat = host_->heartbeat_time(node_id_);
  if (heartbeat > can::Duration{}) return enter(BootStep::state_by_heartbeat, now, heartbeat);
  enter(BootStep::state_by_guarding, now, host_->boot_options().guarding_probe);
  host_->ask_state(node_id_);
}

void BootSlave::state_seen(canopen::NmtState state, can::Time now) {
  switch (record_.step) {
    case BootStep::state_by_heartbeat:
    case BootStep::state_by_guarding:
      if (state == canopen::NmtState::operational) {
        found_operational_ = true;
        return start_error_control(now);
      }
      enter(BootStep::boot_up_after_reset, now, host_->boot_options().boot_up_time_out);
      answered_ = false;
      host_->send_nmt(canopen::NmtCommand::reset_communication, node_id_, now);
      return;
    case BootStep::heartbeat_start:
    case BootStep::guarding_start: return finish(now);
    default: return;
  }
}

void BootSlave::start_error_control(can::Time now) {
  const can::Duration heartbeat = host_->heartbeat_time(node_id_);
  if (heartbeat > can::Duration{}) return enter(BootStep::heartbeat_start, now, heartbeat);
  if (!host_->guards(node_id_)) return finish(now);
  const can::Duration probe = host_->boot_options().guarding_probe;
  enter(BootStep::guarding_start, now, probe);
  host_->start_guarding(node_id_, now);
  if (probe == can::Duration{}) finish(now);
}

void BootSlave::finish(can::Time now) {
  const BootError result = found_operational_ ? BootError::already_operational : BootError::none;
  record_.error = result;
  updates_ = 0;
  updated_ = false;
  enter(BootStep::booted, now);
  host_->boot_ended(node_id_, result, now);
}

void BootSlave::fail(BootError error, can::Time now) {
  if (client_.busy()) client_.cancel(canopen::AbortCode::general);
  record_.failed_step = record_.step;
  record_.error = error;
  if (only_configure_) {
    only_configure_ = false;
    enter(step_before_configuration_, now);
    return;
  }
  updates_ = 0;
  updated_ = false;
  enter(BootStep::failed, now);
  host_->boot_ended(node_id_, error, now);
}

BootError BootSlave::error_of_step() const noexcept {
  switch (record_.step) {
    case BootStep::identity: return identity_error(record_.sub);
    case BootStep::state_by_heartbeat: return BootError::no_heartbeat_state;
    case BootStep::state_by_guarding: return BootError::no_guarding_state;
    case BootStep::boot_up_after_reset:
      return host_->heartbeat_time(node_id_) > can::Duration{} ? BootError::no_heartbeat_state
                                                               : BootError::no_guarding_state;
    case BootStep::software_version: return BootError::software_not_described;
    case BootStep::program_state:
    case BootStep::program_stop:
    case BootStep::program_clear:
    case BootStep::program_download:
    case BootStep::program_flash:
    case BootStep::program_verify:
    case BootStep::program_start:
    case BootStep::program_started: return BootError::software_download;
    case BootStep::restore:
    case BootStep::boot_up_after_restore:
    case BootStep::configuration_date:
    case BootStep::configuration_time:
    case BootStep::configuration: return BootError::configuration;
    case BootStep::heartbeat_start:
    case BootStep::guarding_start: return BootError::no_error_control;
    default: return BootError::no_answer;
  }
}

void BootSlave::give_up(can::Time now) {
  if (running() && !only_configure_) fail(error_of_step(), now);
}

void BootSlave::tick(can::Time now) {
  if (client_.deadline() <= now) {
    if (host_->request_waits(node_id_, now)) client_.count_from(now);
    client_.tick(now);
  }
  if (deadline_ > now) return;
  deadline_ = can::never;
  if (request_pending_) return request(now);
  switch (record_.step) {
    case BootStep::wait_after_reset: return begin(now);
    case BootStep::presence_pause: return ask_presence(now);
    case BootStep::state_by_heartbeat:
    case BootStep::state_by_guarding:
    case BootStep::boot_up_after_reset:
    case BootStep::boot_up_after_restore:
    case BootStep::heartbeat_start:
    case BootStep::guarding_start: return fail(error_of_step(), now);
    default: return;
  }
}

void BootSlave::sdo_finished(canopen::SdoClient& client, can::Time now) {
  record_.abort_code = client.abort_code();
  if (record_.abort_code != canopen::AbortCode::timed_out) answered_ = true;
  writes_program_ = false;
  if (blocks_refused()) {
    no_blocks_ = true;
    return record_.step == BootStep::program_download ? download_program(now) : request(now);
  }
  switch (record_.step) {
    case BootStep::presence: return presence_answered(now);
    case BootStep::identity: return identity_answered(now);
    case BootStep::software_version: return software_version_answered(now);
    case BootStep::program_state: return program_state_answered(now);
    case BootStep::program_stop: return program_stopped(now);
    case BootStep::program_clear: return program_cleared(now);
    case BootStep::program_download: return program_downloaded(now);
    case BootStep::program_flash: return flash_status_answered(now);
    case BootStep::program_verify: return program_verified(now);
    case BootStep::program_start: return program_start_answered(now);
    case BootStep::program_started: return program_run_answered(now);
    case BootStep::restore: return restore_answered(now);
    case BootStep::configuration_date:
    case BootStep::configuration_time: return configuration_mark_answered(now);
    case BootStep::configuration: return configuration_entry_answered(now);
    default: return;
  }
}

std::uint32_t BootSlave::received_value() const noexcept { return can::load_u32(client_.data()); }

}  // namespace canopus::manager
