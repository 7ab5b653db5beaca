#include "canopus/eds/draft.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "canopus/can/little_endian.hpp"
#include "canopus/eds/value.hpp"

namespace canopus::eds {

using canopen::ObjectCode;

std::uint64_t EntryDraft::number() const noexcept {
  const std::size_t length = std::min<std::size_t>(spec.value.size(), canopen::byte_length(spec.type));
  return can::load_value(std::span(spec.value).first(length));
}

void EntryDraft::set_number(std::uint64_t value) {
  spec.value = canopen::little_endian(value, canopen::byte_length(spec.type));
  has_value = true;
}

bool ObjectDraft::is_structured() const noexcept {
  return code == ObjectCode::array || code == ObjectCode::record || code == ObjectCode::structure_definition;
}

std::uint8_t ObjectDraft::highest_sub() const noexcept {
  if (uniform_count != 0) return uniform_count;
  return subs.empty() ? std::uint8_t{0} : subs.rbegin()->first;
}

EntryDraft* ObjectDraft::find(std::uint8_t sub) noexcept {
  if (uniform_count != 0 && sub != 0) {
    if (sub > uniform_count) return nullptr;
    sub = 1;
  }
  const auto place = subs.find(sub);
  return place == subs.end() ? nullptr : &place->second;
}

EntryDraft* find(Draft& draft, std::uint16_t index, std::uint8_t sub) noexcept {
  const auto place = draft.find(index);
  return place == draft.end() ? nullptr : place->second.find(sub);
}

EntryDraft made_entry(std::string name, canopen::DataType type, canopen::Access access, std::uint64_t value,
                      unsigned line) {
  EntryDraft entry;
  entry.spec.name = std::move(name);
  entry.spec.type = type;
  entry.spec.access = access;
  entry.facts.line = line;
  entry.value_line = line;
  entry.set_number(value);
  return entry;
}

std::optional<ObjectSection> object_section(std::string_view name) {
  ObjectSection section;
  const auto read_hex = [&](std::size_t most) -> std::optional<unsigned> {
    if (name.starts_with("0x")) {
      name.remove_prefix(2);
      section.irregular = true;
    }
    const std::size_t length = std::min(name.size(), most);
    unsigned value = 0;
    const auto [end, failure] = std::from_chars(name.data(), name.data() + length, value, 16);
    if (failure != std::errc{}) return std::nullopt;
    name.remove_prefix(static_cast<std::size_t>(end - name.data()));
    return value;
  };

  const std::size_t digits = name.find_first_not_of("0123456789");
  const bool is_short = digits == std::string_view::npos ? name.size() < 4 : digits < 4;
  const std::size_t hex_digits = name.find_first_not_of("0123456789abcdef");
  const bool is_type_member = hex_digits != std::string_view::npos && hex_digits >= 2 && hex_digits < 4 &&
                              name.substr(hex_digits).starts_with("sub");
  const bool has_prefix = name.starts_with("0x");
  const std::size_t before = name.size() - (has_prefix ? 2 : 0);
  const auto index = read_hex(4);
  if (!index) return std::nullopt;
  const std::size_t used = before - name.size();
  // Four digits, or fewer for a data type: [5], [A0], [A0sub1].
  if (used != 4 && !has_prefix && !(is_short && name.empty()) && !is_type_member) return std::nullopt;
  section.index = static_cast<std::uint16_t>(*index);
  if (name.starts_with('h')) {
    name.remove_prefix(1);
    section.irregular = true;
  }
  if (name.empty()) return section;
  if (name.starts_with("sub")) {
    name.remove_prefix(3);
    if (name.starts_with("index")) {
      name.remove_prefix(5);
      section.irregular = true;
    }
    const auto sub = read_hex(2);
    if (!sub || !(name.empty() || name == "h")) return std::nullopt;
    section.irregular = section.irregular || !name.empty();
    section.kind = ObjectSection::Kind::sub;
    section.sub = static_cast<std::uint8_t>(*sub);
    return section;
  }
  constexpr std::pair<std::string_view, ObjectSection::Kind> lists[] = {
      {"name", ObjectSection::Kind::names},
      {"value", ObjectSection::Kind::values},
      {"denotation", ObjectSection::Kind::denotations},
      {"objectlinks", ObjectSection::Kind::links}};
  for (const auto& [word, kind] : lists) {
    if (name != word && name != std::string(word) + 's') continue;
    section.kind = kind;
    return section;
  }
  return std::nullopt;
}

}  // namespace canopus::eds
