#include "canopus/canopen/pdo/tpdo.hpp"

#include <algorithm>
#include <utility>

namespace canopus::canopen {
namespace {

constexpr std::uint16_t first_tpdo_communication = 0x1800;
constexpr std::uint16_t first_tpdo_mapping = 0x1A00;
constexpr std::uint8_t rtr_synchronous = 0xFC;
constexpr std::uint8_t rtr_event = 0xFD;
constexpr std::uint32_t longest_value = 8;  // of fixed length, in bytes

}  // namespace

Tpdos::Tpdos(NodeContext& node) : node_(node) {
  std::size_t count = 0;
  const auto is_tpdo = [](const ObjectDescription& object) { return (object.index & 0xFE00) == 0x1800; };
  for (const auto& object : node.dictionary.description().objects()) count += is_tpdo(object) ? 1U : 0U;
  tpdos_.reserve(count);
  valid_.reserve(count);
  for (const auto& object : node.dictionary.description().objects()) {
    if (!is_tpdo(object)) continue;
    tpdos_.emplace_back().number = object.index & pdo_number_mask;
  }
  first_timer_ = node.timers.add(count);
  node.dictionary.attach(first_tpdo_communication, 0x1BFF, *this);
}

Tpdos::Tpdo* Tpdos::find(std::uint16_t index) noexcept {
  const std::uint16_t number = index & pdo_number_mask;
  const auto place = std::ranges::lower_bound(tpdos_, number, {}, &Tpdo::number);
  return place != tpdos_.end() && place->number == number ? &*place : nullptr;
}

void Tpdos::read_cob_id(Tpdo& pdo) const noexcept {
  const auto index = static_cast<std::uint16_t>(first_tpdo_communication + pdo.number);
  pdo.cob_id = usable(CobId{node_.dictionary.get<std::uint32_t>(index, 1, CobId::invalid_bit)},
                      node_.options.permitted_pdo_identifier);
  if (node_.options.tpdo_rtr_bit_is_constant) pdo.cob_id.raw |= CobId::bit_30;
}

void Tpdos::read(Tpdo& pdo) {
  const ObjectDictionary& d = node_.dictionary;
  const auto index = static_cast<std::uint16_t>(first_tpdo_communication + pdo.number);
  read_cob_id(pdo);
  pdo.transmission_type = d.get<std::uint8_t>(index, 2, 0xFF);
  pdo.inhibit_time = d.get<std::uint16_t>(index, 3);
  pdo.event_timer = d.get<std::uint16_t>(index, 5);
  pdo.sync_start = d.get<std::uint8_t>(index, 6);
  const auto mapping = static_cast<std::uint16_t>(first_tpdo_mapping + pdo.number);
  const auto count = d.get<std::uint8_t>(mapping, 0);
  pdo.addressing = count >= source_addressing ? count : std::uint8_t{0};
  if (pdo.cob_id.is_valid()) {
    pdo.plan.compile(d, mapping);
  } else {
    pdo.plan.clear();
  }
}

void Tpdos::activate(Tpdo& pdo, can::Time now) {
  all_told_ = false;
  pdo.has_event = false;
  pdo.was_sent = !node_.options.unsent_values_are_changed && pdo.cob_id.is_valid();
  if (pdo.was_sent) pdo.last_data = gather(pdo);
  pdo.inhibited_until = {};
  pdo.syncs_left = pdo.transmission_type;
  pdo.waits_for_start = pdo.sync_start != 0;
  start_timer(pdo, now);
}

void Tpdos::start_timer(Tpdo& pdo, can::Time now) {
  const bool timed = pdo.is_event_driven() && pdo.event_timer != 0;
  pdo.event_due = timed && node_.is_operational() && pdo.cob_id.is_valid()
                      ? now + std::chrono::milliseconds(pdo.event_timer)
                      : can::never;
  schedule(pdo);
}

void Tpdos::schedule(const Tpdo& pdo) {
  const bool waits = pdo.has_event && pdo.is_event_driven();
  node_.timers.set(timer(pdo), waits ? std::min(pdo.inhibited_until, pdo.event_due) : pdo.event_due);
}

void Tpdos::list_valid() {
  const auto list_if = [this](auto&& wanted) {
    for (std::size_t i = 0; i < tpdos_.size(); ++i) {
      const Tpdo& pdo = tpdos_[i];
      if (pdo.cob_id.is_valid() && wanted(pdo))
        valid_.push_back({static_cast<std::uint16_t>(i), pdo.plan.places()});
    }
  };
  valid_.clear();
  list_if([](const Tpdo& pdo) { return pdo.is_synchronous() || pdo.transmission_type == rtr_synchronous; });
  synchronous_ = static_cast<std::uint32_t>(valid_.size());
  list_if([](const Tpdo& pdo) { return pdo.may_have_events(); });
}

void Tpdos::list_watched() {
  std::uint32_t first = 0xFFFF'FFFF;
  std::uint32_t end = 0;
  bool scans = false;  // there is an MPDO in source addressing mode: everything counts
  for (const Tpdo& pdo : tpdos_) {
    scans = scans || pdo.addressing == source_addressing;
    if (!pdo.may_have_events()) continue;
    const auto [from, behind] = pdo.plan.extent();
    if (from == behind) continue;
    // A value that begins before what is mapped reaches into it with its end.
    first = std::min(first, from < longest_value ? 0 : from - longest_value);
    end = std::max(end, behind);
  }
  first_watched_ = scans ? 0 : first;
  watched_bytes_ = scans ? 0xFFFF'FFFF : end > first ? end - first : 0;
}

void Tpdos::start(std::uint8_t defaults_of, can::Time now) {
  const bool are_known = defaults_of != 0 && defaults_of == defaults_of_;
  defaults_of_ = defaults_of;
  for (Tpdo& pdo : tpdos_) {
    are_known ? read_cob_id(pdo) : read(pdo);
    complete(pdo);
    if (node_.options.tpdo_rtr_bit_is_constant) {
      const auto index = static_cast<std::uint16_t>(first_tpdo_communication + pdo.number);
      const auto raw = node_.dictionary.get<std::uint32_t>(index, 1, CobId::invalid_bit);
      node_.dictionary.set(index, 1, raw | CobId::bit_30);
    }
    activate(pdo, now);
  }
  list_valid();
  if (!are_known) list_watched();
  node_.change_identifiers();
  scanner_.start();
}

void Tpdos::stop() {
  for (Tpdo& pdo : tpdos_) {
    pdo.cob_id = {};
    pdo.has_event = false;
    pdo.event_due = can::never;
    schedule(pdo);
  }
  valid_.clear();
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
    pdo.has_event = false;
    if (pdo.inhibit_time != 0) {
      pdo.inhibited_until = now + in_steps(pdo.inhibit_time, std::chrono::microseconds(100),
                                           node_.options.inhibit_time_resolution);
    }
    if (pdo.event_timer != 0) pdo.event_due = now + std::chrono::milliseconds(pdo.event_timer);
    schedule(pdo);
  }
  if (node_.listener != nullptr) node_.listener->tpdo_sent(pdo.number, now);
  return true;
}

