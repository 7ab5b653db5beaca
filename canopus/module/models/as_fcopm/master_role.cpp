#include "canopus/module/models/as_fcopm/master_role.hpp"

#include <algorithm>
#include <utility>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/module/interface/observer.hpp"
#include "canopus/module/models/as_fcopm/object_table.hpp"

namespace canopus::module::as_fcopm {

namespace {

/// A PDO that should have come so often is missing; the manual prints no time [10.5.1 E2].
constexpr int patience_periods = 3;
constexpr can::Duration least_patience = std::chrono::milliseconds(100);
/// A PDO that found no room in the controller is tried again.
constexpr can::Duration send_again = std::chrono::milliseconds(10);

can::Duration patience_of(const SlavePdo& pdo, const Configuration& configuration) {
  unsigned milliseconds =
      pdo.type <= 240 ? pdo.type * unsigned{configuration.cycle_period} : pdo.event_timer.value_or(0);
  if (milliseconds == 0) return {};
  return std::max<can::Duration>(patience_periods * std::chrono::milliseconds(milliseconds), least_patience);
}

std::array<std::uint8_t, 8> bytes_of(const PdoPlace& place, std::span<const std::uint16_t> words) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t i = 0; i < place.bytes; ++i)
    bytes[i] = static_cast<std::uint8_t>(words[place.first_word + i / 2] >> (i % 2 * 8));
  return bytes;
}

bool sends_by_change(const PdoPlace& place) { return place.pdo->type == 0 || place.pdo->type > 240; }

}  // namespace

MasterRole::MasterRole(Configuration configuration, can::Sink& sink, const Profile& profile,
                       ModuleObserver* const& observer)
    : configuration_(std::move(configuration)),
      observer_(observer),
      node_(master_dictionary(configuration_, lay_out(configuration_)),
            static_cast<std::uint8_t>(configuration_.node_id), sink, node_options(profile)),
      master_(node_, sink),
      requests_(master_, static_cast<std::uint8_t>(configuration_.node_id), emergencies_),
      receives_unlisted_(configuration_.slaves.empty()) {
  const Layout layout = lay_out(configuration_);
  for (const PdoPlace& place : layout.received)
    received_.push_back({.place = place, .patience = patience_of(*place.pdo, configuration_)});
  for (const PdoPlace& place : layout.sent) sent_.push_back({.place = place});
  for (const SlaveSetting& slave : configuration_.slaves) {
    slaves_[slave.node_id] = &slave;
    files_[slave.node_id] = as_fcopm::concise_dcf(slave);
    if (slave.node_id == configuration_.node_id) states_.set(slave.node_id, NodeCode::same_node_id, true);
  }
  node_.set_listener(this);
  master_.set_listener(this);
  master_.set_configuration_source(this);
  for (can::Alarm* part : {&node_.alarm(), &master_.alarm(), &next_scan_, &next_missing_})
    alarm().add_part(*part);
}

void MasterRole::start(can::Time now) { node_.power_on(now); }

void MasterRole::stop(can::Time now) {
  master_.stop(now);
  node_.power_off();
  next_scan_.cancel();
  next_missing_.cancel();
}

StartUp MasterRole::start_up() const noexcept {
  if (!master_.active()) return StartUp::none;
  if (master_.waits_for_own_start()) return StartUp::waits_for_own_start;
  if (master_.halted()) return StartUp::halted;
  return master_.starting() ? StartUp::booting : StartUp::ended;
}

std::vector<SlaveBootRecord> MasterRole::boots() const {
  std::vector<SlaveBootRecord> records;
  for (std::uint8_t node_id = 1; node_id <= most_slaves; ++node_id)
    if (slaves_[node_id] != nullptr && node_id != configuration_.node_id)
      records.push_back({node_id, master_.boot_record(node_id)});
  return records;
}

std::span<const std::uint8_t> MasterRole::concise_dcf(std::uint8_t node_id) {
  return node_id < files_.size() ? std::span<const std::uint8_t>(files_[node_id])
                                 : std::span<const std::uint8_t>{};
}

std::uint16_t MasterRole::read(BufferAddress address) const noexcept {
  if (address >= abnormal_first && address < abnormal_first + 4)
    return states_.flags(address - abnormal_first);
  if (address >= node_code_first && address < node_code_first + NodeStates::nodes)
    return states_.code(static_cast<std::uint8_t>(address - node_code_first + 1));
  if (address >= response_first && address < response_first + message_words)
    return requests_.response(address - response_first);
  if (address >= input_first && address < input_first + process_words) return inputs_[address - input_first];
  if (address >= request_first && address < request_first + message_words)
    return request_[address - request_first];
  if (address >= output_first && address < output_first + process_words)
    return outputs_[address - output_first];
  return 0;
}

