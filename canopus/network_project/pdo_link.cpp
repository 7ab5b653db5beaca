#include "canopus/network_project/pdo_link.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"

namespace canopus::network_project {
namespace {

using canopen::CobId;
using canopen::DataType;

constexpr unsigned most_bits = 64;

struct Signal {
  const ProjectNode* node;
  canopen::Entry entry;
  MappedObject object;

  [[nodiscard]] std::string shown_name() const {
    return fmt::format("{}: {} ({})", node->shown_name(), eds::object_text(entry.index, entry.sub),
                       eds::printable(object_title(*node->device, entry)));
  }
};

std::expected<Signal, std::string> find_signal(const NetworkProject& project, const SignalEnd& end,
                                               bool transmit) {
  const ProjectNode* node = project.find(end.node_id);
  if (node == nullptr) return std::unexpected(fmt::format("the project has no node {}", end.node_id));
  if (node->device == nullptr)
    return std::unexpected(fmt::format("{}: {}", node->shown_name(), node->trouble()));
  const canopen::Entry entry = node->device->dictionary->find(end.index, end.sub);
  if (!entry) {
    return std::unexpected(
        fmt::format("{} has no {}", node->shown_name(), eds::object_text(end.index, end.sub)));
  }
  const unsigned bits = canopen::bit_length(entry.description->type);
  Signal signal{node, entry, {end.index, end.sub, static_cast<std::uint8_t>(bits)}};
  if (bits == 0) return std::unexpected(signal.shown_name() + " has no fixed length, so no PDO holds it");
  const bool is_mappable = transmit ? entry.description->tpdo_mappable : entry.description->rpdo_mappable;
  if (!is_mappable) {
    return std::unexpected(fmt::format("{} cannot be mapped into {} by its device file", signal.shown_name(),
                                       transmit ? "a TPDO" : "an RPDO"));
  }
  return signal;
}

/// The first bit of an object in a PDO, or nothing.
std::optional<unsigned> position_of(const Pdo& pdo, const MappedObject& wanted) {
  unsigned bit = 0;
  for (const MappedObject& object : pdo.mapping) {
    if (object == wanted) return bit;
    bit += object.bits;
  }
  return std::nullopt;
}

struct Dummy {
  DataType type;
  DataType instead;
};
constexpr std::array dummies = {
    Dummy{DataType::unsigned32, DataType::integer32}, Dummy{DataType::unsigned16, DataType::integer16},
    Dummy{DataType::unsigned8, DataType::integer8}, Dummy{DataType::boolean, DataType::boolean}};

/// Fills a mapping with unused bits up to `bit`; false: the device does not take them.
bool fill_up(std::vector<MappedObject>& mapping, unsigned gap, std::uint32_t usage) {
  while (gap != 0) {
    const auto fits = std::ranges::find_if(dummies, [&](const Dummy& dummy) {
      const bool is_allowed =
          ((usage >> static_cast<unsigned>(dummy.type) | usage >> static_cast<unsigned>(dummy.instead)) &
           1U) != 0;
      return is_allowed && canopen::bit_length(dummy.type) <= gap;
    });
    if (fits == dummies.end()) return false;
    const bool is_first = (usage >> static_cast<unsigned>(fits->type) & 1U) != 0;
    const DataType type = is_first ? fits->type : fits->instead;
    const unsigned bits = canopen::bit_length(type);
    mapping.push_back({static_cast<std::uint16_t>(type), 0, static_cast<std::uint8_t>(bits)});
    gap -= bits;
  }
  return true;
}

/// Every CAN-ID of 11 bits that a node of the project uses or that its services will be found under.
std::set<std::uint32_t> used_can_ids(const NetworkProject& project) {
  std::set<std::uint32_t> used;
  for (const ProjectNode& node : project.nodes()) {
    for (const Pdo& pdo : node.pdos) {
      if (pdo.is_active()) used.insert(pdo.cob_id.key());
    }
    for (const std::uint16_t index : std::array<std::uint16_t, 3>{0x1005, 0x1012, 0x1014}) {
      const auto value = node.value(index);
      if (value) used.insert(CobId{static_cast<std::uint32_t>(*value)}.key());
    }
    used.insert(0x80U + node.id());
  }
  return used;
}

bool is_unused(const Pdo& pdo) { return !pdo.is_active() && pdo.can_change_mapping; }

/// The ways of a link, each a producer's PDO as it would be.
struct Offer {
  const Pdo* before;
  Pdo after;
  unsigned first_bit;
};

class Linker {
 public:
  Linker(const NetworkProject& project, const Signal& from, const Signal& to)
      : project_(project), from_(from), to_(to) {}

