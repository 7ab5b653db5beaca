#include "canopus/canopen/dictionary/dictionary_description.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace canopus::canopen {

Entry DictionaryDescription::find(std::uint16_t index, std::uint8_t sub) const noexcept {
  const ObjectDescription* object = find(index);
  return object == nullptr ? Entry{} : find(*object, sub);
}

void DictionaryDescription::load_defaults(std::span<std::uint8_t> block,
                                          std::uint8_t node_id) const noexcept {
  std::copy_n(image_.begin(), block.size(), block.begin());
  for (const NodeIdDefault& place : node_id_defaults_) {
    if (place.offset + place.length > block.size()) break;  // in order of offset
    unsigned carry = node_id;
    for (std::uint8_t i = 0; i < place.length && carry != 0; ++i) {
      carry += block[place.offset + i];
      block[place.offset + i] = static_cast<std::uint8_t>(carry);
      carry >>= 8;
    }
  }
}

std::shared_ptr<const DictionaryDescription> DictionaryDescription::with(
    std::span<const Change> changes) const {
  auto copy = std::make_shared<DictionaryDescription>();
  for (std::size_t i = 0; i < pages_.size(); ++i) {
    if (pages_[i]) copy->pages_[i] = std::make_unique<std::array<std::uint16_t, 256>>(*pages_[i]);
  }
  copy->objects_ = objects_;
  copy->entries_ = entries_;
  copy->names_ = names_;
  copy->limits_ = limits_;
  copy->image_ = image_;
  copy->slots_ = slots_;
  copy->node_id_defaults_ = node_id_defaults_;
  copy->communication_block_size_ = communication_block_size_;
  copy->communication_slot_count_ = communication_slot_count_;
  for (const Change& change : changes) {
    if (change.entry.description->length == 0) {
      copy->slots_[change.entry.offset] = change.value;
      continue;
    }
    std::copy_n(change.value.begin(),
                std::min<std::size_t>(change.value.size(), change.entry.description->length),
                copy->image_.begin() + change.entry.offset);
    std::erase_if(copy->node_id_defaults_,
                  [&](const NodeIdDefault& place) { return place.offset == change.entry.offset; });
  }
  return copy;
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

std::shared_ptr<const DictionaryDescription> DictionaryBuilder::build() const {
  auto description = std::make_shared<DictionaryDescription>();
  DictionaryDescription& d = *description;
  std::unordered_map<std::string, std::uint32_t> known_names;
  const auto name_number = [&](const std::string& name) {
    const auto [place, is_new] = known_names.try_emplace(name, static_cast<std::uint32_t>(d.names_.size()));
    if (is_new) d.names_.push_back(name);
    return place->second;
  };
  d.limits_.emplace_back();  // number 0: no limits

  const auto place_entry = [&](const EntrySpec& spec, unsigned count) {
    EntryDescription entry;
    entry.name = name_number(spec.name);
    entry.type = spec.type;
    entry.access = spec.access;
    entry.rpdo_mappable = spec.rpdo_mappable;
    entry.tpdo_mappable = spec.tpdo_mappable;
    entry.stored = spec.stored;
    if (spec.limits.low || spec.limits.high) {
      entry.limits = static_cast<std::uint16_t>(d.limits_.size());
      d.limits_.push_back(spec.limits);
    }
    entry.length = static_cast<std::uint8_t>(byte_length(spec.type));
    if (entry.length == 0) {
      entry.offset = static_cast<std::uint32_t>(d.slots_.size());
      for (unsigned i = 0; i < count; ++i) d.slots_.push_back(spec.value);
      return entry;
    }
    if (entry.length == 2 || entry.length == 4 || entry.length == 8) {  // let whole words be loaded as such
      d.image_.resize((d.image_.size() + entry.length - 1U) / entry.length * entry.length);
    }
    entry.offset = static_cast<std::uint32_t>(d.image_.size());
    for (unsigned i = 0; i < count; ++i) {
      const std::size_t start = d.image_.size();
      d.image_.resize(start + entry.length);
      std::copy_n(spec.value.begin(), std::min<std::size_t>(spec.value.size(), entry.length),
                  d.image_.begin() + static_cast<std::ptrdiff_t>(start));
      if (spec.adds_node_id) {
        d.node_id_defaults_.push_back({static_cast<std::uint32_t>(start), entry.length});
      }
    }
    return entry;
  };

  bool in_communication_area = true;
  for (const auto& [index, spec] : objects_) {
    if (in_communication_area && index >= 0x2000) {
      in_communication_area = false;
      d.communication_block_size_ = d.image_.size();
      d.communication_slot_count_ = d.slots_.size();
    }
    ObjectDescription object;
    object.index = index;
    object.code = spec.code;
    object.uniform = spec.uniform_count != 0;
    object.name = name_number(spec.name);
    object.first_entry = static_cast<std::uint32_t>(d.entries_.size());
    object.highest_sub = object.uniform      ? spec.uniform_count
                         : spec.subs.empty() ? std::uint8_t{0}
                                             : spec.subs.rbegin()->first;
    const bool is_structured = spec.code == ObjectCode::array || spec.code == ObjectCode::record ||
                               spec.code == ObjectCode::structure_definition;
    if (is_structured && !spec.subs.contains(0)) {
      std::uint8_t highest = object.highest_sub;
      if (highest == 0xFF) {  // FFH describes the object itself and does not count
        const auto place = spec.subs.find(0xFF);
        highest = place == spec.subs.begin() ? std::uint8_t{0} : std::prev(place)->first;
      }
      d.entries_.push_back(place_entry({.name = "Highest sub-index supported",
                                        .type = DataType::unsigned8,
                                        .access = Access::constant,
                                        .value = {highest}},
                                       1));
    } else if (spec.subs.empty()) {
      d.entries_.emplace_back();  // an object without any sub-index
    }
    for (const auto& [sub, entry] : spec.subs) {
      const std::size_t wanted = object.first_entry + (object.uniform && sub != 0 ? 1U : sub);
      while (d.entries_.size() < wanted) d.entries_.emplace_back();  // a gap: no such sub-index
      d.entries_.push_back(place_entry(entry, object.uniform && sub != 0 ? spec.uniform_count : 1U));
    }
    auto& page = d.pages_[index >> 8];
    if (!page) {
      page = std::make_unique<std::array<std::uint16_t, 256>>();
      page->fill(DictionaryDescription::no_position);
    }
    (*page)[index & 0xFF] = static_cast<std::uint16_t>(d.objects_.size());
    d.objects_.push_back(object);
  }
  if (in_communication_area) {
    d.communication_block_size_ = d.image_.size();
    d.communication_slot_count_ = d.slots_.size();
  }
  return description;
}

std::vector<std::uint8_t> text(std::string_view value) { return {value.begin(), value.end()}; }

}  // namespace canopus::canopen