void MasterRole::write(BufferAddress address, std::uint16_t value, can::Time now) {
  if (address >= request_first && address < request_first + message_words) {
    request_[address - request_first] = value;
    if (address == request_first) requests_.header_written(value);
  } else if (address >= output_first && address < output_first + process_words) {
    outputs_[address - output_first] = value;
  } else {
    return;
  }
  next_scan_.bring_forward(can::later(now, scan));
}

void MasterRole::receive(const can::Frame& frame, can::Time now) {
  if (!frame.extended && frame.identifier > canopen::cob_id::error_control &&
      frame.identifier < canopen::cob_id::error_control + 128) {
    const auto node_id = static_cast<std::uint8_t>(frame.identifier - canopen::cob_id::error_control);
    const bool is_listed = node_id <= most_slaves && slaves_[node_id] != nullptr;
    if (node_id == configuration_.node_id) {
      states_.set(node_id, NodeCode::same_node_id, true);
    } else if (!is_listed) {
      receives_unlisted_ = true;
    } else if (frame.length() == 1 && frame.data[0] == 0) {
      states_.set(node_id, NodeCode::emergency, false);  // it starts anew
    }
  }
  node_.receive(frame, now);
  master_.receive(frame, now);
}

void MasterRole::transmitted(const can::Frame& frame, can::Time now) {
  node_.transmitted(frame, now);
  master_.transmitted(frame, now);
}

void MasterRole::tick(can::Time now) {
  if (now >= next_scan_) {
    next_scan_ = can::never;
    requests_.read_request(request_, now);
    send_changes(now);
  }
  if (now >= next_missing_) check_missing(now);
  if (now >= node_.deadline()) node_.tick(now);
  if (now >= master_.deadline()) master_.tick(now);
}

// --- process data

// [10.6] RxPDOs of type 0, 254 and 255 go out when their data have changed, to a slave that is Operational; the others
// with the SYNC, by themselves. A slave that was booted has zeros; one that is started again gets its values once more.
void MasterRole::send_changes(can::Time now) {
  canopen::ObjectDictionary& objects = node_.dictionary();
  for (std::size_t number = 0; number < sent_.size(); ++number) {
    Sent& pdo = sent_[number];
    const auto bytes = bytes_of(pdo.place, outputs_);
    if (bytes == pdo.there && !pdo.is_due) continue;
    const auto index = static_cast<std::uint16_t>(sent_bytes_index + number);
    for (std::uint8_t i = 0; i < pdo.place.bytes; ++i)
      objects.set(index, static_cast<std::uint8_t>(i + 1), bytes[i]);
    if (!sends_by_change(pdo.place)) {
      pdo.there = bytes;
    } else if (operates(pdo.place.node_id)) {
      if (node_.tpdo_event(static_cast<std::uint16_t>(number), now)) {
        pdo.there = bytes;
        pdo.was_sent = true;
        pdo.is_due = false;
      } else {
        next_scan_.bring_forward(can::later(now, send_again));
      }
    }
  }
}

void MasterRole::rpdo_received(std::uint16_t number, can::Time now) {
  Received& pdo = received_[number];
  if (!is_configured(pdo.place.node_id)) return;
  const canopen::ObjectDictionary& objects = node_.dictionary();
  const auto index = static_cast<std::uint16_t>(received_bytes_index + number);
  for (std::size_t i = 0; i < pdo.place.bytes; ++i) {
    const auto byte = objects.get<std::uint8_t>(index, static_cast<std::uint8_t>(i + 1));
    std::uint16_t& word = inputs_[pdo.place.first_word + i / 2];
    word = static_cast<std::uint16_t>(i % 2 == 0 ? (word & 0xFF00U) | byte : (word & 0x00FFU) | byte << 8U);
  }
  watch(pdo, now);
  if (std::exchange(pdo.taken_longer, false) || (!pdo.is_wrong && !pdo.is_missing)) return;
  pdo.is_wrong = pdo.is_missing = false;
  show_pdos_of(pdo.place.node_id);
}

void MasterRole::rpdo_length_wrong(std::uint16_t number, std::uint16_t code, can::Time now) {
  Received& pdo = received_[number];
  if (!is_configured(pdo.place.node_id)) return;
  pdo.is_wrong = true;
  pdo.taken_longer = code == canopen::emcy_code::pdo_too_long;
  pdo.is_missing = false;
  watch(pdo, now);
  show_pdos_of(pdo.place.node_id);
}

