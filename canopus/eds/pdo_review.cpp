#include <algorithm>
#include <bit>
#include <string>

#include "canopus/eds/device_sections.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using canopen::Access;
using canopen::DataType;
using canopen::ObjectCode;
using Severity = Problem::Severity;

constexpr std::uint16_t most_pdos = 512;
constexpr std::uint16_t communication_base[] = {0x1400, 0x1800};
constexpr std::uint16_t mapping_base[] = {0x1600, 0x1A00};

std::string pdo_name(bool transmit, unsigned number) {
  return (transmit ? "TPDO" : "RPDO") + std::to_string(number + 1);
}

/// COB-ID of the pre-defined connection set without node-ID, for the first four PDOs.
constexpr std::uint32_t predefined_cob_id(bool transmit, unsigned number) noexcept {
  return (transmit ? 0x180U : 0x200U) + 0x100U * number;
}

void generate_pdo(Draft& draft, bool transmit, std::uint16_t number, std::uint8_t subs, unsigned line) {
  struct Member {
    std::string_view name;
    DataType type;
    std::uint64_t value;
  };
  constexpr Member members[] = {
      {"COB-ID", DataType::unsigned32, 0x8000'0000}, {"Transmission type", DataType::unsigned8, 0xFF},
      {"Inhibit time", DataType::unsigned16, 0},     {"Reserved", DataType::unsigned8, 0},
      {"Event timer", DataType::unsigned16, 0},      {"SYNC start value", DataType::unsigned8, 0}};
  ObjectDraft communication;
  communication.code = ObjectCode::record;
  communication.name = pdo_name(transmit, number) + " communication parameter";
  communication.line = line;
  const auto add = [&](ObjectDraft& object, std::uint16_t index, std::uint8_t sub, EntryDraft entry) {
    entry.facts.index = index;
    entry.facts.sub = sub;
    object.subs.emplace(sub, std::move(entry));
  };
  const auto index = static_cast<std::uint16_t>(communication_base[transmit] + number);
  const auto highest = static_cast<std::uint64_t>(std::bit_width(subs));
  add(communication, index, 0,
      made_entry("Highest sub-index supported", DataType::unsigned8, Access::constant, highest, line));
  for (std::uint8_t i = 0; i < 6; ++i) {
    if ((subs >> i & 1) == 0) continue;
    EntryDraft entry =
        made_entry(std::string(members[i].name), members[i].type, Access::read_write, members[i].value, line);
    if (i == 0 && number < 4) {
      entry.set_number(predefined_cob_id(transmit, number));
      entry.spec.adds_node_id = true;
    }
    entry.spec.stored = true;
    add(communication, index, static_cast<std::uint8_t>(i + 1), std::move(entry));
  }
  draft.emplace(index, std::move(communication));

  const auto mapping_index = static_cast<std::uint16_t>(mapping_base[transmit] + number);
  if (draft.contains(mapping_index)) return;
  ObjectDraft mapping;
  mapping.code = ObjectCode::record;
  mapping.name = pdo_name(transmit, number) + " mapping parameter";
  mapping.line = line;
  mapping.uniform_count = 0x40;
  EntryDraft count = made_entry("Number of mapped objects", DataType::unsigned8, Access::read_write, 0, line);
  EntryDraft entry = made_entry("Mapped object", DataType::unsigned32, Access::read_write, 0, line);
  count.spec.stored = entry.spec.stored = true;
  add(mapping, mapping_index, 0, std::move(count));
  add(mapping, mapping_index, 1, std::move(entry));
  draft.emplace(mapping_index, std::move(mapping));
}

/// The mapping of one PDO, entry by entry.
class MappingReview {
 public:
  MappingReview(Draft& draft, bool transmit, unsigned number, std::uint32_t dummy_usage, Problems& problems)
      : draft_(draft), transmit_(transmit), number_(number), dummy_usage_(dummy_usage), problems_(problems) {}

  void review(ObjectDraft& mapping) {
    EntryDraft* count = mapping.find(0);
    std::uint64_t entries = count == nullptr ? 0 : count->number();
    if (entries == 0 || entries > 64) return;  // nothing, or an MPDO
    entries = without_empty_end(mapping, *count, entries);
    std::uint64_t bits = 0;
    for (std::uint64_t sub = 1; sub <= entries; ++sub) {
      EntryDraft* entry = mapping.find(static_cast<std::uint8_t>(sub));
      if (entry == nullptr) {
        problems_.loss(count->value_line, name() + " maps " + counted(entries, "object") +
                                              ", but its mapping entry " + std::to_string(sub) +
                                              " is not described");
        return;
      }
      review(*entry, static_cast<std::uint32_t>(entry->number()));
      bits += entry->number() & 0xFF;
    }
    if (bits > 64) {
      problems_.loss(mapping.line, name() + " maps " + std::to_string(bits) + " bits: a PDO holds 64");
    }
  }

 private:
  [[nodiscard]] std::string name() const { return pdo_name(transmit_, number_); }

  /// Mapping entries that are 0 map nothing: the count is for those before them.
  std::uint64_t without_empty_end(ObjectDraft& mapping, EntryDraft& count, std::uint64_t entries) {
    std::uint64_t used = entries;
    while (used != 0) {
      const EntryDraft* entry = mapping.find(static_cast<std::uint8_t>(used));
      if (entry == nullptr || entry->number() != 0) break;
      --used;
    }
    if (used != entries) {
      problems_.repeated(Severity::warning, "maps nothing", count.value_line,
                         name() + " maps " + counted(entries, "object") + ", but the mapping entries from " +
                             std::to_string(used + 1) + " on are 0: taken as " + std::to_string(used));
      count.set_number(used);
    }
    return used;
  }

  void review(const EntryDraft& entry, std::uint32_t mapped) {
    const auto index = static_cast<std::uint16_t>(mapped >> 16);
    const auto sub = static_cast<std::uint8_t>(mapped >> 8);
    const unsigned length = mapped & 0xFF;
    const unsigned line = entry.value_line;
    if (mapped == 0) {
      problems_.repeated(Severity::warning, "maps nothing", line,
                         name() + " counts a mapping entry that is 0");
      return;
    }
    if (index < 0x20 && is_data_type(index)) {
      if (transmit_) {
        problems_.loss(line, name() + " maps " + object_text(index, sub) + ": dummies are for RPDOs");
      } else if ((dummy_usage_ >> index & 1) == 0) {
        problems_.repeated(Severity::warning, "dummy", line,
                           name() + " maps the dummy " + object_name(index) +
                               ", which [DummyUsage] does not allow: allowed");
      }
      return;
    }
    EntryDraft* target = find(draft_, index, sub);
    if (target == nullptr) {
      problems_.loss(line, name() + " maps " + object_text(index, sub) + ", which does not exist");
      return;
    }
    canopen::EntrySpec& spec = target->spec;
    const unsigned wanted = canopen::bit_length(spec.type);
    if (wanted == 0) {
      problems_.loss(line, name() + " maps " + object_text(index, sub) + ", a " +
                               std::string(eds::name(spec.type)) + ", which has no fixed length");
      return;
    }
    if (length != wanted && !(spec.type == DataType::boolean && length == 8)) {
      problems_.loss(line, name() + " maps " + object_text(index, sub) + " with " + std::to_string(length) +
                               " bits, it has " + std::to_string(wanted));
    }
    bool& mappable = transmit_ ? spec.tpdo_mappable : spec.rpdo_mappable;
    if (mappable) return;
    mappable = true;
    spec.stored = false;
    problems_.repeated(Severity::warning, transmit_ ? "made T mappable" : "made R mappable", line,
                       name() + " maps " + object_text(index, sub) + " by default, but its PDOMapping and " +
                           "AccessType (line " + std::to_string(target->facts.line) + ") forbid it: allowed");
  }

  Draft& draft_;
  bool transmit_;
  unsigned number_;
  std::uint32_t dummy_usage_;
  Problems& problems_;
};

}  // namespace

