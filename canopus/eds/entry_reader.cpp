#include "canopus/eds/entry_reader.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "canopus/ascii/words.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/standard_objects.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using canopen::Access;
using canopen::DataType;
using canopen::ObjectCode;
using Severity = Problem::Severity;

constexpr std::array<std::string_view, 19> object_keys = {
    "parametername", "objecttype",     "datatype",    "accesstype",  "defaultvalue",
    "pdomapping",    "subnumber",      "lowlimit",    "highlimit",   "objflags",
    "compactsubobj", "parametervalue", "denotation",  "description", "paramrefd",
    "uploadfile",    "downloadfile",   "srdomapping", "objectlinks"};

Access read_access(const ObjectKeys& keys, std::uint16_t index, std::uint8_t sub, DataType type,
                   Problems& problems) {
  const Item* item = keys.find("accesstype");
  if (item == nullptr) {
    const Access assumed = sub == 0 && type == DataType::unsigned8 ? Access::read_only : Access::read_write;
    if (type != DataType::domain) {  // rw is a DOMAIN's default [CiA 306]
      problems.repeated(Severity::warning, "no access", keys.section().line,
                        object_text(index, sub) + " has no AccessType: taken as " +
                            (assumed == Access::read_only ? "ro" : "rw"));
    }
    return assumed;
  }
  bool exact = true;
  if (const auto known = access(without_comment(item->value), exact)) {
    if (!exact) {
      problems.repeated(Severity::warning, "access word", item->line,
                        Place{problems, *item, index, sub}.quoted() + ": none of ro wo rw rwr rww const",
                        item->column);
    } else if (item->value != ascii::lower(item->value)) {
      problems.repeated(Severity::note, "access case", item->line,
                        Place{problems, *item, index, sub}.quoted() + " is in capitals", item->column);
    }
    return *known;
  }
  Place{problems, *item, index, sub}.loss("is none of ro wo rw rwr rww const: taken as rw");
  return Access::read_write;
}

bool read_mappable(const ObjectKeys& keys, std::uint16_t index, std::uint8_t sub, Problems& problems) {
  const Item* item = keys.find("pdomapping");
  if (item == nullptr) return false;
  if (item->value == "0" || item->value == "1") return item->value == "1";
  const Place place{problems, *item, index, sub};
  const std::string word = folded(without_comment(item->value));
  constexpr std::string_view yes[] = {"yes", "true", "optional", "default", "tpdo", "rpdo"};
  constexpr std::string_view no[] = {"no", "false"};
  if (std::ranges::find(yes, word) != std::end(yes)) return true;
  if (std::ranges::find(no, word) != std::end(no)) return false;
  const auto number = read_number(item->value);
  if (!number) {
    place.loss("is neither 0 nor 1: taken as 0");
    return false;
  }
  if (number->bits() > 1) place.note("PDOMapping is neither 0 nor 1, taken as 1");
  return number->bits() != 0;
}

void read_limits(EntryDraft& entry, const ObjectKeys& keys, std::uint16_t index, std::uint8_t sub,
                 Problems& problems) {
  const Item* low_item = keys.find("lowlimit");
  const Item* high_item = keys.find("highlimit");
  canopen::EntrySpec& spec = entry.spec;
  canopen::Limits limits;
  if (low_item != nullptr) limits.low = read_limit(spec.type, {problems, *low_item, index, sub});
  if (high_item != nullptr) limits.high = read_limit(spec.type, {problems, *high_item, index, sub});
  if (limits.low && limits.high && less(spec.type, *limits.high, *limits.low)) {
    problems.loss(low_item->line, "LowLimit=" + printable(low_item->value) + " of " +
                                      object_text(index, sub) +
                                      " is above HighLimit=" + printable(high_item->value) + ": no limits");
    return;
  }
  if (entry.has_value && !spec.adds_node_id && (limits.low || limits.high)) {
    const std::uint64_t value = pattern(spec.type, spec.value);
    const bool is_low = limits.low && less(spec.type, value, *limits.low);
    if (is_low || (limits.high && less(spec.type, *limits.high, value))) {
      const Item& limit = is_low ? *low_item : *high_item;
      problems.warning(entry.value_line, "the value of " + object_text(index, sub) + " is " +
                                             (is_low ? "below " : "above ") + limit.key + '=' +
                                             printable(limit.value) + " in line " +
                                             std::to_string(limit.line));
    }
  }
  // Limits that every value of the type keeps are none.
  const bool is_integer =
      is_number(spec.type) && spec.type != DataType::real32 && spec.type != DataType::real64;
  if (is_integer && limits.low == range(spec.type).low) limits.low.reset();
  if (is_integer && limits.high == range(spec.type).high) limits.high.reset();
  spec.limits = limits;
}

