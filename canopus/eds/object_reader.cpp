#include "canopus/eds/object_reader.hpp"

#include <algorithm>
#include <set>

#include "canopus/ascii/words.hpp"
#include "canopus/eds/entry_reader.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/object_lists.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using canopen::Access;
using canopen::DataType;
using canopen::ObjectCode;
using Severity = Problem::Severity;

std::string member_name(const std::string& object, std::uint8_t sub) {
  return sub == 0 ? "Highest sub-index supported" : object + ' ' + std::to_string(sub);
}

/// Sub-indexes ...9, 10, 11 where 9, A, B belong: counted in decimal by mistake.
bool counts_in_decimal(const std::map<std::uint8_t, const Section*>& subs) {
  bool beyond_nine = false;
  for (unsigned sub = 1; sub <= 9; ++sub) {
    if (!subs.contains(static_cast<std::uint8_t>(sub))) return false;
  }
  for (const auto& [sub, section] : subs) {
    if ((sub & 0xF) > 9 || (sub >> 4) > 9) return false;
    beyond_nine = beyond_nine || sub >= 0x10;
  }
  return beyond_nine;
}

/// A RECORD may have a structure as its type, such as 20H for PDO communication: its members have types of their own.
bool has_simple_type(const ObjectKeys& keys) {
  const Item* item = keys.find("datatype");
  if (item == nullptr) return false;
  const auto number = read_number(item->value);
  return !number || is_data_type(number->bits());
}

class ObjectReader {
 public:
  ObjectReader(std::uint16_t index, const ObjectSections& sections, Problems& problems)
      : index_(index), sections_(sections), problems_(problems) {}

  /// False: nothing to add to the dictionary.
  bool read(ObjectDraft& object);

 private:
  /// Of an object whose sub-indexes alone have sections.
  bool read_without_head(ObjectDraft& object);
  void read_members(ObjectDraft& object, const ObjectKeys* head);
  void read_compact(ObjectDraft& object, const ObjectKeys& head, std::uint8_t count);
  void read_lists(ObjectDraft& object, const ObjectKeys& head, std::uint8_t count);
  /// Reports a SubNumber that differs from the number of described sub-indexes.
  void compare_sub_number(const ObjectDraft& object, std::uint64_t announced);
  void complete_highest_sub(ObjectDraft& object);
  [[nodiscard]] ObjectCode likely_code() const;
  [[nodiscard]] std::uint64_t mapped_objects(ObjectDraft& object) const;

  std::uint16_t index_;
  const ObjectSections& sections_;
  Problems& problems_;
};

ObjectCode ObjectReader::likely_code() const {
  // Equal members make an ARRAY; PDO, SDO and identity records are RECORDs.
  if (index_ >= 0x1018 && index_ < 0x2000 && index_ != 0x1029 && index_ != 0x1028) return ObjectCode::record;
  std::set<std::string> types;
  for (const auto& [sub, section] : sections_.subs) {
    const Item* type = section->find("datatype");
    if (sub != 0 && type != nullptr) types.insert(ascii::lower(type->value));
  }
  return types.size() > 1 ? ObjectCode::record : ObjectCode::array;
}

bool ObjectReader::read_without_head(ObjectDraft& object) {
  if (sections_.subs.empty()) {
    const Section* list = sections_.values != nullptr  ? sections_.values
                          : sections_.names != nullptr ? sections_.names
                                                       : sections_.denotations;
    if (list != nullptr) {
      problems_.loss(list->line, "[" + list->name + "] belongs to no object: skipped");
    }
    return false;
  }
  object.line = sections_.subs.begin()->second->line;
  object.name = object_name(index_);
  object.code = likely_code();
  problems_.warning(object.line, "sub-indexes of " + object_name(index_) + ", but no [" +
                                     object_name(index_).substr(0, 4) + "]: made, a " +
                                     std::string(name(object.code)));
  read_members(object, nullptr);
  complete_highest_sub(object);
  return true;
}

