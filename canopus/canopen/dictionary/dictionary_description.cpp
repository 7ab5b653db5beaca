#include "canopus/canopen/dictionary/dictionary_description.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include "canopus/canopen/dictionary/dictionary_draft.hpp"

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
    : positions_(layout->of(layout->positions).data()),
      objects_(layout->of(layout->objects).data()),
      entries_(layout->of(layout->entries).data()),
      multiplier_(layout->multiplier),
      places_(layout->places),
      layout_(std::move(layout)) {}

std::string_view DictionaryDescription::Layout::name(std::uint32_t number) const noexcept {
  if (number == highest_sub_name_number) return highest_sub_name;
  const auto names = of(text);
  std::size_t length = 0;
  unsigned shift = 0;
  for (;; shift += 7) {
    const auto byte = static_cast<unsigned char>(names[number++]);
    length |= std::size_t{byte & 0x7FU} << shift;
    if (byte < 0x80) break;
  }
  return {names.data() + number, length};
}

std::span<const std::uint8_t> DictionaryDescription::default_bytes(std::uint32_t slot) const noexcept {
  if (changes_ != nullptr) {
    for (const Slot& changed : changes_->slots) {
      if (changed.number == slot) return changed.bytes;
    }
  }
  const auto ends = layout_->of(layout_->slot_ends);
  const std::uint32_t begin = slot == 0 ? 0 : ends[slot - 1];
  return layout_->of(layout_->slot_bytes).subspan(begin, ends[slot] - begin);
}

void DictionaryDescription::load_defaults(std::span<std::uint8_t> block,
                                          std::uint8_t node_id) const noexcept {
  std::copy_n(layout_->of(layout_->image).begin(), block.size(), block.begin());
  for (const NodeIdDefault& place : layout_->of(layout_->node_id_defaults)) {
    if (std::size_t{place.offset} + place.length > block.size()) break;  // in order of offset
    unsigned carry = node_id;
    for (std::uint32_t i = 0; i < place.length && carry != 0; ++i) {
      carry += block[place.offset + i];
      block[place.offset + i] = static_cast<std::uint8_t>(carry);
      carry >>= 8;
    }
  }
  if (changes_ == nullptr) return;
  for (const Value& changed : changes_->values) {
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
  if (changes_ != nullptr) {
    for (const Value& changed : changes_->values) {
      if (changed.offset == entry.offset && changed.length == length) return changed.value;
    }
  }
  const std::uint64_t value = can::load_value(layout_->of(layout_->image).data() + entry.offset, length);
  const auto with_node_id = layout_->of(layout_->node_id_defaults);
  const auto place = std::ranges::lower_bound(
      with_node_id, entry.offset, {}, [](const NodeIdDefault& one) -> std::uint32_t { return one.offset; });
  if (place == with_node_id.end() || place->offset != entry.offset) return value;
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
  const Limits& limits = layout_->of(layout_->limits)[d.limits - 1U];
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
  auto other = std::make_shared<DictionaryDescription>(DictionaryDescription(layout_));
  auto all_changes = changes_ == nullptr ? std::make_unique<Changes>() : std::make_unique<Changes>(*changes_);
  const auto changed = [](auto& all, auto member, std::uint32_t number) -> auto& {
    const auto known = std::ranges::find(all, number, member);
    if (known != all.end()) return *known;
    all.emplace_back().*member = number;
    return all.back();
  };
  for (const Change& change : changes) {
    const std::uint8_t length = change.entry.description->length;
    if (length == 0) {
      changed(all_changes->slots, &Slot::number, change.entry.offset).bytes = change.value;
      continue;
    }
    Value& value = changed(all_changes->values, &Value::offset, change.entry.offset);
    value.length = static_cast<std::uint8_t>(std::min<std::size_t>(change.value.size(), length));
    value.value = can::load_value(std::span(change.value).first(value.length));
  }
  all_changes->values.shrink_to_fit();
  all_changes->slots.shrink_to_fit();
  other->changes_ = std::move(all_changes);
  return other;
}

std::vector<std::uint8_t> text(std::string_view value) { return {value.begin(), value.end()}; }

}  // namespace canopus::canopen