  /// The best way that works; else why none does.
  std::expected<std::vector<PdoChange>, std::string> plan() {
    std::string why;
    for (const Offer& offer : offers()) {
      const auto taken = accept(offer);
      if (!taken) {
        if (why.empty()) why = taken.error();
        continue;
      }
      std::vector<PdoChange> changes;
      add(changes, from_.node->id(), *offer.before, offer.after);
      add(changes, to_.node->id(), *taken->first, taken->second);
      return changes;
    }
    if (!why.empty()) return std::unexpected(std::move(why));
    return std::unexpected(
        fmt::format("{} has no TPDO left: none that is not in use, and none with room for {} whose mapping "
                    "can be changed",
                    from_.node->shown_name(), ascii::counted(from_.object.bits, "bit")));
  }

 private:
  static void add(std::vector<PdoChange>& changes, std::uint8_t node_id, const Pdo& before,
                  const Pdo& after) {
    const bool is_same = before.cob_id.raw == after.cob_id.raw && before.mapping == after.mapping;
    if (!is_same) changes.push_back({node_id, before, after});
  }

  [[nodiscard]] const Pdo* rpdo_with(const ProjectNode& node, CobId cob_id) const {
    const auto found = std::ranges::find_if(node.pdos, [&](const Pdo& pdo) {
      return !pdo.transmit && pdo.is_active() && pdo.cob_id.key() == cob_id.key();
    });
    return found == node.pdos.end() ? nullptr : &*found;
  }
  [[nodiscard]] bool has_room(const Pdo& pdo) const {
    return pdo.is_active() && pdo.can_change_mapping && pdo.mapping.size() < pdo.most_objects &&
           pdo.bits() + from_.object.bits <= most_bits;
  }
  [[nodiscard]] Offer appended(const Pdo& pdo) const {
    Offer offer{&pdo, pdo, pdo.bits()};
    offer.after.mapping.push_back(from_.object);
    return offer;
  }

  [[nodiscard]] std::vector<Offer> offers() const {
    std::vector<Offer> mapped;
    std::vector<Offer> shared;  // with what that node takes already
    std::vector<Offer> fresh;
    std::vector<Offer> others;
    for (const Pdo& pdo : from_.node->pdos) {
      if (!pdo.transmit) continue;
      if (const auto bit = position_of(pdo, from_.object); bit && pdo.is_active()) {
        mapped.push_back({&pdo, pdo, *bit});
      } else if (has_room(pdo)) {
        (rpdo_with(*to_.node, pdo.cob_id) != nullptr ? shared : others).push_back(appended(pdo));
      } else if (is_unused(pdo)) {
        if (auto offer = made_of(pdo)) fresh.push_back(std::move(*offer));
      }
    }
    for (auto* more : {&shared, &fresh, &others}) std::ranges::move(*more, std::back_inserter(mapped));
    return mapped;
  }