void ObjectReader::compare_sub_number(const ObjectDraft& object, std::uint64_t announced) {
  const std::size_t found = object.uniform_count != 0 ? object.uniform_count + 1U : object.subs.size();
  const bool has_zero = object.subs.contains(0) || object.uniform_count != 0;
  if (announced != 0 && announced != found && announced != found + (has_zero ? 0 : 1) &&
      announced != object.highest_sub()) {
    problems_.repeated(Severity::note, "sub number", object.line,
                       object_name(index_) + " has SubNumber=" + std::to_string(announced) + ", but " +
                           counted(found, "sub-index") + " described");
  }
}

bool ObjectReader::read(ObjectDraft& object) {
  if (sections_.head == nullptr) return read_without_head(object);
  const ObjectKeys keys(*sections_.head, problems_);
  object.line = sections_.head->line;
  const Item* name_item = keys.find("parametername");
  object.name = name_item != nullptr ? to_utf8(name_item->value) : object_name(index_);
  const auto code = read_object_code(keys, problems_);
  if (index_ < 0x1000 || code == ObjectCode::type_definition || code == ObjectCode::null) {
    const bool is_object = index_ >= 0x1000 && code == ObjectCode::type_definition;
    problems_.repeated(is_object ? Severity::loss : Severity::note, "no object", object.line,
                       "[" + sections_.head->name + "] is a data type or NULL object: left out");
    return false;
  }
  std::uint64_t compact = 0;
  std::uint64_t announced = 0;
  if (const Item* item = keys.find("compactsubobj")) {
    compact = read_unsigned(*sections_.head, *item, 254, problems_, Severity::loss).value_or(0);
  }
  if (const Item* item = keys.find("subnumber")) {
    announced = read_unsigned(*sections_.head, *item, 255, problems_).value_or(0);
  }
  const bool is_structured =
      code == ObjectCode::array || code == ObjectCode::record || code == ObjectCode::structure_definition;
  const bool has_type = has_simple_type(keys);

  if (compact != 0) {
    object.code = is_structured ? *code : ObjectCode::array;
    read_compact(object, keys, static_cast<std::uint8_t>(compact));
  } else if (!sections_.subs.empty()) {
    object.code = is_structured ? *code : likely_code();
    if (!is_structured) {
      const std::string made = "taken as " + std::string(name(object.code));
      if (code) {
        problems_.warning(object.line, object_name(index_) + " has ObjectType " + std::string(name(*code)) +
                                           " and sub-indexes: " + made);
      } else {
        problems_.repeated(Severity::warning, "no code", object.line,
                           object_name(index_) + " has sub-indexes and no ObjectType: " + made);
      }
    }
    read_members(object, &keys);
  } else if (is_structured && has_type && announced >= 2) {
    object.code = *code;
    problems_.warning(object.line, object_name(index_) + " has SubNumber=" + std::to_string(announced) +
                                       " but no sub-index is described: made, all alike");
    read_compact(object, keys, static_cast<std::uint8_t>(announced - 1));
  } else if (is_structured && !has_type) {
    object.code = *code;
    problems_.loss(object.line, object_name(index_) + " has ObjectType " + std::string(name(*code)) +
                                    ", but no sub-index is described: it has none");
  } else {
    if (is_structured) {
      problems_.warning(object.line, object_name(index_) + " has ObjectType " + std::string(name(*code)) +
                                         ", but no sub-indexes: taken as VAR");
    } else if (announced > 1) {
      problems_.repeated(
          Severity::warning, "subs of a variable", object.line,
          object_name(index_) + " has a SubNumber but no sub-index is described: taken as VAR");
    }
    EntryDraft entry = read_entry(keys, index_, 0, {object.name, std::nullopt}, problems_);
    object.code = entry.spec.type == DataType::domain ? ObjectCode::domain : ObjectCode::variable;
    object.subs.emplace(std::uint8_t{0}, std::move(entry));
    return true;
  }

  if (compact == 0) compare_sub_number(object, announced);
  complete_highest_sub(object);
  if (const Item* description = keys.find("description"); description != nullptr && object.subs.contains(0))
    object.subs.at(0).facts.object_description = to_utf8(description->value);
  return true;
}