void MasterRole::watch(Received& pdo, can::Time now) {
  if (pdo.patience == can::Duration{} || !operates(pdo.place.node_id)) return;
  pdo.due = can::later(now, pdo.patience);
  next_missing_.bring_forward(pdo.due);
}

void MasterRole::end_watch(std::uint8_t node_id) {
  for (Received& pdo : received_) {
    if (pdo.place.node_id != node_id) continue;
    pdo.due = can::never;
    pdo.is_missing = pdo.is_wrong = pdo.taken_longer = false;
  }
  show_pdos_of(node_id);
}

void MasterRole::check_missing(can::Time now) {
  next_missing_ = can::never;
  for (Received& pdo : received_) {
    if (now >= pdo.due) {
      pdo.due = can::never;
      pdo.is_missing = true;
      show_pdos_of(pdo.place.node_id);
    }
    next_missing_.bring_forward(pdo.due);
  }
}

void MasterRole::show_pdos_of(std::uint8_t node_id) {
  bool wrong = false, missing = false;
  for (const Received& pdo : received_) {
    if (pdo.place.node_id != node_id) continue;
    wrong = wrong || pdo.is_wrong;
    missing = missing || pdo.is_missing;
  }
  states_.set(node_id, NodeCode::pdo_length, wrong);
  states_.set(node_id, NodeCode::pdo_missing, missing);
}

// --- what happens on the network

void MasterRole::nmt_state_changed(canopen::NmtState state, can::Time now) {
  master_.own_state_changed(state, now);
  next_scan_.bring_forward(can::later(now, scan));
}

void MasterRole::node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time now) {
  if (state != manager::node_state::operational) return end_watch(node_id);
  for (Received& pdo : received_)
    if (pdo.place.node_id == node_id) watch(pdo, now);
  // A watched slave is known to be Stopped only by its next heartbeat: what was sent meanwhile did not reach it.
  for (Sent& pdo : sent_)
    if (pdo.place.node_id == node_id) pdo.is_due = pdo.was_sent;
  next_scan_.bring_forward(can::later(now, scan));
}

void MasterRole::emergency_received(const canopen::Emergency& message, can::Time) {
  emergencies_.record(message);
  const bool is_listed = message.node_id <= most_slaves && slaves_[message.node_id] != nullptr;
  if (is_listed) states_.set(message.node_id, NodeCode::emergency, message.code != 0);
}

void MasterRole::error_control_event(std::uint8_t node_id, manager::ErrorControlEvent, can::Time) {
  states_.set(node_id, NodeCode::error_control, true);
}

void MasterRole::boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) {
  using enum manager::BootStep;
  switch (record.step) {
    case presence_pause:
      if (!states_.has(node_id, NodeCode::error_control)) states_.set(node_id, NodeCode::not_there, true);
      break;
    case failed: boot_failed(node_id, record); break;
    case booted:
      for (const NodeCode cause : {NodeCode::auto_sdo, NodeCode::pdo_parameter, NodeCode::key_parameter,
                                   NodeCode::not_there, NodeCode::error_control})
        states_.set(node_id, cause, false);
      for (Sent& pdo : sent_)
        if (pdo.place.node_id == node_id) pdo = {.place = pdo.place};
      next_scan_.bring_forward(can::later(now, scan));
      break;
    case identity: states_.set(node_id, NodeCode::not_there, false); break;
    default: break;
  }
  if (observer_ != nullptr) observer_->slave_boot_went_on(node_id, record, now);
}

void MasterRole::boot_failed(std::uint8_t node_id, const manager::BootRecord& record) {
  using enum manager::BootError;
  NodeCode code = NodeCode::key_parameter;
  switch (record.error) {
    case none:
    case already_operational: return;
    case no_answer: code = NodeCode::not_there; break;
    case no_heartbeat_state:
    case no_guarding_state:
    case no_error_control: code = NodeCode::error_control; break;
    case configuration:
      switch (written_for(*slaves_[node_id], record.index, record.sub)) {
        case WrittenFor::pdo_parameter: code = NodeCode::pdo_parameter; break;
        case WrittenFor::error_control: code = NodeCode::error_control; break;
        case WrittenFor::auto_sdo: code = NodeCode::auto_sdo; break;
      }
      break;
    default: break;  // what it is differs from what was configured
  }
  states_.set(node_id, code, true);
}

}  // namespace canopus::module::as_fcopm
