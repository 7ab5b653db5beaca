#include "canopus/eds/user_types.hpp"

#include <map>
#include <optional>
#include <utility>

#include "canopus/eds/draft.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using canopen::DataType;
using Severity = Problem::Severity;

// Types of a manufacturer, of device profiles and of several devices in one [CiA 301 7.4.7].
constexpr std::uint64_t first_user_type = 0x40;
constexpr std::uint64_t last_user_type = 0x25F;
constexpr int most_steps = 8;  // a type may be made of another one, and a circle of them has no end

struct UserType {
  const Section* head = nullptr;
  std::map<std::uint8_t, const Section*> subs;
};
using UserTypes = std::map<std::uint64_t, UserType>;

/// What a file says of a type; the items lie in its sections.
struct BaseType {
  DataType type = DataType::none;
  const Item* low = nullptr;
  const Item* high = nullptr;
};

const Item* value_of(const UserType& type, std::uint8_t sub) {
  const auto place = type.subs.find(sub);
  return place == type.subs.end() ? nullptr : place->second->find_value("defaultvalue");
}

std::optional<std::uint64_t> type_number(const Item* item) {
  if (item == nullptr) return std::nullopt;
  if (const auto word = data_type(without_comment(item->value))) return static_cast<std::uint64_t>(*word);
  const auto number = read_number(item->value);
  return number && !number->negative && !number->adds_node_id ? std::optional(number->magnitude)
                                                              : std::nullopt;
}

UserTypes find_user_types(const IniFile& file) {
  UserTypes types;
  for (const Section& section : file.sections()) {
    const auto meaning = object_section(section.folded_name);
    if (!meaning || meaning->index < first_user_type || meaning->index > last_user_type) continue;
    UserType& type = types[meaning->index];
    if (meaning->kind == ObjectSection::Kind::head) type.head = &section;
    if (meaning->kind == ObjectSection::Kind::sub) type.subs.try_emplace(meaning->sub, &section);
  }
  return types;
}

/// Nothing: its base type is not known, or it is a structure.
std::optional<BaseType> base_of(const UserTypes& types, std::uint64_t index) {
  BaseType base;
  for (int step = 0; step < most_steps; ++step) {
    const auto place = types.find(index);
    if (place == types.end()) return std::nullopt;
    const UserType& type = place->second;
    const auto own = [&](std::string_view key) {
      return type.head == nullptr ? nullptr : type.head->find_value(key);
    };
    const auto code = type_number(own("objecttype"));
    if (code && *code != static_cast<std::uint64_t>(canopen::ObjectCode::type_definition))
      return std::nullopt;
    const Item* const named = value_of(type, 1) != nullptr ? value_of(type, 1) : own("datatype");
    const auto number = type_number(named);
    if (!number) return std::nullopt;
    const bool is_text = is_data_type(*number) && !is_number(static_cast<DataType>(*number));
    // Of a text [A0sub2] is the length, which an SDO has anyway.
    const auto limit = [&](std::uint8_t sub, std::string_view key) -> const Item* {
      if (is_text) return nullptr;
      return value_of(type, sub) != nullptr ? value_of(type, sub) : own(key);
    };
    if (base.low == nullptr) base.low = limit(2, "lowlimit");
    if (base.high == nullptr) base.high = limit(3, "highlimit");
    if (is_data_type(*number) && *number != 0) {
      base.type = static_cast<DataType>(*number);
      return base;
    }
    index = *number;
  }
  return std::nullopt;
}

void add_limit(Section& object, const char* folded_key, const char* key, const Item* limit) {
  if (limit == nullptr || object.find_value(folded_key) != nullptr) return;
  std::erase_if(object.items, [&](const Item& item) { return item.folded_key == folded_key; });
  object.items.push_back({folded_key, key, limit->value, limit->line, limit->column});
}

}  // namespace

IniFile with_base_types(IniFile file, Problems& problems) {
  const UserTypes types = find_user_types(file);
  if (types.empty()) return file;
  std::vector<Section> sections;
  for (const Section& section : file.sections()) {
    const auto meaning = object_section(section.folded_name);
    if (meaning && meaning->index < 0x1000 && meaning->kind == ObjectSection::Kind::sub)
      continue;  // of a type
    Section copy = section;
    const Item* const item = meaning && meaning->index >= 0x1000 ? section.find_value("datatype") : nullptr;
    const auto number = type_number(item);
    const auto base = number && !is_data_type(*number) ? base_of(types, *number) : std::nullopt;
    if (base) {
      for (Item& own : copy.items) {
        if (own.folded_key == "datatype") own.value = std::to_string(static_cast<unsigned>(base->type));
      }
      add_limit(copy, "lowlimit", "LowLimit", base->low);
      add_limit(copy, "highlimit", "HighLimit", base->high);
      problems.repeated(Severity::note, "user type", item->line,
                        item->key + '=' + printable(item->value) + " in [" + section.name +
                            "]: a type of the file's own, taken as " + std::string(name(base->type)) +
                            (base->low != nullptr || base->high != nullptr ? " with its limits" : ""),
                        item->column);
    }
    sections.push_back(std::move(copy));
  }
  return IniFile(std::move(sections));
}

}  // namespace canopus::eds