void set_mappable(canopen::EntrySpec& spec) noexcept {
  switch (spec.access) {
    case Access::read_only:
    case Access::constant:
    case Access::read_write_input: spec.tpdo_mappable = true; break;
    case Access::write_only:
    case Access::read_write_output: spec.rpdo_mappable = true; break;
    case Access::read_write: spec.tpdo_mappable = spec.rpdo_mappable = true; break;
  }
}

/// Of a PDO: without a value it would get the default of CiA 301, and cut to 32 bits it would be another one, both of which
/// may be valid.
bool is_unreadable_pdo_cob_id(DataType type, const Place& place) {
  using canopen::CobIdUse;
  const CobIdUse use = canopen::cob_id_use(place.index, place.sub);
  if (type != DataType::unsigned32 || (use != CobIdUse::rpdo && use != CobIdUse::tpdo)) return false;
  const auto number = read_number(place.item.value);
  return !number || number->negative || number->magnitude >> 32 != 0;
}

/// Parameters saved by 1010H: writable entries that are neither process data nor a command.
bool is_stored(const canopen::EntrySpec& spec, std::uint16_t index) noexcept {
  if (!canopen::is_writable(spec.access) || !canopen::is_readable(spec.access)) return false;
  if (spec.type == DataType::domain || index == 0x1003 || index == 0x1010 || index == 0x1011) return false;
  return !spec.rpdo_mappable && !spec.tpdo_mappable;
}

}  // namespace

ObjectKeys::ObjectKeys(const Section& section, Problems& problems) : section_(section) {
  for (const Item& item : section.items) {
    if (std::ranges::find(object_keys, item.folded_key) != object_keys.end()) continue;
    const std::string_view meant = nearest(item.folded_key, object_keys);
    if (meant.empty() || section.find(meant) != nullptr) continue;
    misspelt_.emplace_back(meant, &item);
    problems.warning(item.line, "key " + item.key + " in [" + section.name +
                                    "] is taken for a misspelling of " + std::string(meant));
  }
}

const Item* ObjectKeys::find(std::string_view key) const noexcept {
  if (const Item* item = section_.find(key)) return item->value.empty() ? nullptr : item;
  for (const auto& [meant, item] : misspelt_) {
    if (meant == key) return item->value.empty() ? nullptr : item;
  }
  return nullptr;
}

std::optional<DataType> read_data_type(const ObjectKeys& keys, Problems& problems) {
  const Item* item = keys.find("datatype");
  if (item == nullptr) return std::nullopt;
  const auto shown = [&] {
    return item->key + '=' + printable(item->value) + " in [" + keys.section().name + ']';
  };
  if (const auto type = data_type(without_comment(item->value))) {
    problems.repeated(Severity::note, "type word", item->line,
                      shown() + ": a word instead of the type's index", item->column);
    return type;
  }
  const auto number = read_number(item->value);
  if (!number) {
    problems.report(Severity::loss, item->line, shown() + " is no data type: taken as not given",
                    item->column);
    return std::nullopt;
  }
  if (is_data_type(number->bits())) return static_cast<DataType>(number->bits());
  problems.report(Severity::loss, item->line, shown() + " is no data type known here: taken as DOMAIN",
                  item->column);
  return DataType::domain;
}

std::optional<ObjectCode> read_object_code(const ObjectKeys& keys, Problems& problems) {
  const Item* item = keys.find("objecttype");
  if (item == nullptr) return std::nullopt;
  const auto shown = [&] {
    return item->key + '=' + printable(item->value) + " in [" + keys.section().name + ']';
  };
  if (const auto code = object_code(without_comment(item->value))) {
    problems.repeated(Severity::note, "code word", item->line,
                      shown() + ": a word instead of the object code", item->column);
    return code;
  }
  const auto number = read_number(item->value);
  if (number && is_object_code(number->bits())) return static_cast<ObjectCode>(number->bits());
  problems.report(Severity::warning, item->line, shown() + " is no object code: taken as not given",
                  item->column);
  return std::nullopt;
}

