#include "canopus/canopen/dictionary/dictionary_description.hpp"

#include <algorithm>
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

DictionaryBuilder& DictionaryBuilder::variable(std::uint16_t index, EntrySpec spec) {
  ObjectSpec object;
  object.code = spec.type == DataType::domain ? ObjectCode::domain : ObjectCode::variable;
  object.name = spec.name;
  object.subs.emplace(std::uint8_t{0}, std::move(spec));
  objects_.insert_or_assign(index, std::move(object));
  return *this;
}

DictionaryBuilder& DictionaryBuilder::object(std::uint16_t index, ObjectCode code, std::string name) {
  ObjectSpec& object = objects_[index];
  object.code = code;
  object.name = std::move(name);
  return *this;
}

DictionaryBuilder& DictionaryBuilder::sub(std::uint16_t index, std::uint8_t sub, EntrySpec spec) {
  ObjectSpec& object = objects_[index];
  if (object.uniform_count != 0 && sub != 0) {  // no longer all alike: describe each on its own
    const EntrySpec common = object.subs.at(1);
    for (unsigned i = 2; i <= object.uniform_count; ++i) {
      object.subs.try_emplace(static_cast<std::uint8_t>(i), common);
    }
    object.uniform_count = 0;
  }
  object.subs.insert_or_assign(sub, std::move(spec));
  return *this;
}

