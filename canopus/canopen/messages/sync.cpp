#include "canopus/canopen/messages/sync.hpp"

namespace canopus::canopen {

Sync::Sync(NodeContext& node) : node_(node), timer_(node.timers.add()) {
  node.dictionary.attach(0x1005, 0x1007, *this);
  node.dictionary.attach(0x1019, 0x1019, *this);
}

void Sync::read() {
  const ObjectDictionary& d = node_.dictionary;
  cob_id_ = CobId{d.get<std::uint32_t>(0x1005, 0)};
  if (is_restricted(cob_id_)) cob_id_ = {};  // neither sent nor received
  period_ = in_steps(d.get<std::uint32_t>(0x1006, 0), std::chrono::microseconds(1),
                     node_.options.sync_period_resolution);
  window_ = std::chrono::microseconds(d.get<std::uint32_t>(0x1007, 0));
  overflow_ = d.get<std::uint8_t>(0x1019, 0);
  node_.change_identifiers();
}

void Sync::start(can::Time now) {
  read();
  length_error_ = false;
  window_end_ = can::never;
  node_.timers.stop(timer_);
  state_changed(now);
}

void Sync::stop() {
  cob_id_ = {};
  node_.timers.stop(timer_);
  node_.change_identifiers();
}

bool Sync::produces() const noexcept {
  return cob_id_.has_bit_30() && period_ != can::Duration{} && node_.may_produce_time();
}

void Sync::state_changed(can::Time now) {
  const bool wanted = produces();
  if (wanted == node_.timers.runs(timer_)) return;
  next_counter_ = 1;
  next_ = wanted ? can::later(now, period_) : can::never;
  node_.timers.set(timer_, next_);
}

void Sync::opened(can::Time now) {
  window_end_ = window_ != can::Duration{} ? can::later(now, window_) : can::never;
}

bool Sync::receive(const can::Frame& frame, can::Time now) {
  if (!node_.communicates()) return false;
  const bool fits = frame.dlc == (overflow_ != 0 ? 1 : 0);
  if (fits == length_error_) {
    length_error_ = !fits;
    const CommunicationError error{.code = node_.options.sync_length_error};
    fits ? node_.error_ended(error, now) : node_.error_began(error, now);
  }
  if (!fits) return false;
  counter_ = overflow_ != 0 ? frame.data[0] : std::uint8_t{0};
  opened(now);
  return true;
}

bool Sync::tick(can::Time now) {
  next_ += period_;
  if (next_ <= now) next_ = now + period_;
  node_.timers.set(timer_, next_);
  can::Frame frame{.identifier = cob_id_.identifier(), .extended = cob_id_.is_extended()};
  if (overflow_ != 0) {
    frame.dlc = 1;
    frame.data[0] = next_counter_;
  }
  if (!node_.sink.send(frame)) return false;
  counter_ = overflow_ != 0 ? next_counter_ : std::uint8_t{0};
  next_counter_ = next_counter_ >= overflow_ ? std::uint8_t{1} : static_cast<std::uint8_t>(next_counter_ + 1);
  opened(now);
  return true;
}

void Sync::list_identifiers(std::vector<IdentifierTable::Route>& routes) const {
  if (is_restricted(cob_id_)) return;  // without 1005H, too
  routes.push_back(
      {IdentifierTable::key(cob_id_.identifier(), cob_id_.is_extended(), false), ServiceKind::sync, 0});
}

AbortCode Sync::before_write(ObjectDictionary& dictionary, const Entry& entry,
                             std::span<const std::uint8_t> value, can::Time) {
  if (entry.index == 0x1005) {
    const CobId old_value{dictionary.get<std::uint32_t>(entry)};
    const CobId new_value = CobId::from(value);
    if (new_value.has_bit_30() && dictionary.description().find(0x1006) == nullptr) {
      return AbortCode::invalid_value;
    }
    if (old_value.has_bit_30() && new_value.has_bit_30() && !is_restricted(old_value) &&
        ((old_value.raw ^ new_value.raw) & 0x3FFF'FFFF) != 0) {
      return AbortCode::invalid_value;
    }
    return check_identifier(new_value, true, node_.options.extended_identifiers);
  }
  if (entry.index == 0x1019 && !value.empty()) {
    if (dictionary.get<std::uint32_t>(0x1006, 0) != 0) return AbortCode::device_state;
    if (value[0] == 1 || value[0] > 240) return AbortCode::invalid_value;
  }
  return AbortCode::none;
}

void Sync::after_write(ObjectDictionary&, const Entry& entry, can::Time now) {
  if (node_.state == NmtState::initialising) return;
  const can::Duration old_period = period_;
  read();
  if (period_ != old_period && node_.timers.runs(timer_)) node_.timers.stop(timer_);
  if (entry.index == 0x1007) window_end_ = can::never;
  state_changed(now);
}

}  // namespace canopus::canopen
