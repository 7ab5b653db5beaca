#include "canopus/canopen/dictionary/dictionary_description.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <unordered_map>
#include <utility>

namespace canopus::canopen {

Entry DictionaryDescription::find(std::uint16_t index, std::uint8_t sub) const noexcept {
  const ObjectDescription* object = find(index);
  return object == nullptr ? Entry{} : find(*object, sub);
}

std::span<const ObjectDescription> DictionaryDescription::objects(std::uint16_t first,
                                                                  std::uint16_t last) const noexcept {
  const auto all = objects();
  const auto begin = std::ranges::lower_bound(all, first, {}, &ObjectDescription::index);
  const auto end = std::ranges::upper_bound(begin, all.end(), last, {}, &ObjectDescription::index);
  return {begin, end};
}

DictionaryDescription::DictionaryDescription(std::shared_ptr<const Layout> layout)
    : positions_(layout->positions.data()),
      objects_(layout->objects.data()),
      entries_(layout->entries.data()),
      multiplier_(layout->multiplier),
      shift_(32U - static_cast<std::uint32_t>(std::countr_zero(layout->positions.size()))),
      mask_(static_cast<std::uint32_t>(layout->positions.size() - 1)),
      layout_(std::move(layout)) {}

// Lengths have seven bits to a byte, the lowest ones first; bit 7: another byte follows.
std::uint32_t DictionaryDescription::Layout::add_name(std::string_view name) {
  if (text.empty()) text.push_back('\0');  // no name has number 0
  const auto number = static_cast<std::uint32_t>(text.size());
  std::size_t length = name.size();
  for (; length > 0x7F; length >>= 7U) text.push_back(static_cast<char>(0x80U | (length & 0x7FU)));
  text.push_back(static_cast<char>(length));
  text += name;
  return number;
}

std::string_view DictionaryDescription::Layout::name(std::uint32_t number) const noexcept {
  std::size_t length = 0;
  unsigned shift = 0;
  for (;; shift += 7) {
    const auto byte = static_cast<unsigned char>(text[number++]);
    length |= std::size_t{byte & 0x7FU} << shift;
    if (byte < 0x80) break;
  }
  return std::string_view(text).substr(number, length);
}

// A table of at least twice as many places as there are objects. Of a few multipliers the one that lets the
// look-ups end soonest is taken: most objects are then found at the first place.
void DictionaryDescription::Layout::index_objects() {
  constexpr std::uint32_t candidates = 16;
  const std::size_t size = std::bit_ceil(2 * objects.size() + 2);
  const auto shift = 32U - static_cast<unsigned>(std::countr_zero(size));
  std::vector<std::uint16_t> table(size);
  std::size_t fewest = SIZE_MAX;
  std::uint32_t candidate = 0x9E37'79B1;
  for (std::uint32_t i = 0; i < candidates && fewest != 0;
       ++i, candidate = candidate * 0x2C11'87F5 + 0x1234'5672) {
    std::ranges::fill(table, no_position);
    std::size_t extra = 0;
    for (std::size_t position = 0; position < objects.size() && extra < fewest; ++position) {
      std::size_t place = (objects[position].index * candidate) >> shift;
      for (; table[place] != no_position; place = (place + 1) & (size - 1)) ++extra;
      table[place] = static_cast<std::uint16_t>(position);
    }
    if (extra >= fewest) continue;
    fewest = extra;
    multiplier = candidate;
    positions = table;
  }
}

const std::vector<std::uint8_t>& DictionaryDescription::default_slot(std::uint32_t slot) const noexcept {
  for (const Slot& changed : changed_slots_) {
    if (changed.number == slot) return changed.bytes;
  }
  return layout_->slots[slot];
}

void DictionaryDescription::load_defaults(std::span<std::uint8_t> block,
                                          std::uint8_t node_id) const noexcept {
  std::copy_n(layout_->image.begin(), block.size(), block.begin());
  for (const NodeIdDefault& place : layout_->node_id_defaults) {
    if (place.offset + place.length > block.size()) break;  // in order of offset
    unsigned carry = node_id;
    for (std::uint8_t i = 0; i < place.length && carry != 0; ++i) {
      carry += block[place.offset + i];
      block[place.offset + i] = static_cast<std::uint8_t>(carry);
      carry >>= 8;
    }
  }
  for (const Value& changed : changed_values_) {
    if (changed.offset + changed.length > block.size()) continue;
    can::store_value(&block[changed.offset], changed.value, changed.length);
  }
}

bool DictionaryDescription::has_default_pdos(std::span<const std::uint8_t> block,
                                             std::uint8_t node_id) const noexcept {
  const std::size_t begin = layout_->pdo_values_begin;
  const std::size_t end = layout_->pdo_values_end;
  std::array<std::uint8_t, 2048> defaults{};
  if (end < begin || end > defaults.size()) return false;
  load_defaults(std::span(defaults).first(end), node_id);
  return std::memcmp(block.data() + begin, defaults.data() + begin, end - begin) == 0;
}

std::uint64_t DictionaryDescription::default_value(const Entry& entry, std::uint8_t node_id) const noexcept {
  const std::uint8_t length = entry.description->length;
  if (length == 0) return 0;
  for (const Value& changed : changed_values_) {
    if (changed.offset == entry.offset && changed.length == length) return changed.value;
  }
  const std::uint64_t value = can::load_value(&layout_->image[entry.offset], length);
  const auto place =
      std::ranges::lower_bound(layout_->node_id_defaults, entry.offset, {}, &NodeIdDefault::offset);
  if (place == layout_->node_id_defaults.end() || place->offset != entry.offset) return value;
  return (value + node_id) & (~std::uint64_t{0} >> (64U - 8U * length));
}

AbortCode DictionaryDescription::check_write(const Entry& entry, std::size_t length) noexcept {
  if (!is_writable(entry.description->access)) return AbortCode::write_of_read_only;
  if (entry.description->length == 0) return AbortCode::none;
  if (length > entry.description->length) return AbortCode::length_too_high;
  if (length < entry.description->length) return AbortCode::length_too_low;
  return AbortCode::none;
}

AbortCode DictionaryDescription::check_limits(const Entry& entry,
                                              std::span<const std::uint8_t> value) const noexcept {
  const EntryDescription& d = *entry.description;
  if (d.type == DataType::boolean && value[0] > 1) return AbortCode::value_too_high;
  if (d.limits == 0) return AbortCode::none;
  const Limits& limits = layout_->limits[d.limits - 1U];
  std::uint64_t raw = 0;
  std::memcpy(&raw, value.data(), d.length);
  const auto outside = [&](auto convert) {
    const auto number = convert(raw);
    if (limits.high && number > convert(*limits.high)) return AbortCode::value_too_high;
    if (limits.low && number < convert(*limits.low)) return AbortCode::value_too_low;
    return AbortCode::none;
  };
  if (d.type == DataType::real32) {
    raw = std::bit_cast<std::uint64_t>(
        static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw))));
  }
  if (d.type == DataType::real32 || d.type == DataType::real64) {
    return outside([](std::uint64_t bits) { return std::bit_cast<double>(bits); });
  }
  if (is_signed(d.type)) {
    const unsigned unused = 64U - 8U * d.length;
    raw = static_cast<std::uint64_t>(static_cast<std::int64_t>(raw << unused) >> unused);
    return outside([](std::uint64_t bits) { return static_cast<std::int64_t>(bits); });
  }
  return outside([](std::uint64_t bits) { return bits; });
}