bool Tpdos::send_mpdo(Tpdo& pdo, std::uint64_t data, can::Time now) {
  if (!node_.is_operational() || !pdo.cob_id.is_valid() || now < pdo.inhibited_until) return false;
  if (!node_.sink.send(frame_of(pdo.head, data))) return false;
  if (pdo.inhibit_time != 0) {
    pdo.inhibited_until = now + in_steps(pdo.inhibit_time, std::chrono::microseconds(100),
                                         node_.options.inhibit_time_resolution);
  }
  if (node_.listener != nullptr) node_.listener->tpdo_sent(pdo.number, now);
  return true;
}

bool Tpdos::send_to(std::uint16_t number, std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                    std::span<const std::uint8_t> value, can::Time now) {
  Tpdo* pdo = find(number);
  if (pdo == nullptr || pdo->addressing != destination_addressing || node_id > 127 || value.size() > 4) {
    return false;
  }
  return send_mpdo(*pdo, mpdo_data(destination_addressing, node_id, index, sub, value), now);
}

bool Tpdos::send_from(std::uint16_t index, std::uint8_t sub, can::Time now) {
  const Entry entry = node_.dictionary.description().find(index, sub);
  if (!entry || entry.description->length == 0 || entry.description->length > 4) return false;
  if (!scanner_.holds(index, sub)) return false;
  const auto pdo = std::ranges::find(tpdos_, source_addressing, &Tpdo::addressing);
  if (pdo == tpdos_.end()) return false;
  const auto value = node_.dictionary.bytes(entry);
  return send_mpdo(*pdo, mpdo_data(source_addressing, node_.node_id, index, sub, value), now);
}

