#include "canopus/eds/object_lists.hpp"

#include <algorithm>
#include <map>
#include <string>

#include "canopus/eds/number.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using Severity = Problem::Severity;

}  // namespace

std::vector<ListEntry> read_list(const Section& section, std::string_view count_key, Problems& problems) {
  std::vector<ListEntry> entries;
  const Item* count = nullptr;
  for (const Item& item : section.items) {
    if (item.folded_key == count_key || is_misspelt(item.folded_key, count_key)) {
      count = &item;
      continue;
    }
    const auto key = read_number(item.key);
    if (key && !key->negative && !key->adds_node_id) {
      entries.push_back({key->hexadecimal ? key->magnitude : [&] {
                           // List keys are decimal, 08 and 010 included.
                           std::uint64_t value = 0;
                           for (const char c : item.key) {
                             if (c >= '0' && c <= '9' && value < 100'000) {
                               value = value * 10 + static_cast<std::uint64_t>(c - '0');
                             }
                           }
                           return value;
                         }(),
                         &item});
    } else {
      problems.repeated(Severity::note, "list key", item.line,
                        "key " + item.key + " in [" + section.name + "] is not known here: skipped");
    }
  }
  if (count == nullptr) {
    if (!entries.empty()) {
      problems.warning(section.line, "[" + section.name + "] does not say how many entries it has");
    }
    return entries;
  }
  if (count->value.empty() && entries.empty()) return entries;
  const auto announced = read_unsigned(section, *count, 0xFFFF, problems);
  if (announced && *announced != entries.size()) {
    problems.report(Severity::warning, count->line,
                    "[" + section.name + "] " + count->key + '=' + printable(count->value) + ", but " +
                        (entries.size() == 1 ? std::string("1 entry follows")
                                             : std::to_string(entries.size()) + " entries follow"),
                    count->column);
  }
  return entries;
}

void check_object_lists(const IniFile& file, const ObjectSectionMap& sections, Problems& problems) {
  struct List {
    std::string_view folded;
    std::string_view name;
  };
  constexpr List lists[] = {{"mandatoryobjects", "MandatoryObjects"},
                            {"optionalobjects", "OptionalObjects"},
                            {"manufacturerobjects", "ManufacturerObjects"}};
  std::map<std::uint16_t, unsigned> listed;  // index, line
  bool has_list = false;
  for (const List& list : lists) {
    const Section* section = file.find_or_misspelt(list.folded, list.name, problems);
    if (section == nullptr) continue;
    has_list = true;
    for (const ListEntry& entry : read_list(*section, "supportedobjects", problems)) {
      const auto index = read_number(entry.item->value);
      const std::string shown =
          entry.item->key + '=' + printable(entry.item->value) + " in [" + section->name + ']';
      if (entry.item->value.empty()) continue;
      if (!index || index->negative || index->magnitude > 0xFFFF) {
        problems.loss(entry.item->line, shown + " is not the index of an object: skipped");
        continue;
      }
      auto number = static_cast<std::uint16_t>(index->magnitude);
      if (!sections.contains(number) && !index->hexadecimal) {  // 1000 for 0x1000
        const auto hex = read_number("0x" + std::string(without_comment(entry.item->value)));
        if (hex && hex->magnitude <= 0xFFFF &&
            sections.contains(static_cast<std::uint16_t>(hex->magnitude))) {
          number = static_cast<std::uint16_t>(hex->magnitude);
          problems.repeated(Severity::warning, "decimal index", entry.item->line,
                            shown + " is read as " + object_name(number));
        }
      }
      if (!sections.contains(number)) {
        problems.loss(entry.item->line,
                      shown + ": there is no section [" + object_name(number).substr(0, 4) + "]: left out");
      }
      const auto [place, is_new] = listed.try_emplace(number, entry.item->line);
      if (!is_new) {
        problems.repeated(Severity::note, "listed twice", entry.item->line,
                          shown + " was listed in line " + std::to_string(place->second) + " before");
      }
    }
  }
  if (!has_list) {
    if (!sections.empty()) {
      unsigned line = ~0U;
      for (const auto& [index, object] : sections) {
        if (object.head != nullptr) line = std::min(line, object.head->line);
      }
      problems.warning(line == ~0U ? 1 : line,
                       "there are no object lists: every object described is taken in");
    }
    return;
  }
  for (const auto& [index, object] : sections) {
    if (index < 0x1000 || listed.contains(index) || object.head == nullptr) continue;
    problems.repeated(Severity::warning, "not listed", object.head->line,
                      object_name(index) + " is in no object list: taken in all the same");
  }
}

}  // namespace canopus::eds
