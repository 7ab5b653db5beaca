// What TPDOs are configured to do.

#include <algorithm>
#include <memory>

#include "canopus/canopen/pdo/pdo_list.hpp"
#include "canopus/canopen/pdo/tpdo.hpp"

namespace canopus::canopen {
namespace {

constexpr std::uint16_t first_tpdo_communication = 0x1800;
constexpr std::uint16_t first_tpdo_mapping = 0x1A00;
constexpr std::uint8_t rtr_event = 0xFD;
constexpr std::uint32_t longest_value = 8;  // of fixed length, in bytes

}  // namespace

Tpdos::Tpdos(NodeContext& node) : node_(node) {
  valid_ = few_valid_.data();
  make_pdos(tpdos_, node.dictionary.description(), first_tpdo_communication);
  first_timer_ = node.timers.add(tpdos_.size());
  node.dictionary.attach(first_tpdo_communication, 0x1BFF, *this);
}

Tpdos::Tpdo* Tpdos::find(std::uint16_t index) noexcept { return find_pdo(tpdos_, index); }

CobId Tpdos::cob_id_of(std::uint16_t number) const noexcept {
  const auto index = static_cast<std::uint16_t>(first_tpdo_communication + number);
  return usable(CobId{node_.dictionary.get<std::uint32_t>(index, 1, CobId::invalid_bit)},
                node_.options.permitted_pdo_identifier);
}

void Tpdos::complete(Tpdo& pdo, CobId cob_id) const noexcept {
  pdo.is_valid = cob_id.is_valid() && (pdo.is_mpdo() || pdo.plan.length() != 0);
  pdo.answers_requests = !cob_id.has_bit_30() && !node_.options.tpdo_rtr_bit_is_constant;
  pdo.head = {cob_id.key(), pdo.is_mpdo() ? std::uint8_t{8} : pdo.plan.length()};
}

void Tpdos::read(Tpdo& pdo) {
  const ObjectDictionary& d = node_.dictionary;
  const auto index = static_cast<std::uint16_t>(first_tpdo_communication + pdo.number);
  pdo.transmission_type = d.get<std::uint8_t>(index, 2, 0xFF);
  const can::Duration inhibit_time = in_steps(d.get<std::uint16_t>(index, 3), std::chrono::microseconds(100),
                                              node_.options.inhibit_time_resolution);
  pdo.inhibit_time = static_cast<std::uint32_t>(inhibit_time / std::chrono::microseconds(1));
  pdo.event_timer = d.get<std::uint16_t>(index, 5);
  pdo.sync_start = d.get<std::uint8_t>(index, 6);
  const auto mapping = static_cast<std::uint16_t>(first_tpdo_mapping + pdo.number);
  const auto count = d.get<std::uint8_t>(mapping, 0);
  pdo.is_source = count == source_addressing;
  pdo.is_destination = count == destination_addressing;
  const CobId cob_id = cob_id_of(pdo.number);
  if (cob_id.is_valid()) {
    pdo.plan.compile(d, mapping);
  } else {
    pdo.plan.clear();
  }
  complete(pdo, cob_id);
}

void Tpdos::add_valid(Valid valid) {
  if (valid_ == few_valid_.data() && valid_count_ == few_valid_.size()) {
    more_valid_ = std::make_unique<Valid[]>(2 * tpdos_.size());  // of type 0 they are in both parts
    std::ranges::copy(few_valid_, more_valid_.get());
    valid_ = more_valid_.get();
  }
  valid_[valid_count_++] = valid;
}

void Tpdos::list_valid() {
  const auto list_if = [this](auto&& wanted) {
    for (std::size_t i = 0; i < tpdos_.size(); ++i) {
      const Tpdo& pdo = tpdos_[i];
      if (pdo.is_valid && wanted(pdo)) add_valid({static_cast<std::uint16_t>(i), pdo.plan.places()});
    }
  };
  valid_count_ = 0;
  list_if([](const Tpdo& pdo) { return pdo.is_synchronous() || pdo.transmission_type == rtr_synchronous; });
  synchronous_ = valid_count_;
  list_if([](const Tpdo& pdo) { return pdo.may_have_events(); });
}

void Tpdos::list_watched() {
  std::uint32_t first = 0xFFFF'FFFF;
  std::uint32_t end = 0;
  bool scans = false;  // there is an MPDO in source addressing mode: everything counts
  for (const Tpdo& pdo : tpdos_) {
    scans = scans || pdo.is_source;
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
    are_known ? complete(pdo, cob_id_of(pdo.number)) : read(pdo);
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

void Tpdos::list_identifiers(std::vector<IdentifierTable::Route>& routes) const {
  for (std::size_t i = 0; i < tpdos_.size(); ++i) {
    const Tpdo& pdo = tpdos_[i];
    if (!pdo.is_valid || !pdo.answers_requests) continue;
    routes.push_back({IdentifierTable::key(pdo.head.identifier(), pdo.head.is_extended(), true),
                      ServiceKind::tpdo_request, static_cast<std::uint16_t>(i)});
  }
}

AbortCode Tpdos::before_write(ObjectDictionary& dictionary, const Entry& entry,
                              std::span<const std::uint8_t> value, can::Time) {
  const auto communication =
      static_cast<std::uint16_t>(first_tpdo_communication + (entry.index & pdo_number_mask));
  const CobId cob_id = cob_id_of(entry.index & pdo_number_mask);
  if (entry.index >= first_tpdo_mapping) {
    if (entry.sub == 0 && !value.empty() && value[0] >= source_addressing) {
      const Tpdo* self = find(entry.index);
      const bool second_source =
          value[0] == source_addressing &&
          std::ranges::any_of(tpdos_, [&](const Tpdo& other) { return &other != self && other.is_source; });
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
  node_.change_identifiers();
  list_watched();
  if (new_event_timer) return start_timer(*pdo, now);
  activate(*pdo, now);
  list_valid();
}

}  // namespace canopus::canopen
