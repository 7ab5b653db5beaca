#include "canopus/canopen/pdo/rpdo.hpp"

#include "canopus/canopen/pdo/pdo_list.hpp"
#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {
namespace {

constexpr std::uint16_t first_rpdo_communication = 0x1400;
constexpr std::uint16_t first_rpdo_mapping = 0x1600;

}  // namespace

Rpdos::Rpdos(NodeContext& node) : node_(node) {
  make_pdos(rpdos_, node.dictionary.description(), first_rpdo_communication);
  first_timer_ = node.timers.add(rpdos_.size());
  node.dictionary.attach(first_rpdo_communication, 0x17FF, *this);
}

Rpdos::Rpdo* Rpdos::find(std::uint16_t index) noexcept { return find_pdo(rpdos_, index); }

CobId Rpdos::read_cob_id(const Rpdo& pdo) const noexcept {
  const auto index = static_cast<std::uint16_t>(first_rpdo_communication + pdo.number);
  return usable(CobId{node_.dictionary.get<std::uint32_t>(index, 1, CobId::invalid_bit)},
                node_.options.permitted_pdo_identifier);
}

void Rpdos::read(Rpdo& pdo) {
  const ObjectDictionary& d = node_.dictionary;
  const auto index = static_cast<std::uint16_t>(first_rpdo_communication + pdo.number);
  pdo.cob_id = read_cob_id(pdo);
  pdo.transmission_type = d.get<std::uint8_t>(index, 2, 0xFF);
  const bool has_timer = pdo.transmission_type > 240 || !node_.options.rpdo_timer_for_events_alone;
  pdo.event_timer = has_timer ? d.get<std::uint16_t>(index, 5) : std::uint16_t{0};
  pdo.is_waiting = false;
  const auto mapping = static_cast<std::uint16_t>(first_rpdo_mapping + pdo.number);
  const auto count = d.get<std::uint8_t>(mapping, 0);
  pdo.addressing = count >= source_addressing ? count : std::uint8_t{0};
  pdo.watched = pdo.event_timer != 0 || pdo.addressing != 0;
  if (pdo.cob_id.is_valid()) {
    pdo.plan.compile(d, mapping);
  } else {
    pdo.plan.clear();
  }
  node_.timers.stop(timer(pdo));
  node_.change_identifiers();
}

void Rpdos::start(std::uint8_t defaults_of) {
  const bool are_known = defaults_of != 0 && defaults_of == defaults_of_;
  defaults_of_ = defaults_of;
  for (Rpdo& pdo : rpdos_) {
    if (are_known) {
      pdo.cob_id = read_cob_id(pdo);
      pdo.is_waiting = false;
    } else {
      read(pdo);
    }
    pdo.error_count = 0;
    pdo.length_error = false;
    pdo.timed_out = false;
    classify(pdo);
  }
  any_waiting_ = false;
  node_.change_identifiers();
  mpdo_consumer_.start();
}

void Rpdos::stop() {
  for (Rpdo& pdo : rpdos_) {
    pdo.cob_id = {};
    node_.timers.stop(timer(pdo));
  }
  node_.change_identifiers();
}

void Rpdos::leave_operational() {
  for (Rpdo& pdo : rpdos_) {
    pdo.is_waiting = false;
    node_.timers.stop(timer(pdo));
  }
  any_waiting_ = false;
}

void Rpdos::apply(Rpdo& pdo, const can::Frame& frame, can::Time window_end, can::Time now) {
  if (pdo.transmission_type <= 240) return wait_for_sync(pdo, frame, window_end, now);
  pdo.plan.scatter(std::bit_cast<std::uint64_t>(frame.data), node_.dictionary.block().data());
  if (node_.listener != nullptr) node_.listener->rpdo_received(pdo.number, now);
}

void Rpdos::receive_other(Rpdo& pdo, const can::Frame& frame, can::Time window_end, can::Time now) {
  if (pdo.watched || pdo.error_count != 0 || frame.dlc != pdo.plan.length()) {
    return receive_unusual(pdo, frame, window_end, now);
  }
  apply(pdo, frame, window_end, now);
}