void set_value(EntryDraft& entry, const Item& item, std::uint16_t index, std::uint8_t sub,
               Problems& problems) {
  const Place place{problems, item, index, sub};
  if (is_unreadable_pdo_cob_id(entry.spec.type, place)) {
    place.loss("is no COB-ID: the PDO is switched off, 80000000H");
    entry.set_number(canopen::CobId::invalid_bit);
    entry.spec.adds_node_id = false;
    entry.value_line = item.line;
    return;
  }
  auto value = read_value(entry.spec.type, place);
  if (!value) return;
  entry.spec.value = std::move(value->bytes);
  entry.spec.adds_node_id = value->adds_node_id;
  entry.has_value = true;
  entry.value_line = item.line;
}

EntryDraft read_entry(const ObjectKeys& keys, std::uint16_t index, std::uint8_t sub,
                      const EntryFallback& fallback, Problems& problems) {
  const Section& section = keys.section();
  EntryDraft entry;
  canopen::EntrySpec& spec = entry.spec;
  entry.facts.index = index;
  entry.facts.sub = sub;
  entry.facts.line = entry.value_line = section.line;

  if (const Item* item = keys.find("parametername")) {
    spec.name = to_utf8(item->value);
  } else {
    spec.name = fallback.name;
    problems.repeated(Severity::note, "no name", section.line, "[" + section.name + "] has no ParameterName");
  }

  if (const auto type = read_data_type(keys, problems)) {
    spec.type = *type;
  } else if (const auto code = read_object_code(keys, problems); code == ObjectCode::domain) {
    spec.type = DataType::domain;
  } else if (fallback.type) {
    spec.type = *fallback.type;
    problems.repeated(Severity::note, "no type", section.line,
                      object_text(index, sub) + " has no DataType: taken as " + std::string(name(spec.type)));
  } else if (const auto standard = standard_type(index, sub)) {
    spec.type = *standard;
    problems.repeated(Severity::note, "no type of a standard object", section.line,
                      object_text(index, sub) + " has no DataType: taken as " + std::string(name(spec.type)) +
                          ", as CiA " + (index < 0x1F00 || index >= 0x1FA0 ? "301" : "302") + " has it");
  } else {
    spec.type = DataType::unsigned32;
    problems.repeated(Severity::loss, "no type at all", section.line,
                      object_text(index, sub) + " has no DataType: taken as UNSIGNED32");
  }
  spec.access = read_access(keys, index, sub, spec.type, problems);

  if (const Item* item = keys.find("defaultvalue")) set_value(entry, *item, index, sub, problems);
  if (const Item* item = keys.find("parametervalue")) {
    const bool had_value = entry.has_value;
    entry.has_value = false;
    set_value(entry, *item, index, sub, problems);
    entry.facts.configured = entry.has_value;
    if (const Item* covered = keys.find("defaultvalue"); covered != nullptr && entry.has_value) {
      entry.facts.default_text = to_utf8(covered->value);
    }
    entry.has_value = entry.has_value || had_value;
  }
  read_limits(entry, keys, index, sub, problems);
  if (read_mappable(keys, index, sub, problems)) {
    if (canopen::is_variable_length(spec.type)) {
      problems.repeated(Severity::loss, "mappable text", section.line,
                        object_text(index, sub) + " is of type " + std::string(name(spec.type)) +
                            ", which cannot be mapped into a PDO: PDOMapping is taken as 0");
    } else {
      set_mappable(spec);
    }
  }
  spec.stored = is_stored(spec, index);

  if (const Item* item = keys.find("objflags")) {
    entry.facts.object_flags = static_cast<std::uint32_t>(
        read_unsigned(section, *item, std::numeric_limits<std::uint32_t>::max(), problems, Severity::loss)
            .value_or(0));
  }
  if (const Item* item = keys.find("denotation")) entry.facts.denotation = to_utf8(item->value);
  if (const Item* item = keys.find("description")) entry.facts.description = to_utf8(item->value);
  if (const Item* item = keys.find("uploadfile")) entry.facts.upload_file = to_utf8(item->value);
  if (const Item* item = keys.find("downloadfile")) entry.facts.download_file = to_utf8(item->value);
  return entry;
}

}  // namespace canopus::eds
