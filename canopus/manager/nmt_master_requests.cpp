// What the application asks for: the objects 1F80H-1F83H, 1F90H [CiA 302-2; ME3CAN1-Q 4.8.5-4.8.10].

#include <algorithm>

#include "canopus/can/little_endian.hpp"
#include "canopus/manager/nmt_master_engine.hpp"

namespace canopus::manager {

using canopen::AbortCode;
using canopen::NmtCommand;

namespace {

constexpr std::uint8_t all = 0x80;

// 04H..07H, 7FH; the same with bit 7 (8FH for 7FH) leave the own node out.
constexpr bool excludes_master(std::uint8_t value) noexcept { return (value & 0x80) != 0; }

constexpr bool is_request(std::uint8_t value) noexcept {
  switch (value) {
    case 0x04:
    case 0x05:
    case 0x06:
    case 0x07:
    case 0x7F:
    case 0x84:
    case 0x85:
    case 0x86:
    case 0x87:
    case 0x8F: return true;
    default: return false;
  }
}

constexpr NmtCommand command_of(std::uint8_t value) noexcept {
  switch (value & 0x0F) {
    case 0x04: return NmtCommand::stop;
    case 0x05: return NmtCommand::start;
    case 0x06: return NmtCommand::reset_node;
    case 0x07: return NmtCommand::reset_communication;
    default: return NmtCommand::enter_pre_operational;
  }
}

}  // namespace

AbortCode NmtMaster::Engine::check_nmt_request(std::uint8_t node_id, std::uint8_t value) const noexcept {
  if (node_id == 0 || node_id > all) return AbortCode::no_sub_index;
  if (!active()) return options_.not_master;
  return is_request(value) ? AbortCode::none : AbortCode::invalid_value;
}

void NmtMaster::Engine::perform_nmt_request(std::uint8_t node_id, std::uint8_t value, can::Time now) {
  const NmtCommand command = command_of(value);
  // What was stopped by hand stays so; any other command gives it back to the start-up [ME3CAN1-Q 4.8.8].
  const bool hold = command == NmtCommand::stop || command == NmtCommand::enter_pre_operational;
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (node_id == all || node_id == n) held_[n] = hold && assignment(n) != 0;
  }
  const std::uint8_t own = node_->node_id();
  if (node_id != own) send_nmt(command, node_id == all ? 0 : node_id, now);
  if ((node_id == own || node_id == all) && !excludes_master(value)) {
    own_command_ = static_cast<std::uint8_t>(command);
    wake(now);
  }
}

AbortCode NmtMaster::Engine::check_guarding_request(std::uint8_t node_id, std::uint8_t value) const noexcept {
  if (node_id == 0 || node_id > all) return AbortCode::no_sub_index;
  if (!active()) return options_.not_master;
  return value <= 1 ? AbortCode::none : AbortCode::invalid_value;
}

void NmtMaster::Engine::perform_guarding_request(std::uint8_t node_id, std::uint8_t value, can::Time now) {
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (node_id != all && node_id != n) continue;
    if (value == 0) {
      guarding_[n].stop();
      set_flags(n, 0, error_control::guarding_active, now);
      refresh(n);
    } else if (!guarding_[n].running()) {
      start_guarding(n, now);
    }
  }
}

AbortCode NmtMaster::Engine::request_configuration(std::uint8_t node_id, can::Time now) {
  if (node_id == 0 || node_id > 127) return AbortCode::no_sub_index;
  if (node_id == node_->node_id()) return AbortCode::none;  // accepted, does nothing [ME3CAN1-Q 4.8.12]
  if (!active()) return options_.not_master;
  if (is_empty_concise_dcf(concise_dcf(node_id))) return AbortCode::no_data;
  auto& boot = boots_[node_id];
  if (!boot) boot = std::make_unique<BootSlave>(node_id, *this, static_cast<can::Sink&>(*this));
  if (boot->running()) return AbortCode::device_state;
  boot->configure(now);
  refresh(node_id);
  return AbortCode::none;
}