void ObjectReader::read_members(ObjectDraft& object, const ObjectKeys* head) {
  std::optional<DataType> type;
  if (head != nullptr && (object.code != ObjectCode::record || has_simple_type(*head)))
    type = read_data_type(*head, problems_);
  const bool decimal = counts_in_decimal(sections_.subs);
  if (decimal) {
    problems_.warning(
        sections_.subs.rbegin()->second->line,
        "sub-indexes of " + object_name(index_) + " go from 9 to 10 without A to F: read as decimal numbers");
  }
  for (const auto& [number, section] : sections_.subs) {
    const auto sub = decimal ? static_cast<std::uint8_t>((number >> 4) * 10 + (number & 0xF)) : number;
    if (sub == 0xFF) {
      problems_.repeated(Severity::note, "sub FF", section->line,
                         object_text(index_, sub) + " (structure of the object) is left out");
      continue;
    }
    const ObjectKeys keys(*section, problems_);
    EntryFallback fallback{member_name(object.name, sub), type};
    if (sub == 0) fallback.type = DataType::unsigned8;
    EntryDraft entry = read_entry(keys, index_, sub, fallback, problems_);
    if (sub != 0 && object.code == ObjectCode::array && !type) type = entry.spec.type;
    object.subs.insert_or_assign(sub, std::move(entry));
  }
}

void ObjectReader::read_compact(ObjectDraft& object, const ObjectKeys& head, std::uint8_t count) {
  object.subs.clear();
  EntryDraft member = read_entry(head, index_, 1, {object.name, std::nullopt}, problems_);
  member.facts.description = RareText();  // of the object
  EntryDraft zero =
      made_entry(member_name({}, 0), DataType::unsigned8, Access::read_only, count, object.line);
  zero.facts.index = index_;
  if (is_mapping_record(index_)) {
    zero.spec.access = Access::read_write;
    zero.spec.stored = true;
  }
  if (index_ == 0x1003) {
    zero.spec.access = Access::read_write;
    zero.set_number(0);
  }
  object.subs.emplace(std::uint8_t{0}, std::move(zero));

  const bool differ = sections_.values != nullptr || sections_.names != nullptr ||
                      sections_.denotations != nullptr || !sections_.subs.empty();
  if (!differ) {
    object.uniform_count = count;
    object.subs.emplace(std::uint8_t{1}, std::move(member));
    return;
  }
  for (unsigned sub = 1; sub <= count; ++sub) {
    EntryDraft copy = member;
    copy.facts.sub = static_cast<std::uint8_t>(sub);
    copy.spec.name = member_name(object.name, copy.facts.sub);
    object.subs.emplace(copy.facts.sub, std::move(copy));
  }
  if (!sections_.subs.empty()) {
    problems_.repeated(
        Severity::note, "compact and described", object.line,
        object_name(index_) + " has CompactSubObj and described sub-indexes: the latter count");
    read_members(object, &head);
  }
  read_lists(object, head, count);
}

void ObjectReader::read_lists(ObjectDraft& object, const ObjectKeys& head, std::uint8_t count) {
  const auto entries = [&](const Section* section, auto&& apply) {
    if (section == nullptr) return;
    for (const ListEntry& entry : read_list(*section, "nrofentries", problems_)) {
      if (entry.key == 0 || entry.key > count) {
        problems_.loss(entry.item->line, entry.item->key + " in [" + section->name +
                                             "]: " + object_name(index_) + " has sub-indexes 1.." +
                                             std::to_string(count) + ": left out");
        continue;
      }
      apply(object.subs.at(static_cast<std::uint8_t>(entry.key)), *entry.item);
    }
  };
  entries(sections_.names,
          [&](EntryDraft& entry, const Item& item) { entry.spec.name = to_utf8(item.value); });
  entries(sections_.denotations,
          [&](EntryDraft& entry, const Item& item) { entry.facts.denotation = to_utf8(item.value); });
  entries(sections_.values, [&](EntryDraft& entry, const Item& item) {
    if (item.value.empty()) return;
    set_value(entry, item, index_, entry.facts.sub, problems_);
    entry.facts.configured = true;
    if (const Item* covered = head.find("defaultvalue")) entry.facts.default_text = to_utf8(covered->value);
  });
}