bool Tpdos::event_with(Tpdo& pdo, std::uint64_t data, can::Time now) {
  if (!node_.is_operational() || !pdo.cob_id.is_valid()) return false;
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
unsigned Tpdos::values_changed(Places places, can::Time now) {
  if (!node_.is_operational()) return 0;
  if (!std::exchange(all_told_, true)) places = all_places;
  unsigned events = 0;
  for (std::size_t i = synchronous_; i < valid_.size(); ++i) {
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
  for (std::size_t i = synchronous_; i < valid_.size(); ++i) {
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
  if (!node_.is_operational() || !pdo.cob_id.is_valid() || pdo.addressing != 0) return;
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

void Tpdos::list_identifiers(std::vector<IdentifierTable::Route>& routes) const {
  for (std::size_t i = 0; i < tpdos_.size(); ++i) {
    const CobId cob_id = tpdos_[i].cob_id;
    if (!cob_id.is_valid() || cob_id.has_bit_30()) continue;
    routes.push_back({IdentifierTable::key(cob_id.identifier(), cob_id.is_extended(), true),
                      ServiceKind::tpdo_request, static_cast<std::uint16_t>(i)});
  }
}

AbortCode Tpdos::before_write(ObjectDictionary& dictionary, const Entry& entry,
                              std::span<const std::uint8_t> value, can::Time) {
  const auto communication =
      static_cast<std::uint16_t>(first_tpdo_communication + (entry.index & pdo_number_mask));
  const CobId cob_id = usable(CobId{dictionary.get<std::uint32_t>(communication, 1, CobId::invalid_bit)},
                              node_.options.permitted_pdo_identifier);
  if (entry.index >= first_tpdo_mapping) {
    if (entry.sub == 0 && !value.empty() && value[0] >= source_addressing) {
      const Tpdo* self = find(entry.index);
      const bool second_source =
          value[0] == source_addressing && std::ranges::any_of(tpdos_, [&](const Tpdo& other) {
            return &other != self && other.addressing == source_addressing;
          });
      if (second_source) return AbortCode::parameter_incompatible;
      return check_mpdo(dictionary.get<std::uint8_t>(communication, 2, 0xFF), cob_id.is_valid());
    }
    return check_mapping_write(dictionary, entry, value, cob_id.is_valid(), PdoDirection::transmit);
  }
  const std::uint32_t number = can::load_u32(value);
  const bool changes = number != dictionary.get<std::uint32_t>(entry);
  const auto allowed_if = [](bool condition) {
    return condition ? AbortCode::none : AbortCode::invalid_value;
  };
  switch (entry.sub) {
    case 0: return AbortCode::write_of_read_only;
    case 1: {
      const auto type = dictionary.get<std::uint8_t>(communication, 2, 0xFF);
      if ((type == rtr_synchronous || type == rtr_event) && CobId{number}.has_bit_30() &&
          CobId{number}.is_valid()) {
        return AbortCode::invalid_value;
      }
      const CobId before = node_.options.pdo_identifiers_may_change ? CobId{} : cob_id;
      return check_change(before, CobId{number}, node_.options.extended_identifiers,
                          node_.options.permitted_pdo_identifier);
    }
    case 2:
      if (number == rtr_synchronous || number == rtr_event) {
        return allowed_if(node_.options.rtr_transmission_types && !cob_id.has_bit_30());
      }
      if (number == 0xFF) return allowed_if(node_.options.profile_event_transmission_type);
      return allowed_if(number <= 0xF0 || number == 0xFE);
    case 3: return allowed_if(!changes || !cob_id.is_valid());
    case 6: return allowed_if(number <= 240 && (!changes || !cob_id.is_valid()));
    default: return AbortCode::none;
  }
}

void Tpdos::after_write(ObjectDictionary& dictionary, const Entry& entry, can::Time now) {
  if (entry.index < first_tpdo_mapping && entry.sub == 1 && node_.options.tpdo_rtr_bit_is_constant) {
    dictionary.set(entry, dictionary.get<std::uint32_t>(entry) | CobId::bit_30);
  }
  if (node_.state == NmtState::initialising) return;
  Tpdo* pdo = find(entry.index);
  if (pdo == nullptr) return;
  const bool new_event_timer = entry.index < first_tpdo_mapping && entry.sub == 5;
  defaults_of_ = 0;
  read(*pdo);
  complete(*pdo);
  node_.change_identifiers();
  list_watched();
  if (new_event_timer) return start_timer(*pdo, now);
  activate(*pdo, now);
  list_valid();
}

}  // namespace canopus::canopen