AbortCode NmtMaster::Engine::check_sdo_request(std::uint8_t node_id) const noexcept {
  if (node_id == 0 || node_id > 127 || node_id == node_->node_id()) return AbortCode::invalid_value;
  const canopen::NmtState state = node_->state();
  const bool allowed = state == canopen::NmtState::pre_operational || state == canopen::NmtState::operational;
  return allowed && phase_ != Phase::off ? AbortCode::none : AbortCode::device_state;
}

// Start-up and application take turns, so that neither waits for the other's end.
bool NmtMaster::Engine::sdo_channel_free(std::uint8_t node_id, can::Time now) {
  if (!listener_->sdo_channel_free(node_id) || requests_.busy(node_id)) return false;
  if (boot_had_channel_[node_id] && requests_.channel_freed(node_id, now)) {
    boot_had_channel_[node_id] = false;
    return false;
  }
  boot_had_channel_[node_id] = true;
  return true;
}

unsigned NmtMaster::Engine::blocks_running() const {
  return static_cast<unsigned>(std::count_if(
      boots_.begin(), boots_.end(), [](const auto& boot) { return boot && boot->downloads_block(); }));
}

bool NmtMaster::Engine::channel_is_free(std::uint8_t node_id) {
  return listener_->sdo_channel_free(node_id) && (!boots_[node_id] || !boots_[node_id]->sdo_busy());
}

void NmtMaster::Engine::channel_freed(std::uint8_t node_id, can::Time now) {
  if (!boots_[node_id]) return;
  boots_[node_id]->channel_freed(now);
  refresh(node_id);
}

AbortCode NmtMaster::Engine::before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                         can::Time) {
  if (entry.sub == 0 || entry.sub > 127) return AbortCode::none;
  if (entry.index == 0x1F82) dictionary.set(entry, node_state(entry.sub));
  if (entry.index == 0x1F83) dictionary.set<std::uint8_t>(entry, guarding(entry.sub) ? 1 : 0);
  return AbortCode::none;
}

AbortCode NmtMaster::Engine::before_write(canopen::ObjectDictionary&, const canopen::Entry& entry,
                                          std::span<const std::uint8_t> value, can::Time) {
  const std::uint32_t number = can::load_u32(value);
  const auto byte = static_cast<std::uint8_t>(number);
  switch (entry.index) {
    case 0x1F80: return (number & ~options_.start_up_bits) == 0 ? AbortCode::none : AbortCode::invalid_value;
    case 0x1F81:
      return entry.sub == 0 || (byte & ~options_.assignment_bits) == 0 ? AbortCode::none
                                                                       : AbortCode::invalid_value;
    case 0x1F82: return check_nmt_request(entry.sub, byte);
    case 0x1F83: return check_guarding_request(entry.sub, byte);
    case 0x1F90:  // 03: priority level 0 high, 1 medium, 2 low
      return entry.sub == 3 && number > 2 ? AbortCode::invalid_value : AbortCode::none;
    default: return AbortCode::none;
  }
}

void NmtMaster::Engine::after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                    can::Time now) {
  switch (entry.index) {
    case 0x1F81:
      // A slave that needs no boot is guarded from now on; others at the proper step of their boot.
      if (active() && phase_ == Phase::running &&
          (!boots_[entry.sub & 0x7F] || !boots_[entry.sub & 0x7F]->running())) {
        perform_guarding_request(entry.sub, 0, now);
        perform_guarding_request(entry.sub, 1, now);
      }
      return;
    case 0x1F82: return perform_nmt_request(entry.sub, dictionary.get<std::uint8_t>(entry), now);
    case 0x1F83: return perform_guarding_request(entry.sub, dictionary.get<std::uint8_t>(entry), now);
    default: return;
  }
}

}  // namespace canopus::manager
