#include "canopus/eds/communication_defaults.hpp"

#include <optional>
#include <string>

#include "canopus/ascii/hex.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/device_profile.hpp"

namespace canopus::eds {
namespace {

using canopen::CobId;
using canopen::CobIdUse;
using canopen::DataType;
using Severity = Problem::Severity;

struct Default {
  std::uint32_t value = 0;
  bool adds_node_id = false;
};

constexpr Default off{CobId::invalid_bit};

/// [CiA 301 7.5.2]
std::optional<Default> default_of(std::uint16_t index, std::uint8_t sub) {
  const unsigned pdo = index & 0x1FFU;
  switch (canopen::cob_id_use(index, sub)) {
    case CobIdUse::sync: return Default{0x80};
    case CobIdUse::time: return Default{0x100};
    case CobIdUse::emcy: return Default{0x80, true};
    case CobIdUse::rpdo: return pdo < 4 ? Default{0x200 + 0x100 * pdo, true} : off;
    case CobIdUse::tpdo: return pdo < 4 ? Default{0x180 + 0x100 * pdo, true} : off;
    case CobIdUse::emcy_consumer:
    case CobIdUse::sdo_server:
    case CobIdUse::sdo_client: return off;
    case CobIdUse::none: break;
  }
  if (index == 0x1200 && sub == 1) return Default{0x600, true};
  if (index == 0x1200 && sub == 2) return Default{0x580, true};
  if (is_communication_record(index) && sub == 2) return Default{0xFF};
  return std::nullopt;
}

std::string hexadecimal(std::uint64_t value, int digits) { return ascii::hex(value, digits) + 'H'; }

/// "$NODEID+80H", "80000000H", "FFH".
std::string shown(std::uint64_t value, bool adds_node_id, DataType type) {
  if (adds_node_id) return "$NODEID+" + hexadecimal(value, 1);
  return hexadecimal(value, static_cast<int>(2 * canopen::byte_length(type)));
}

/// "1014H", "1800:01".
std::string entry_name(const EntryFacts& facts) {
  const bool is_record = canopen::cob_id_use(facts.index, 0) == CobIdUse::none;
  return is_record ? object_text(facts.index, facts.sub) : object_name(facts.index);
}

void review(const EntryDraft& entry, std::uint32_t permitted, Problems& problems) {
  const EntryFacts& facts = entry.facts;
  const CobIdUse use = canopen::cob_id_use(facts.index, facts.sub);
  if (use == CobIdUse::none || canopen::byte_length(entry.spec.type) != 4) return;
  const auto raw = static_cast<std::uint32_t>(entry.number());
  const bool adds = entry.spec.adds_node_id;
  const bool is_pdo = use == CobIdUse::rpdo || use == CobIdUse::tpdo;
  if (is_pdo && CobId{raw}.identifier() == permitted) return;
  // With a node-ID added, wrong for the lowest and the highest one is wrong for all.
  const bool is_wrong =
      is_refused(use, CobId{raw + (adds ? 1U : 0U)}) && is_refused(use, CobId{raw + (adds ? 127U : 0U)});
  if (!is_wrong) return;
  const std::string which =
      adds ? std::string("such a CAN-ID") : "CAN-ID " + hexadecimal(CobId{raw}.identifier(), 3);
  problems.repeated(Severity::warning, "restricted", entry.value_line,
                    entry_name(facts) + " is " + shown(raw, adds, entry.spec.type) + ": CiA 301 restricts " +
                        which + ", " + consequence_of_refusal(use, facts.index));
}

}  // namespace

std::string consequence_of_refusal(CobIdUse use, std::uint16_t index) {
  const std::string number = std::to_string((index & 0x1FF) + 1);
  switch (use) {
    case CobIdUse::sync: return "SYNC is neither sent nor received";
    case CobIdUse::time: return "TIME is neither sent nor received";
    case CobIdUse::emcy: return "EMCY is not sent";
    case CobIdUse::emcy_consumer: return "that EMCY is not received";
    case CobIdUse::sdo_server: return "the SDO server does not exist";
    case CobIdUse::sdo_client: return "the SDO client does not exist";
    case CobIdUse::rpdo: return "RPDO" + number + " is not received";
    case CobIdUse::tpdo: return "TPDO" + number + " is not sent";
    case CobIdUse::none: break;
  }
  return {};
}

void set_missing_defaults(Draft& draft, Problems& problems) {
  const auto end = draft.upper_bound(0x1FFF);
  for (auto place = draft.lower_bound(0x1000); place != end; ++place) {
    for (auto& [sub, entry] : place->second.subs) {
      const auto value = default_of(place->first, sub);
      const DataType type = entry.spec.type;
      if (!value || entry.has_value || (type != DataType::unsigned32 && type != DataType::unsigned8))
        continue;
      if (canopen::byte_length(type) == 1 && value->value > 0xFF) continue;  // of a wrong type
      entry.set_number(value->value);
      entry.spec.adds_node_id = value->adds_node_id;
      const bool is_type = is_communication_record(place->first) && sub == 2;
      problems.repeated(Severity::note, is_type ? "no transmission type" : "no value", entry.facts.line,
                        entry_name(entry.facts) + " has no value: taken as " +
                            shown(value->value, value->adds_node_id, type) +
                            (is_type ? ", event-driven" : ", the default of CiA 301"));
    }
  }
}

void review_restricted_identifiers(const Draft& draft, Problems& problems) {
  std::uint32_t device_type = 0;
  if (const auto type = draft.find(0x1000); type != draft.end()) {
    if (const auto value = type->second.subs.find(0); value != type->second.subs.end())
      device_type = static_cast<std::uint32_t>(value->second.number());
  }
  const std::uint32_t permitted = canopen::permitted_pdo_identifier(device_type);
  for (const auto& [index, object] : draft) {
    for (const auto& [sub, entry] : object.subs) review(entry, permitted, problems);
  }
}

}  // namespace canopus::eds