void Rpdos::receive_unusual(Rpdo& pdo, const can::Frame& frame, can::Time window_end, can::Time now) {
  if (pdo.addressing != 0) {
    if (mpdo_consumer_.receive(frame, pdo.addressing, now) && node_.listener != nullptr) {
      node_.listener->rpdo_received(pdo.number, now);
    }
    return;
  }
  const bool too_short = frame.length() < pdo.plan.length();
  const bool fits = frame.length() == pdo.plan.length();
  if (pdo.watched && !too_short) {
    node_.timers.set(timer(pdo), now + std::chrono::milliseconds(pdo.event_timer));
    if (pdo.timed_out) {
      pdo.timed_out = false;
      --pdo.error_count;
      node_.error_ended(time_out_of(pdo), now);
    }
  }
  if (fits == pdo.length_error) {
    pdo.length_error = !fits;
    fits ? --pdo.error_count : ++pdo.error_count;
    const CommunicationError error{.code = too_short ? emcy_code::pdo_too_short : emcy_code::pdo_too_long};
    fits ? node_.error_ended(error, now) : node_.error_began(error, now);
  }
  if (!fits && node_.listener != nullptr) {
    node_.listener->rpdo_length_wrong(pdo.number,
                                      too_short ? emcy_code::pdo_too_short : emcy_code::pdo_too_long, now);
  }
  classify(pdo);
  if (!too_short) apply(pdo, frame, window_end, now);
}

void Rpdos::sync(can::Time now) {
  if (!any_waiting_) return;
  any_waiting_ = false;
  for (Rpdo& pdo : rpdos_) {
    if (!pdo.is_waiting) continue;
    pdo.is_waiting = false;
    pdo.plan.scatter(pdo.waiting_data, node_.dictionary.block().data());
    if (node_.listener != nullptr) node_.listener->rpdo_received(pdo.number, now);
  }
}

CommunicationError Rpdos::time_out_of(const Rpdo& pdo) const noexcept {
  CommunicationError error{.code = emcy_code::rpdo_time_out};
  if (!node_.options.rpdo_time_out_names_pdo) return error;
  const unsigned number = pdo.number + 1U;
  error.manufacturer = {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8), 'O', 'D',
                        'P'};
  return error;
}

void Rpdos::tick(std::uint16_t position, can::Time now) {
  Rpdo& pdo = rpdos_[position];
  pdo.timed_out = true;
  ++pdo.error_count;
  classify(pdo);
  const std::uint16_t number = pdo.number;
  node_.error_began(time_out_of(pdo), now);
  if (node_.listener != nullptr) node_.listener->rpdo_timed_out(number, now);
}

void Rpdos::list_identifiers(std::vector<IdentifierTable::Route>& routes) const {
  for (std::size_t i = 0; i < rpdos_.size(); ++i) {
    const CobId cob_id = rpdos_[i].cob_id;
    if (!cob_id.is_valid()) continue;
    routes.push_back({IdentifierTable::key(cob_id.identifier(), cob_id.is_extended(), false),
                      ServiceKind::rpdo, static_cast<std::uint16_t>(i)});
  }
}

AbortCode Rpdos::before_write(ObjectDictionary& dictionary, const Entry& entry,
                              std::span<const std::uint8_t> value, can::Time) {
  const auto communication =
      static_cast<std::uint16_t>(first_rpdo_communication + (entry.index & pdo_number_mask));
  const CobId cob_id = usable(CobId{dictionary.get<std::uint32_t>(communication, 1, CobId::invalid_bit)},
                              node_.options.permitted_pdo_identifier);
  if (entry.index >= first_rpdo_mapping) {
    const auto type = dictionary.get<std::uint8_t>(communication, 2, 0xFF);
    if (entry.sub == 0 && !value.empty() && value[0] >= source_addressing) {
      return check_mpdo(type, cob_id.is_valid());
    }
    return check_mapping_write(dictionary, entry, value, cob_id.is_valid(), PdoDirection::receive);
  }
  switch (entry.sub) {
    case 0: return AbortCode::write_of_read_only;
    case 1: {
      if (node_.options.reserved_bit_30_is_zero && CobId::from(value).has_bit_30())
        return AbortCode::invalid_value;
      const CobId before = node_.options.pdo_identifiers_may_change ? CobId{} : cob_id;
      return check_change(before, CobId::from(value), node_.options.extended_identifiers,
                          node_.options.permitted_pdo_identifier);
    }
    case 2: {
      const std::uint32_t type = can::load_u32(value);
      if (type == 0xFF && !node_.options.profile_event_transmission_type) return AbortCode::invalid_value;
      return type > 0xF0 && type < 0xFE ? AbortCode::invalid_value : AbortCode::none;
    }
    default: return AbortCode::none;
  }
}

void Rpdos::forget_errors(Rpdo& pdo, can::Time now) {
  for (; pdo.error_count != 0; --pdo.error_count) node_.error_ended({}, now);
  pdo.length_error = false;
  pdo.timed_out = false;
  classify(pdo);
}

void Rpdos::after_write(ObjectDictionary&, const Entry& entry, can::Time now) {
  if (node_.state == NmtState::initialising) return;
  Rpdo* pdo = find(entry.index);
  if (pdo == nullptr) return;
  defaults_of_ = 0;
  read(*pdo);
  forget_errors(*pdo, now);
}

}  // namespace canopus::canopen
