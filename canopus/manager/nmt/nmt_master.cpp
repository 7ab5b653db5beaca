#include "canopus/manager/nmt/nmt_master.hpp"

#include <utility>

#include "canopus/manager/boot/concise_dcf.hpp"

namespace canopus::manager {

using canopen::AbortCode;
using canopen::NmtCommand;
using canopen::NmtState;

NmtMaster::NmtMaster(canopen::Node& the_node, can::Sink& sink, const MasterOptions& the_options)
    : MasterContext(the_node, the_options),
      port_(sink, the_node),
      requests_(port_, *this),
      commands_(*this),
      error_control_(*this),
      start_up_(*this, port_, port_.wire()),
      flying_(*this, port_, start_up_, error_control_, commands_),
      nmt_requests_(*this, start_up_, error_control_) {
  for (can::Alarm* part : {&start_up_.alarm(), &flying_.alarm(), &commands_.alarm(), &error_control_.alarm()})
    alarms[0].add_part(*part);
  for (can::Alarm* part : {&port_.alarm(), &alarms.alarm(), &requests_.alarm()}) alarm().add_part(*part);
}

void NmtMaster::start(can::Time now) {
  stop(now);
  start_up_.request_begin(now);
}

void NmtMaster::stop(can::Time now) {
  const bool was_active = active();
  start_up_.search().abandon(now);
  port_.mute(true);
  start_up_.abandon_boots();
  port_.mute(false);
  port_.clear();
  flying_.stop();
  start_up_.turn_off();
  port_.mute(true);
  requests_.cancel(0, AbortCode::device_state, now);
  port_.mute(false);
  start_up_.forget();
  commands_.clear();
  error_control_.forget(now);
  if (was_active) start_up_.show_active(false, now);
  start_up_.show_starting(now);
}

// --- frames

void NmtMaster::receive(const can::Frame& frame, can::Time now) {
  port_.set_time(now);
  if (frame.extended || frame.remote) return;
  if (port_.is_sending()) return port_.defer(frame, now);
  process_deferred(now);
  process(frame, now);
}

void NmtMaster::process_deferred(can::Time now) {
  port_.process_deferred([this, now](const can::Frame& frame) { process(frame, now); });
}

void NmtMaster::process(const can::Frame& frame, can::Time now) {
  if (lss_active()) {
    start_up_.search().receive(frame, now);
    if (port_.is_muted()) return;  // not this network's
  }
  flying_.receive(frame, now);
  if (start_up_.phase() == StartUp::Phase::off) return;
  const auto node_id = static_cast<std::uint8_t>(frame.identifier & 0x7F);
  if (node_id == 0 || node_id == node.node_id()) return;
  switch (frame.identifier & canopen::cob_id::function_code) {
    case canopen::cob_id::sdo_response: return process_sdo_response(node_id, frame, now);
    case canopen::cob_id::error_control:
      if (active() && frame.length() == 1) process_error_control(node_id, frame, now);
      return;
    default: return;
  }
}

void NmtMaster::process_sdo_response(std::uint8_t node_id, const can::Frame& frame, can::Time now) {
  if (!slaves[node_id].boot_uses_channel() || node.state() == NmtState::stopped) {
    return requests_.receive(frame, now);
  }
  slaves[node_id].boot->receive(frame, now);
  boot_may_have_ended_transfer(node_id, now);
}

void NmtMaster::process_error_control(std::uint8_t node_id, const can::Frame& frame, can::Time now) {
  const std::uint8_t byte = frame.data[0];
  if (byte != 0) {
    const auto state = static_cast<NmtState>(byte & 0x7F);
    if (error_control_.state_message(node_id, byte, now)) start_up_.state_seen(node_id, state, now);
  } else if (!start_up_.is_late_boot_up(node_id, now)) {
    error_control_.boot_up(node_id, now);
    start_up_.boot_up(node_id, now);
  }
}

void NmtMaster::transmitted(const can::Frame& frame, can::Time now) {
  port_.set_time(now);
  if (frame.extended || frame.remote) return;
  if ((frame.identifier & canopen::cob_id::function_code) != canopen::cob_id::sdo_request) return;
  const auto node_id = static_cast<std::uint8_t>(frame.identifier & 0x7F);
  if (slaves[node_id].boot_uses_channel()) slaves[node_id].boot->transmitted(now);
  port_.request_transmitted(frame.identifier, now);
}

void NmtMaster::command_sent(NmtCommand command, std::uint8_t node_id, can::Time now) {
  const bool is_reset = command == NmtCommand::reset_node || command == NmtCommand::reset_communication;
  if (is_reset) start_up_.reset_sent(node_id, now);
  error_control_.commanded(command, node_id, now);
  start_up_.command_sent(now);
}

// --- time

void NmtMaster::tick(can::Time now) {
  port_.set_time(now);
  for (;;) {
    if (port_.may_process_deferred()) {
      process_deferred(now);
    } else if (alarms.alarm() <= now) {
      const std::uint8_t number = alarms.first();
      number == 0 ? master_tick(now) : node_tick(number, now);
    } else if (requests_.alarm() <= now) {
      requests_.tick(now);
    } else {
      return;
    }
  }
}

void NmtMaster::node_tick(std::uint8_t node_id, can::Time now) {
  if (slaves[node_id].guarding.alarm() <= now) error_control_.guarding_tick(node_id, now);
  const Slave& slave = slaves[node_id];
  if (slave.boot && slave.boot->alarm() <= now) {
    slave.boot->tick(now);
    boot_may_have_ended_transfer(node_id, now);
  }
}

void NmtMaster::master_tick(can::Time now) {
  start_up_.obey(now);
  error_control_.tick(now);
  flying_.tick(now);
  start_up_.tick(now);
  commands_.flush(now);
}

// --- SDO: start-up and application take turns, so that neither waits for the other's end

bool NmtMaster::sdo_channel_free(std::uint8_t node_id, can::Time now) {
  if (!listener->sdo_channel_free(node_id) || requests_.busy(node_id)) return false;
  Slave& slave = slaves[node_id];
  if (slave.boot_had_channel && requests_.channel_freed(node_id, now)) {
    slave.boot_had_channel = false;
    return false;
  }
  slave.boot_had_channel = true;
  return true;
}

bool NmtMaster::channel_is_free(std::uint8_t node_id) {
  return listener->sdo_channel_free(node_id) && !slaves[node_id].boot_uses_channel();
}

void NmtMaster::channel_freed(std::uint8_t node_id, can::Time now) {
  if (slaves[node_id].boot) slaves[node_id].boot->channel_freed(now);
}

void NmtMaster::boot_may_have_ended_transfer(std::uint8_t node_id, can::Time now) {
  if (!slaves[node_id].boot_uses_channel() && requests_.pending(node_id) > 0) {
    requests_.channel_freed(node_id, now);
  }
}

const BootRecord& NmtMaster::boot_record(std::uint8_t node_id) const noexcept {
  static const BootRecord never_booted;
  const bool is_known = node_id < slaves.size() && slaves[node_id].boot;
  return is_known ? slaves[node_id].boot->record() : never_booted;
}

bool NmtMaster::optional_slave_failed() const noexcept {
  if (!active()) return false;
  for (std::uint8_t node_id = 1; node_id < slaves.size(); ++node_id) {
    if (boot_record(node_id).step != BootStep::failed) continue;
    const auto assignment = node.dictionary().get<std::uint32_t>(0x1F81, node_id, 0);
    if ((assignment & assignment_bit::slave) != 0 && (assignment & assignment_bit::mandatory) == 0)
      return true;
  }
  return false;
}

AbortCode NmtMaster::request_configuration(std::uint8_t node_id, can::Time now) {
  if (node_id == 0 || node_id > 127) return AbortCode::no_sub_index;
  if (node_id == node.node_id()) return AbortCode::none;  // accepted, does nothing [ME3CAN1-Q 4.8.12]
  if (!active()) return MasterContext::options.not_master;
  if (is_empty_concise_dcf(concise_dcf(node_id))) return AbortCode::no_data;
  BootSlave& boot = start_up_.boot_of(node_id);
  if (boot.running()) return AbortCode::device_state;
  port_.set_time(now);
  boot.configure(now);
  return AbortCode::none;
}

AbortCode NmtMaster::check_sdo_request(std::uint8_t node_id) const noexcept {
  if (node_id == 0 || node_id > 127 || node_id == node.node_id()) return AbortCode::invalid_value;
  const NmtState state = node.state();
  const bool is_allowed = state == NmtState::pre_operational || state == NmtState::operational;
  return is_allowed && start_up_.phase() != StartUp::Phase::off ? AbortCode::none : AbortCode::device_state;
}

AbortCode NmtMaster::read_object(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                                 SdoRequests::Done done, can::Time now,
                                 const SdoRequestOptions& request_options) {
  const AbortCode refusal = check_sdo_request(node_id);
  if (refusal == AbortCode::none) {
    port_.set_time(now);
    requests_.upload(node_id, index, sub, std::move(done), now, request_options);
  }
  return refusal;
}

AbortCode NmtMaster::write_object(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                                  std::span<const std::uint8_t> value, SdoRequests::Done done, can::Time now,
                                  const SdoRequestOptions& request_options) {
  const AbortCode refusal = check_sdo_request(node_id);
  if (refusal == AbortCode::none) {
    port_.set_time(now);
    requests_.download(node_id, index, sub, value, std::move(done), now, request_options);
  }
  return refusal;
}

}  // namespace canopus::manager