  /// A TPDO that was not in use.
  [[nodiscard]] std::optional<Offer> made_of(const Pdo& pdo) const {
    Offer offer{&pdo, pdo, 0};
    offer.after.mapping = {from_.object};
    const auto used = used_can_ids(project_);
    CobId& cob_id = offer.after.cob_id;
    cob_id.raw &= ~CobId::invalid_bit;
    const auto is_good = [&](CobId one) {
      return one.identifier() != 0 && !canopen::is_restricted(one) && !used.contains(one.key());
    };
    if (is_good(cob_id))
      return offer.after.cob_id.raw == pdo.cob_id.raw || pdo.can_change_cob_id ? std::optional(offer)
                                                                               : std::nullopt;
    if (!pdo.can_change_cob_id) return std::nullopt;
    const std::uint32_t predefined = 0x80U + 0x100U * pdo.number + from_.node->id();
    const std::uint32_t flags = pdo.cob_id.raw & CobId::bit_30;
    cob_id.raw = flags | predefined;
    if (pdo.number <= 4 && is_good(cob_id)) return offer;
    cob_id.raw = flags | free_can_id(project_, from_.node->id());
    return is_good(cob_id) ? std::optional(offer) : std::nullopt;
  }

  using Taken = std::pair<const Pdo*, Pdo>;

  [[nodiscard]] std::string refusal(const Pdo& pdo, std::string_view why) const {
    return fmt::format("{}: {} {}", to_.node->shown_name(), pdo.name(), why);
  }

  /// The RPDO with the signal behind what it has.
  [[nodiscard]] std::expected<Taken, std::string> extended(const Pdo& pdo, Pdo after,
                                                           unsigned first_bit) const {
    const unsigned bits = after.bits();
    if (bits > first_bit) {
      return std::unexpected(refusal(
          pdo, fmt::format("takes something else at bit {} of {}", first_bit, describe_can_id(pdo.cob_id))));
    }
    if (!pdo.can_change_mapping) return std::unexpected(refusal(pdo, "has a fixed mapping"));
    if (!fill_up(after.mapping, first_bit - bits, to_.node->device->dummy_usage)) {
      return std::unexpected(refusal(pdo, fmt::format("cannot leave {} before the signal unused: "
                                                      "[DummyUsage] of its file allows none that fit",
                                                      ascii::counted(first_bit - bits, "bit"))));
    }
    after.mapping.push_back(to_.object);
    if (after.mapping.size() > pdo.most_objects) {
      return std::unexpected(
          refusal(pdo, fmt::format("maps at most {}", ascii::counted(pdo.most_objects, "object"))));
    }
    return Taken{&pdo, std::move(after)};
  }

  [[nodiscard]] std::expected<Taken, std::string> accept(const Offer& offer) const {
    const CobId cob_id = offer.after.cob_id;
    // One that has the frame already.
    if (const Pdo* own = rpdo_with(*to_.node, cob_id); own != nullptr) {
      if (position_of(*own, to_.object) == offer.first_bit) return Taken{own, *own};
      return extended(*own, *own, offer.first_bit);
    }
    // One that is not in use; else one whose frame no node of the project sends, the last of them: a master that is not
    // in the project rather uses the first ones.
    std::vector<const Pdo*> free;
    std::vector<const Pdo*> waiting;
    for (const Pdo& pdo : to_.node->pdos) {
      if (pdo.transmit || !pdo.can_change_cob_id || !pdo.can_change_mapping) continue;
      if (!pdo.is_active()) free.push_back(&pdo);
      if (pdo.is_active() && !is_sent(pdo.cob_id)) waiting.insert(waiting.begin(), &pdo);
    }
    std::ranges::copy(waiting, std::back_inserter(free));
    std::string why;
    for (const Pdo* pdo : free) {
      Pdo after = *pdo;
      after.cob_id.raw = cob_id.key();
      after.mapping.clear();
      auto taken = extended(*pdo, std::move(after), offer.first_bit);
      if (taken) return taken;
      if (why.empty()) why = taken.error();
    }
    if (!why.empty()) return std::unexpected(std::move(why));
    return std::unexpected(
        fmt::format("{} has no RPDO left whose COB-ID and mapping can be changed", to_.node->shown_name()));
  }