std::uint64_t ObjectReader::mapped_objects(ObjectDraft& object) const {
  std::uint8_t count = 0;
  while (count < 64) {
    const EntryDraft* entry = object.find(static_cast<std::uint8_t>(count + 1));
    if (entry == nullptr || entry->number() == 0) break;
    ++count;
  }
  return count;
}

void ObjectReader::complete_highest_sub(ObjectDraft& object) {
  const std::uint8_t highest = object.highest_sub();
  const bool is_mapping = is_mapping_record(index_);
  EntryDraft* zero = object.find(0);
  if (zero == nullptr) {
    const std::uint64_t value = is_mapping ? mapped_objects(object) : index_ == 0x1003 ? 0 : highest;
    problems_.repeated(
        Severity::warning, "no sub 0", object.line,
        object_name(index_) + " has no sub-index 00: made, with value " + std::to_string(value));
    EntryDraft made = made_entry(member_name({}, 0), DataType::unsigned8,
                                 is_mapping || index_ == 0x1003 ? Access::read_write : Access::constant,
                                 value, object.line);
    made.facts.index = index_;
    object.subs.emplace(std::uint8_t{0}, std::move(made));
    return;
  }
  if (canopen::byte_length(zero->spec.type) == 0) return;
  if (!zero->has_value) {
    if (index_ == 0x1003) return;
    zero->set_number(is_mapping ? mapped_objects(object) : highest);
    problems_.repeated(Severity::note, "no value of sub 0", zero->facts.line,
                       object_text(index_, 0) + " has no value: taken as " + std::to_string(zero->number()));
    return;
  }
  const std::uint64_t value = zero->number();
  if (is_mapping && value > highest && value != 0xFE && value != 0xFF) {
    problems_.loss(zero->value_line, object_text(index_, 0) + " says " + counted(value, "object") +
                                         " mapped, but only " + std::to_string(highest) +
                                         " can be: taken as " + std::to_string(highest));
    zero->set_number(highest);
  } else if (value > highest && highest != 0 && !is_mapping) {
    problems_.repeated(Severity::warning, "sub 0 too high", zero->value_line,
                       object_text(index_, 0) + " says the highest sub-index is " + std::to_string(value) +
                           ", but the highest described is " + std::to_string(highest));
  } else if (value < highest && !is_mapping && index_ != 0x1003 && !canopen::is_writable(zero->spec.access)) {
    problems_.repeated(Severity::note, "sub 0 too low", zero->value_line,
                       object_text(index_, 0) + " says the highest sub-index is " + std::to_string(value) +
                           ", but " + std::to_string(highest) + " is described");
  }
}

}  // namespace

ObjectSectionMap find_object_sections(const IniFile& file, std::string_view prefix, Problems& problems) {
  ObjectSectionMap map;
  for (const Section& section : file.sections()) {
    std::string_view rest = section.folded_name;
    if (!rest.starts_with(prefix)) continue;
    rest.remove_prefix(prefix.size());
    const auto meaning = object_section(rest);
    if (!meaning) continue;
    // The names of an XDD's sections are made by our reader: their spelling is no finding.
    const bool is_spelt = folded(section.name) == section.folded_name;
    if (meaning->irregular || (is_spelt && section.name.find(' ') != std::string::npos)) {
      problems.repeated(Severity::note, "section spelling", section.line,
                        "section [" + section.name + "] is read as an object's");
    }
    ObjectSections& object = map[meaning->index];
    switch (meaning->kind) {
      case ObjectSection::Kind::head:
        if (object.head == nullptr) object.head = &section;
        break;
      case ObjectSection::Kind::sub: object.subs.try_emplace(meaning->sub, &section); break;
      case ObjectSection::Kind::names: object.names = &section; break;
      case ObjectSection::Kind::values: object.values = &section; break;
      case ObjectSection::Kind::denotations: object.denotations = &section; break;
      case ObjectSection::Kind::links: break;
    }
  }
  return map;
}

void read_object(Draft& draft, std::uint16_t index, const ObjectSections& sections, Problems& problems) {
  ObjectDraft object;
  if (ObjectReader(index, sections, problems).read(object)) draft.insert_or_assign(index, std::move(object));
}

}  // namespace canopus::eds