DictionaryBuilder& DictionaryBuilder::uniform(std::uint16_t index, ObjectCode code, std::string name,
                                              std::uint8_t count, EntrySpec spec) {
  ObjectSpec object;
  object.code = code;
  object.name = std::move(name);
  object.uniform_count = count;
  object.subs.emplace(std::uint8_t{1}, std::move(spec));
  objects_.insert_or_assign(index, std::move(object));
  return *this;
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

std::shared_ptr<const DictionaryDescription> DictionaryBuilder::build() const {
  auto layout = std::make_shared<DictionaryDescription::Layout>();
  DictionaryDescription::Layout& d = *layout;
  std::unordered_map<std::string_view, std::uint32_t> known_names;  // of the specifications' own strings
  const auto name_number = [&](std::string_view name) {
    const auto [place, is_new] = known_names.try_emplace(name, 0);
    if (is_new) place->second = d.add_name(name);
    return place->second;
  };
  std::map<Limits, std::uint16_t> known_limits;
  const auto limits_number = [&](const Limits& limits) -> std::uint16_t {
    if (!limits.low && !limits.high) return 0;
    const auto [place, is_new] = known_limits.try_emplace(limits, 0);
    if (is_new) {
      d.limits.push_back(limits);
      place->second = static_cast<std::uint16_t>(d.limits.size());
    }
    return place->second;
  };

  // Lets whole words be loaded as such.
  const auto align = [&d](unsigned length) {
    if (length == 2 || length == 4 || length == 8)
      d.image.resize((d.image.size() + length - 1U) / length * length);
  };
  const auto place_entry = [&](const EntrySpec& spec, const ObjectSpec& object, std::uint32_t base,
                               unsigned count) {
    EntryDescription entry;
    entry.name = spec.name == object.name ? 0 : name_number(spec.name);
    entry.type = spec.type;
    entry.access = spec.access;
    entry.rpdo_mappable = spec.rpdo_mappable;
    entry.tpdo_mappable = spec.tpdo_mappable;
    entry.stored = spec.stored;
    d.marks_stored = d.marks_stored || spec.stored;
    entry.limits = limits_number(spec.limits);
    entry.length = static_cast<std::uint8_t>(byte_length(spec.type));
    entry.is_plainly_readable = entry.length != 0 && entry.length <= 4 && is_readable(entry.access);
    entry.is_plainly_writable = entry.length != 0 && entry.length <= 4 && is_writable(entry.access) &&
                                entry.limits == 0 && entry.type != DataType::boolean;
    if (entry.length == 0) {
      entry.offset = static_cast<std::uint32_t>(d.slots.size()) - base;
      for (unsigned i = 0; i < count; ++i) d.slots.push_back(spec.value);
      return entry;
    }
    align(entry.length);
    entry.offset = static_cast<std::uint32_t>(d.image.size()) - base;
    for (unsigned i = 0; i < count; ++i) {
      const std::size_t start = d.image.size();
      d.image.resize(start + entry.length);
      std::copy_n(spec.value.begin(), std::min<std::size_t>(spec.value.size(), entry.length),
                  d.image.begin() + static_cast<std::ptrdiff_t>(start));
      if (spec.adds_node_id) {
        d.node_id_defaults.push_back({static_cast<std::uint32_t>(start), entry.length});
      }
    }
    return entry;
  };

  std::vector<EntryDescription> entries;  // of an object
  std::unordered_multimap<std::size_t, std::uint32_t> known_entries;
  EntrySpec number_of_subs{
      .name = "Highest sub-index supported", .type = DataType::unsigned8, .access = Access::constant};
  bool in_communication_area = true;
  for (const auto& [index, spec] : objects_) {
    if (in_communication_area && index >= 0x2000) {
      in_communication_area = false;
      d.communication_block_size = d.image.size();
      d.communication_slot_count = d.slots.size();
    }
    ObjectDescription object;
    object.index = index;
    object.code = spec.code;
    object.uniform = spec.uniform_count != 0;
    object.name = name_number(spec.name) & 0x7FFF'FFFFU;
    object.highest_sub = object.uniform      ? spec.uniform_count
                         : spec.subs.empty() ? std::uint8_t{0}
                                             : spec.subs.rbegin()->first;
    // Every object begins where its longest value may: so the values of objects that are alike lie alike.
    unsigned longest = 1;
    bool has_values = false;
    for (const auto& [sub, entry] : spec.subs) {
      const unsigned length = byte_length(entry.type);
      has_values = has_values || length != 0;
      if (length == 2 || length == 4 || length == 8) longest = std::max(longest, length);
    }
    const bool is_structured = spec.code == ObjectCode::array || spec.code == ObjectCode::record ||
                               spec.code == ObjectCode::structure_definition;
    const bool makes_number = is_structured && !spec.subs.contains(0);
    has_values = has_values || makes_number;
    if (has_values) align(longest);
    object.offset = static_cast<std::uint32_t>(has_values ? d.image.size() : d.slots.size());
    entries.clear();
    if (makes_number) {
      std::uint8_t highest = object.highest_sub;
      if (highest == 0xFF) {  // FFH describes the object itself and does not count
        const auto place = spec.subs.find(0xFF);
        highest = place == spec.subs.begin() ? std::uint8_t{0} : std::prev(place)->first;
      }
      number_of_subs.value = {highest};
      entries.push_back(place_entry(number_of_subs, spec, object.offset, 1));
    } else if (spec.subs.empty()) {
      entries.emplace_back();  // an object without any sub-index
    }
    for (const auto& [sub, entry] : spec.subs) {
      const std::size_t wanted = object.uniform && sub != 0 ? 1U : sub;
      while (entries.size() < wanted) entries.emplace_back();  // a gap: no such sub-index
      entries.push_back(
          place_entry(entry, spec, object.offset, object.uniform && sub != 0 ? spec.uniform_count : 1U));
    }
    object.first_entry = d.add_entries(entries, known_entries);
    d.objects.push_back(object);
  }
  if (in_communication_area) {
    d.communication_block_size = d.image.size();
    d.communication_slot_count = d.slots.size();
  }
  d.index_objects();
  d.objects.shrink_to_fit();
  d.entries.shrink_to_fit();
  d.text.shrink_to_fit();
  d.limits.shrink_to_fit();
  d.image.shrink_to_fit();
  d.slots.shrink_to_fit();
  d.node_id_defaults.shrink_to_fit();
  return std::make_shared<const DictionaryDescription>(DictionaryDescription(std::move(layout)));
}

std::vector<std::uint8_t> text(std::string_view value) { return {value.begin(), value.end()}; }

}  // namespace canopus::canopen
