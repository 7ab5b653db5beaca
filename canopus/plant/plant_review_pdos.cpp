// Findings about CAN-IDs and what is sent with them.

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/service/device_profile.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/eds/communication_defaults.hpp"
#include "canopus/eds/problems.hpp"
#include "canopus/plant/plant_review.hpp"

namespace canopus::plant {

using canopen::CobId;
using canopen::CobIdUse;

namespace {

/// "183H", "00000183H" of 29 bits.
std::string can_id(CobId cob_id) {
  return cob_id.is_extended() ? fmt::format("{:08X}H", cob_id.identifier())
                              : fmt::format("{:03X}H", cob_id.identifier());
}

/// "1014H", "1800:01".
std::string entry_name(std::uint16_t index, std::uint8_t sub, CobIdUse use) {
  const bool is_variable = use == CobIdUse::sync || use == CobIdUse::time || use == CobIdUse::emcy;
  return is_variable ? eds::object_name(index) : eds::object_text(index, sub);
}

/// Calls visit(index, sub, use, value) for each COB-ID of a node.
template <typename Visit>
void for_each_cob_id(const ReviewedNode& node, Visit visit) {
  const canopen::DictionaryDescription& description = node.objects.description();
  for (const canopen::ObjectDescription& object : description.objects(0x1000, 0x1FFF)) {
    const bool has_any = canopen::cob_id_use(object.index, 0) != CobIdUse::none ||
                         canopen::cob_id_use(object.index, 1) != CobIdUse::none;
    if (!has_any) continue;
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const CobIdUse use = canopen::cob_id_use(object.index, static_cast<std::uint8_t>(sub));
      if (use == CobIdUse::none) continue;
      const canopen::Entry entry = description.find(object, static_cast<std::uint8_t>(sub));
      if (!entry || entry.description->length != 4) continue;
      visit(object.index, static_cast<std::uint8_t>(sub), use, CobId{node.objects.get<std::uint32_t>(entry)});
    }
  }
}

/// A master writes the node's objects before it starts.
bool is_configured(const ReviewedBus& bus, const ReviewedNode& node) {
  return node.node_id > 127 || bus.configured.contains(node.node_id);
}

/// Many files disable a channel by CAN-ID 000H, and a PDO by an empty mapping.
bool is_wanted(const ReviewedNode& node, std::uint16_t index, CobIdUse use, CobId value) {
  switch (use) {
    case CobIdUse::rpdo:
    case CobIdUse::tpdo: return maps_something(node, index);
    case CobIdUse::sdo_server:
    case CobIdUse::sdo_client:
    case CobIdUse::emcy_consumer: return value.identifier() != 0;
    case CobIdUse::sync:
    case CobIdUse::time:
    case CobIdUse::emcy:
    case CobIdUse::none: break;
  }
  return true;
}

/// A message that a node sends by itself.
struct Sent {
  std::uint32_t key = 0;    // its CAN-ID: CobId::key()
  std::uint16_t index = 0;  // where the node has it
  std::uint8_t sub = 0;
  std::string what;
};

std::vector<Sent> sent_by(const ReviewedNode& node) {
  std::vector<Sent> all;
  if (!node.drives) return all;
  for (const ReviewedPdo& pdo : node.pdos) {
    if (pdo.transmit) all.push_back({pdo.cob_id.key(), pdo.index, 1, name(pdo)});
  }
  const CobId emcy = canopen::usable(CobId{node.objects.get<std::uint32_t>(0x1014, 0, CobId::invalid_bit)});
  if (emcy.is_valid()) all.push_back({emcy.key(), 0x1014, 0, "EMCY"});
  if (node.produces_sync) {
    all.push_back({CobId{node.objects.get<std::uint32_t>(0x1005, 0)}.key(), 0x1005, 0, "SYNC"});
  }
  return all;
}

constexpr std::size_t most_named = 4;

/// "a, b, c, d and 3 more"
std::string listed(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), most_named);
  std::string text =
      fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (shown < names.size()) text += fmt::format(" and {} more", names.size() - shown);
  return text;
}

}  // namespace

void find_restricted_identifiers(const ReviewedBus& bus, Warnings& warnings) {
  for (const ReviewedNode& node : bus.nodes) {
    if (is_configured(bus, node)) continue;
    const std::uint32_t permitted =
        canopen::permitted_pdo_identifier(node.objects.get<std::uint32_t>(0x1000, 0));
    for_each_cob_id(node, [&](std::uint16_t index, std::uint8_t sub, CobIdUse use, CobId value) {
      const bool is_pdo = use == CobIdUse::rpdo || use == CobIdUse::tpdo;
      if (is_pdo && value.identifier() == permitted) return;
      if (!canopen::is_refused(use, value) || !is_wanted(node, index, use, value)) return;
      warnings.push_back(
          {place_of(node, index, sub),
           fmt::format("{}: {} is {:08X}H, and CiA 301 restricts CAN-ID {}: {}; objects can give it another",
                       node.name, entry_name(index, sub, use), value.raw, can_id(value),
                       eds::consequence_of_refusal(use, index))});
    });
  }
}