AbortCode DictionaryDescription::check_write(const Entry& entry,
                                             std::span<const std::uint8_t> value) const noexcept {
  const AbortCode code = check_write(entry, value.size());
  return code != AbortCode::none || entry.description->length == 0 ? code : check_limits(entry, value);
}

std::shared_ptr<const DictionaryDescription> DictionaryDescription::with(
    std::span<const Change> changes) const {
  auto other = std::make_shared<DictionaryDescription>(*this);
  const auto changed = [](auto& all, auto member, std::uint32_t number) -> auto& {
    const auto known = std::ranges::find(all, number, member);
    if (known != all.end()) return *known;
    all.emplace_back().*member = number;
    return all.back();
  };
  for (const Change& change : changes) {
    const std::uint8_t length = change.entry.description->length;
    if (length == 0) {
      changed(other->changed_slots_, &Slot::number, change.entry.offset).bytes = change.value;
      continue;
    }
    Value& value = changed(other->changed_values_, &Value::offset, change.entry.offset);
    value.length = static_cast<std::uint8_t>(std::min<std::size_t>(change.value.size(), length));
    value.value = can::load_value(std::span(change.value).first(value.length));
  }
  other->changed_values_.shrink_to_fit();
  other->changed_slots_.shrink_to_fit();
  return other;
}

// Entries that are there already, one after another as these, are not added again.
std::uint32_t DictionaryDescription::Layout::add_entries(
    const std::vector<EntryDescription>& added, std::unordered_multimap<std::size_t, std::uint32_t>& known) {
  std::size_t hash = added.size();
  for (const EntryDescription& entry : added) {
    const std::size_t what = std::size_t{entry.offset} << 32U | entry.name;
    const std::size_t how = std::size_t{entry.limits} << 16U | static_cast<std::size_t>(entry.type) << 8U |
                            static_cast<std::size_t>(entry.access);
    hash = (hash ^ what ^ how << 8U) * 0x9E37'79B9'7F4A'7C15U;
    hash ^= hash >> 32U;
  }
  const auto [first, last] = known.equal_range(hash);
  for (auto place = first; place != last; ++place) {
    const auto there = std::span(entries).subspan(place->second);
    if (there.size() >= added.size() && std::ranges::equal(there.first(added.size()), added))
      return place->second;
  }
  const auto number = static_cast<std::uint32_t>(entries.size());
  entries.insert(entries.end(), added.begin(), added.end());
  known.emplace(hash, number);
  return number;
}

std::vector<std::uint8_t> text(std::string_view value) { return {value.begin(), value.end()}; }

}  // namespace canopus::canopen