void generate_compact_pdos(Draft& draft, const DeviceInfo& device, unsigned line, Problems& problems) {
  if (device.compact_pdo == 0) return;
  for (const bool transmit : {false, true}) {
    const std::uint16_t wanted = std::min(transmit ? device.tpdos : device.rpdos, most_pdos);
    const std::uint16_t base = communication_base[transmit];
    const auto described = static_cast<unsigned>(
        std::distance(draft.lower_bound(base), draft.upper_bound(static_cast<std::uint16_t>(base + 0x1FF))));
    unsigned missing = wanted > described ? wanted - described : 0;
    unsigned made = 0;
    for (std::uint16_t number = 0; number < wanted && missing != 0; ++number) {
      if (draft.contains(static_cast<std::uint16_t>(base + number))) continue;
      generate_pdo(draft, transmit, number, device.compact_pdo, line);
      --missing;
      ++made;
    }
    if (made != 0) {
      problems.note(line, counted(made, transmit ? "TPDO" : "RPDO") + " made from CompactPDO");
    }
  }
}

void repair_cob_ids(Draft& draft, Problems& problems) {
  const auto repair = [&](std::uint16_t index, std::uint8_t sub, std::uint32_t without_node_id) {
    EntryDraft* entry = find(draft, index, sub);
    if (entry == nullptr || !entry->has_value || entry->spec.adds_node_id || entry->facts.configured) return;
    if ((entry->number() & 0x3FFF'FFFF) != without_node_id) return;
    entry->spec.adds_node_id = true;
    problems.repeated(
        Severity::warning, "no node-ID", entry->value_line,
        "the COB-ID " + object_text(index, sub) + " would be the same in every node: $NODEID is added");
  };
  for (const bool transmit : {false, true}) {
    for (std::uint16_t number = 0; number < 4; ++number) {
      repair(static_cast<std::uint16_t>(communication_base[transmit] + number), 1,
             predefined_cob_id(transmit, number));
    }
  }
  repair(0x1014, 0, 0x80);
  repair(0x1200, 1, 0x600);
  repair(0x1200, 2, 0x580);
}

void review_mappings(Draft& draft, std::uint32_t dummy_usage, Problems& problems) {
  for (const bool transmit : {false, true}) {
    std::uint16_t number = 0;
    // The number of the first record from this one on, if it is a PDO's.
    const auto next_of = [&](std::uint16_t base) {
      const auto place = draft.lower_bound(static_cast<std::uint16_t>(base + number));
      return place == draft.end() ? most_pdos : std::min<unsigned>(place->first - base, most_pdos);
    };
    for (;; ++number) {
      number = static_cast<std::uint16_t>(
          std::min(next_of(communication_base[transmit]), next_of(mapping_base[transmit])));
      if (number == most_pdos) break;
      const auto communication =
          draft.find(static_cast<std::uint16_t>(communication_base[transmit] + number));
      const auto mapping = draft.find(static_cast<std::uint16_t>(mapping_base[transmit] + number));
      if (mapping == draft.end()) {
        if (communication != draft.end()) {
          problems.repeated(Severity::warning, "no mapping", communication->second.line,
                            pdo_name(transmit, number) + " has a communication record but no mapping record");
        }
        continue;
      }
      if (communication == draft.end()) {
        problems.repeated(Severity::warning, "no communication", mapping->second.line,
                          pdo_name(transmit, number) + " has a mapping record but no communication record");
      }
      MappingReview(draft, transmit, number, dummy_usage, problems).review(mapping->second);
    }
  }
}

}  // namespace canopus::eds