void find_missing_sync(const ReviewedBus& bus, Warnings& warnings) {
  constexpr std::uint8_t highest_synchronous = 240;
  constexpr std::uint8_t event_driven = 255;
  std::set<std::uint32_t> produced;  // by CAN-ID
  std::set<std::uint32_t> sent;      // as PDO
  for (const ReviewedNode& node : bus.nodes) {
    if (node.produces_sync) produced.insert(CobId{node.objects.get<std::uint32_t>(0x1005, 0)}.key());
    for (const ReviewedPdo& pdo : node.pdos) {
      if (pdo.transmit) sent.insert(pdo.cob_id.key());
    }
  }
  // A master may make any node that it configures a producer.
  const bool is_known = !has_unknown_senders(bus) && bus.configured.empty();
  for (const ReviewedNode& node : bus.nodes) {
    if (is_configured(bus, node)) continue;
    const bool has_sync = node.objects.description().find(0x1005) != nullptr;
    const CobId sync{node.objects.get<std::uint32_t>(0x1005, 0)};
    if (has_sync && (!is_known || produced.contains(sync.key()))) continue;
    std::vector<std::string> waiting;
    text::Place place = node.place;
    for (const ReviewedPdo& pdo : node.pdos) {
      if (pdo.transmission_type > highest_synchronous) continue;
      if (!pdo.transmit && !sent.contains(pdo.cob_id.key())) continue;
      if (waiting.empty()) place = place_of(node, pdo.index, 2);
      waiting.push_back(
          fmt::format("{} ({} = {})", name(pdo), canopen::object_text(pdo.index, 2), pdo.transmission_type));
    }
    if (waiting.empty()) continue;
    std::string why;
    if (!has_sync) {
      why = fmt::format(
          "its file has no 1005H, so it never receives it: transmission type {} works without SYNC",
          event_driven);
    } else {
      why = fmt::format(
          "no node on bus \"{}\" produces it{}: a producer has bit 30 of 1005H and 1006H set, and "
          "transmission type {} works without SYNC",
          bus.name, produced.empty() ? "" : fmt::format(" with CAN-ID {}, its 1005H", can_id(sync)),
          event_driven);
    }
    warnings.push_back({place, fmt::format("{}: {} {} for SYNC, but {}", node.name, listed(waiting),
                                           waiting.size() == 1 ? "waits" : "wait", why)});
  }
}

void find_two_senders(const ReviewedBus& bus, Warnings& warnings) {
  struct Sender {
    const ReviewedNode* node;
    Sent sent;
  };
  std::map<std::uint32_t, Sender> senders;
  for (const ReviewedNode& node : bus.nodes) {
    if (is_configured(bus, node)) continue;
    for (const Sent& sent : sent_by(node)) {
      const auto [place, is_new] = senders.try_emplace(sent.key, Sender{&node, sent});
      const Sender& first = place->second;
      if (is_new || first.node == &node) continue;
      const bool both_sync = sent.index == 0x1005 && first.sent.index == 0x1005;
      const std::string_view consequence =
          both_sync
              ? "the others receive it twice; clear bit 30 of one 1005H"
              : "receivers cannot distinguish them, and frames at one moment destroy each other; give each "
                "a CAN-ID of its own";
      warnings.push_back(
          {place_of(node, sent.index, sent.sub),
           fmt::format("{}: {} ({}) has CAN-ID {}, and {} of {} (line {}) has it, too: {}", node.name,
                       sent.what, eds::object_text(sent.index, sent.sub), can_id(CobId{sent.key}),
                       first.sent.what, first.node->name, first.node->place.line, consequence)});
    }
  }
}

void find_cob_ids_of_another_node(const ReviewedBus& bus, Warnings& warnings) {
  for (const ReviewedNode& node : bus.nodes) {
    if (node.file == nullptr || is_configured(bus, node)) continue;
    if (is_dcf_for(node)) continue;  // a fixed value there is intended
    const auto& commissioning = node.file->commissioning;
    const unsigned made_for = commissioning ? commissioning->node_id.value_or(0) : 0;  // 0: an EDS
    std::set<std::uint16_t> used = {0x1014};
    for (const ReviewedPdo& pdo : node.pdos) used.insert(pdo.index);
    std::vector<std::string> wrong;
    std::set<std::uint32_t> others;
    for_each_cob_id(node, [&](std::uint16_t index, std::uint8_t sub, CobIdUse use, CobId value) {
      const unsigned pdo = index & 0x1FFU;
      std::uint32_t base = 0;
      if (use == CobIdUse::emcy) base = 0x80;
      if (use == CobIdUse::tpdo && pdo < 4) base = 0x180 + 0x100 * pdo;
      if (use == CobIdUse::rpdo && pdo < 4) base = 0x200 + 0x100 * pdo;
      if (base == 0 || !used.contains(index) || !value.is_valid() || value.is_extended()) return;
      const std::uint32_t id = value.identifier();
      if (id <= base || id > base + 127 || id == base + node.node_id) return;
      const bool by_file = eds::default_value(*node.file->dictionary, index, sub, node.node_id) == value.raw;
      if (!by_file || is_set_by_plant_file(node, index, sub)) return;  // set on purpose, or stored
      others.insert(id - base);
      wrong.push_back(fmt::format("{} = {}", entry_name(index, sub, use), can_id(value)));
    });
    if (wrong.empty()) continue;
    warnings.push_back(
        {node.device->eds_place,
         fmt::format("{}: {} {} for node {} in the pre-defined connection set{}; objects can give it its own",
                     node.name, listed(wrong), wrong.size() == 1 ? "is" : "are", fmt::join(others, ", "),
                     made_for != 0 ? fmt::format(": the DCF was made for node {}", made_for)
                                   : ": the file has fixed numbers where $NODEID is usual")});
  }
}

}  // namespace canopus::plant
