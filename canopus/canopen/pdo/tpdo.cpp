// What TPDOs do.

#include "canopus/canopen/pdo/tpdo.hpp"

#include <algorithm>
#include <utility>

#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {

void Tpdos::activate(Tpdo& pdo, can::Time now) {
  all_told_ = false;
  pdo.has_event = false;
  pdo.was_sent = !node_.options.unsent_values_are_changed && pdo.is_valid;
  if (pdo.was_sent) pdo.last_data = gather(pdo);
  pdo.inhibited_until = {};
  pdo.syncs_left = pdo.transmission_type;
  pdo.waits_for_start = pdo.sync_start != 0;
  start_timer(pdo, now);
}

void Tpdos::start_timer(Tpdo& pdo, can::Time now) {
  const bool timed = pdo.is_event_driven() && pdo.event_timer != 0;
  pdo.event_due = timed && node_.is_operational() && pdo.is_valid
                      ? now + std::chrono::milliseconds(pdo.event_timer)
                      : can::never;
  schedule(pdo);
}

void Tpdos::schedule(const Tpdo& pdo) {
  const bool waits = pdo.has_event && pdo.is_event_driven();
  node_.timers.set(timer(pdo), waits ? std::min(pdo.inhibited_until, pdo.event_due) : pdo.event_due);
}

void Tpdos::stop() {
  for (Tpdo& pdo : tpdos_) {
    pdo.is_valid = false;
    pdo.has_event = false;
    pdo.event_due = can::never;
    schedule(pdo);
  }
  valid_count_ = 0;
  synchronous_ = 0;
  node_.change_identifiers();
}

void Tpdos::enter_operational(can::Time now) {
  for (Tpdo& pdo : tpdos_) {
    activate(pdo, now);
    if (pdo.is_event_driven() && node_.options.send_tpdos_on_start) event(pdo, now);
  }
}

void Tpdos::leave_operational() {
  for (Tpdo& pdo : tpdos_) {
    pdo.has_event = false;
    pdo.event_due = can::never;
    schedule(pdo);
  }
}

bool Tpdos::send(Tpdo& pdo, std::uint64_t data, can::Time now) {
  if (!node_.sink.send(frame_of(pdo.head, data))) return false;
  pdo.last_data = data;
  pdo.was_sent = true;
  if (pdo.is_event_driven()) {
    const bool waited = pdo.has_event;
    pdo.has_event = false;
    if (pdo.inhibit_time != 0) pdo.inhibited_until = now + std::chrono::microseconds(pdo.inhibit_time);
    if (pdo.event_timer != 0) pdo.event_due = now + std::chrono::milliseconds(pdo.event_timer);
    if (waited || pdo.event_timer != 0) schedule(pdo);
  }
  if (node_.listener != nullptr) node_.listener->tpdo_sent(pdo.number, now);
  return true;
}

bool Tpdos::send_mpdo(Tpdo& pdo, std::uint64_t data, can::Time now) {
  if (!node_.is_operational() || !pdo.is_valid || now < pdo.inhibited_until) return false;
  if (!node_.sink.send(frame_of(pdo.head, data))) return false;
  if (pdo.inhibit_time != 0) pdo.inhibited_until = now + std::chrono::microseconds(pdo.inhibit_time);
  if (node_.listener != nullptr) node_.listener->tpdo_sent(pdo.number, now);
  return true;
}

bool Tpdos::send_to(std::uint16_t number, std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                    std::span<const std::uint8_t> value, can::Time now) {
  Tpdo* pdo = find(number);
  if (pdo == nullptr || !pdo->is_destination || node_id > 127 || value.size() > 4) {
    return false;
  }
  return send_mpdo(*pdo, mpdo_data(destination_addressing, node_id, index, sub, value), now);
}

bool Tpdos::send_from(std::uint16_t index, std::uint8_t sub, can::Time now) {
  const Entry entry = node_.dictionary.description().find(index, sub);
  if (!entry || entry.description->length == 0 || entry.description->length > 4) return false;
  if (!scanner_.holds(index, sub)) return false;
  const auto pdo = std::ranges::find_if(tpdos_, [](const Tpdo& one) { return one.is_source; });
  if (pdo == tpdos_.end()) return false;
  const auto value = node_.dictionary.bytes(entry);
  return send_mpdo(*pdo, mpdo_data(source_addressing, node_.node_id, index, sub, value), now);
}