  /// A node of the project sends it.
  [[nodiscard]] bool is_sent(CobId cob_id) const {
    return std::ranges::any_of(project_.nodes(), [&](const ProjectNode& node) {
      return std::ranges::any_of(node.pdos, [&](const Pdo& pdo) {
        return pdo.transmit && pdo.is_active() && pdo.cob_id.key() == cob_id.key();
      });
    });
  }

  const NetworkProject& project_;
  const Signal& from_;
  const Signal& to_;
};

}  // namespace

std::uint32_t free_can_id(const NetworkProject& project, std::uint8_t node_id) {
  const auto used = used_can_ids(project);
  const auto is_free = [&](std::uint32_t id) {
    return !used.contains(id) && !canopen::is_restricted_identifier(id);
  };
  constexpr std::uint32_t first = 0x181;
  constexpr std::uint32_t last = 0x57F;
  for (std::uint32_t base = 0x180; base <= 0x500; base += 0x80) {
    if (is_free(base + node_id)) return base + node_id;
  }
  for (std::uint32_t id = first; id <= last; ++id) {
    if (is_free(id)) return id;
  }
  return 0;
}

std::vector<SignalLink> find_links(const NetworkProject& project) {
  struct Taker {
    const ProjectNode* node;
    const Pdo* pdo;
  };
  std::multimap<std::uint32_t, Taker> takers;
  for (const ProjectNode& node : project.nodes()) {
    for (const Pdo& pdo : node.pdos) {
      if (!pdo.transmit && pdo.is_active() && node.listed.present)
        takers.emplace(pdo.cob_id.key(), Taker{&node, &pdo});
    }
  }
  std::vector<SignalLink> links;
  for (const ProjectNode& node : project.nodes()) {
    if (!node.listed.present) continue;
    for (const Pdo& pdo : node.pdos) {
      if (!pdo.transmit || !pdo.is_active()) continue;
      const auto [begin, end] = takers.equal_range(pdo.cob_id.key());
      for (auto taker = begin; taker != end; ++taker) {
        if (taker->second.node == &node) continue;
        unsigned bit = 0;
        for (const MappedObject& object : pdo.mapping) {
          unsigned other_bit = 0;
          for (const MappedObject& other : taker->second.pdo->mapping) {
            if (other_bit == bit && other.bits == object.bits && !other.is_dummy() && !object.is_dummy()) {
              links.push_back({.from = {node.id(), object.index, object.sub},
                               .to = {taker->second.node->id(), other.index, other.sub},
                               .tpdo = pdo.number,
                               .rpdo = taker->second.pdo->number,
                               .cob_id = pdo.cob_id,
                               .first_bit = bit,
                               .bits = object.bits});
            }
            other_bit += other.bits;
          }
          bit += object.bits;
        }
      }
    }
  }
  return links;
}

std::expected<std::vector<PdoChange>, std::string> link_signals(NetworkProject& project,
                                                                const SignalEnd& from, const SignalEnd& to) {
  if (from.node_id == to.node_id) return std::unexpected("a node cannot send a signal to itself");
  const auto sent = find_signal(project, from, true);
  if (!sent) return std::unexpected(sent.error());
  const auto taken = find_signal(project, to, false);
  if (!taken) return std::unexpected(taken.error());
  if (sent->object.bits != taken->object.bits) {
    return std::unexpected(fmt::format("{} has {}, {} has {}", sent->shown_name(),
                                       ascii::counted(sent->object.bits, "bit"), taken->shown_name(),
                                       taken->object.bits));
  }
  auto changes = Linker(project, *sent, *taken).plan();
  if (!changes) return changes;
  NetworkProject changed = project;
  for (const PdoChange& change : *changes) {
    if (auto done = changed.set_pdo(change.node_id, change.after); !done)
      return std::unexpected(done.error());
  }
  project = std::move(changed);
  return changes;
}

}  // namespace canopus::network_project