bool Tpdos::event_with(Tpdo& pdo, std::uint64_t data, can::Time now) {
  if (!node_.is_operational() || !pdo.is_valid) return false;
  if (pdo.transmission_type == 0) {
    pdo.has_event = true;
    return true;
  }
  if (!pdo.is_event_driven()) return false;
  if (now < pdo.inhibited_until) {
    if (node_.options.dismiss_events_during_inhibit) return false;
    pdo.has_event = true;
    schedule(pdo);
    return true;
  }
  return send(pdo, data, now);
}

bool Tpdos::event(std::uint16_t number, can::Time now) {
  Tpdo* pdo = find(number);
  return pdo != nullptr && event(*pdo, now);
}

// What is sent may bring an answer that changes the lists, on a bus that is a function call: they are looked at anew
// each time.
unsigned Tpdos::values_changed(ValueMask places, can::Time now) {
  if (!node_.is_operational()) return 0;
  if (!std::exchange(all_told_, true)) places = all_values;
  unsigned events = 0;
  for (std::size_t i = synchronous_; i < valid_count_; ++i) {
    if ((valid_[i].places & places) == 0) continue;
    Tpdo& pdo = tpdos_[valid_[i].position];
    const std::uint64_t data = gather(pdo);
    if (pdo.was_sent && data == pdo.last_data) continue;
    const bool is_told = event_with(pdo, data, now);
    all_told_ = all_told_ && is_told;
    events += is_told ? 1U : 0U;
  }
  return events;
}

void Tpdos::object_written(const Entry& entry, can::Time now) {
  if (!node_.is_operational() || entry.description->length == 0) return;
  send_from(entry.index, entry.sub, now);
  for (std::size_t i = synchronous_; i < valid_count_; ++i) {
    Tpdo& pdo = tpdos_[valid_[i].position];
    if (!pdo.plan.holds(entry.offset, entry.description->length)) continue;
    if (!pdo.was_sent || gather(pdo) != pdo.last_data) event(pdo, now);
  }
}

void Tpdos::sync(std::uint8_t counter, can::Time now) {
  if (!node_.is_operational()) return;
  for (std::size_t i = 0; i < synchronous_; ++i) {
    Tpdo& pdo = tpdos_[valid_[i].position];
    const std::uint8_t type = pdo.transmission_type;
    if (type == 0 || type == rtr_synchronous || pdo.waits_for_start) {
      sync_unusual(pdo, counter, now);
      continue;
    }
    if (--pdo.syncs_left != 0) continue;
    pdo.syncs_left = type;
    send_on_sync(pdo, now);
  }
}

/// send() of a PDO that no timer concerns.
inline void Tpdos::send_on_sync(Tpdo& pdo, can::Time now) {
  const std::uint64_t data = gather(pdo);
  if (!node_.sink.send(frame_of(pdo.head, data))) return;
  pdo.last_data = data;
  pdo.was_sent = true;
  if (node_.listener != nullptr) node_.listener->tpdo_sent(pdo.number, now);
}

void Tpdos::sync_unusual(Tpdo& pdo, std::uint8_t counter, can::Time now) {
  if (pdo.transmission_type == 0) {
    if (pdo.has_event && send(pdo, gather(pdo), now)) pdo.has_event = false;
    return;
  }
  if (pdo.transmission_type == rtr_synchronous) {
    pdo.last_data = gather(pdo);
    pdo.was_sent = true;
    return;
  }
  if (counter != 0) {  // SYNC without a counter: the start value has no effect
    if (counter != pdo.sync_start) return;
    pdo.syncs_left = 1;  // this one is the first that counts, and it sends
  }
  pdo.waits_for_start = false;
  if (--pdo.syncs_left != 0) return;
  pdo.syncs_left = pdo.transmission_type;
  send_on_sync(pdo, now);
}

void Tpdos::requested(std::uint16_t position, can::Time now) {
  Tpdo& pdo = tpdos_[position];
  if (!node_.is_operational() || !pdo.is_valid || pdo.is_mpdo()) return;
  if (pdo.is_event_driven()) {
    event(pdo, now);
    return;
  }
  const bool has_sample = pdo.transmission_type == rtr_synchronous && pdo.was_sent;
  send(pdo, has_sample ? pdo.last_data : gather(pdo), now);
}

void Tpdos::tick(std::uint16_t position, can::Time now) {
  Tpdo& pdo = tpdos_[position];
  const bool inhibit_is_over = pdo.has_event && now >= pdo.inhibited_until;
  if (now >= pdo.event_due) {
    pdo.event_due = now + std::chrono::milliseconds(pdo.event_timer);
    event(pdo, now);
  } else if (inhibit_is_over && !send(pdo, gather(pdo), now)) {
    pdo.has_event = all_told_ = false;  // the queue is full: the next event tries again
  }
  schedule(pdo);
}

}  // namespace canopus::canopen
