#include <algorithm>
#include <array>
#include <utility>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/canopen/dictionary/dictionary_draft.hpp"

namespace canopus::canopen {

const DictionaryBuilder::EntryPlan* DictionaryBuilder::ObjectPlan::find(std::uint8_t sub) const noexcept {
  const auto place = std::ranges::lower_bound(subs, sub, {}, &EntryPlan::sub);
  return place == subs.end() || place->sub != sub ? nullptr : &*place;
}

void DictionaryBuilder::ObjectPlan::put(EntryPlan plan) {
  const auto place = std::ranges::lower_bound(subs, plan.sub, {}, &EntryPlan::sub);
  if (place != subs.end() && place->sub == plan.sub) {
    *place = plan;
  } else {
    subs.insert(place, plan);
  }
}

std::uint32_t DictionaryBuilder::name_number(std::string_view name) {
  const auto known = known_names_.find(name);
  if (known != known_names_.end()) return known->second;
  const auto number = static_cast<std::uint32_t>(known_names_.size());
  known_names_.emplace(name, number);
  return number;
}

DictionaryBuilder::EntryPlan DictionaryBuilder::plan(std::uint8_t sub, const EntrySpec& spec) {
  EntryPlan plan{.name = name_number(spec.name), .adds_node_id = spec.adds_node_id, .sub = sub};
  EntryDescription& entry = plan.description;
  entry.type = spec.type;
  entry.access = spec.access;
  entry.rpdo_mappable = spec.rpdo_mappable;
  entry.tpdo_mappable = spec.tpdo_mappable;
  entry.stored = spec.stored;
  entry.length = static_cast<std::uint8_t>(byte_length(spec.type));
  const bool has_limits = spec.limits.low || spec.limits.high;
  entry.is_plainly_readable = entry.length != 0 && entry.length <= 4 && is_readable(entry.access);
  entry.is_plainly_writable = entry.length != 0 && entry.length <= 4 && is_writable(entry.access) &&
                              !has_limits && entry.type != DataType::boolean;
  if (has_limits) {
    limits_.push_back(spec.limits);
    plan.limits = static_cast<std::uint32_t>(limits_.size());
  }
  if (entry.length != 0) {
    plan.value =
        can::load_value(std::span(spec.value).first(std::min<std::size_t>(spec.value.size(), entry.length)));
  } else if (!spec.value.empty()) {
    texts_.push_back(spec.value);
    plan.value = texts_.size();
  }
  return plan;
}

DictionaryBuilder& DictionaryBuilder::variable(std::uint16_t index, EntrySpec spec) {
  ObjectPlan object;
  object.code = spec.type == DataType::domain ? ObjectCode::domain : ObjectCode::variable;
  object.name = name_number(spec.name);
  object.put(plan(0, spec));
  objects_.insert_or_assign(index, std::move(object));
  return *this;
}

DictionaryBuilder& DictionaryBuilder::object(std::uint16_t index, ObjectCode code, std::string name) {
  ObjectPlan& object =
      objects_.try_emplace(index, ObjectPlan{.name = name_number({}), .subs = {}}).first->second;
  object.code = code;
  object.name = name_number(name);
  return *this;
}

DictionaryBuilder& DictionaryBuilder::sub(std::uint16_t index, std::uint8_t sub, EntrySpec spec) {
  ObjectPlan& object =
      objects_.try_emplace(index, ObjectPlan{.name = name_number({}), .subs = {}}).first->second;
  if (object.uniform_count != 0 && sub != 0) {  // no longer all alike: describe each on its own
    EntryPlan common = *object.find(1);
    for (unsigned i = 2; i <= object.uniform_count; ++i) {
      common.sub = static_cast<std::uint8_t>(i);
      if (object.find(common.sub) == nullptr) object.put(common);
    }
    object.uniform_count = 0;
  }
  object.put(plan(sub, spec));
  return *this;
}

DictionaryBuilder& DictionaryBuilder::uniform(std::uint16_t index, ObjectCode code, std::string name,
                                              std::uint8_t count, EntrySpec spec) {
  ObjectPlan object;
  object.code = code;
  object.name = name_number(name);
  object.uniform_count = count;
  object.put(plan(1, spec));
  objects_.insert_or_assign(index, std::move(object));
  return *this;
}

std::shared_ptr<const DictionaryDescription> DictionaryBuilder::build() const {
  DictionaryDescription::Draft d;
  std::vector<std::string_view> names(known_names_.size());
  for (const auto& [name, number] : known_names_) names[number] = name;
  std::vector<std::uint32_t> places(names.size());  // of those that are used: others were replaced
  const auto place_of_name = [&](std::uint32_t number) {
    if (places[number] == 0) places[number] = d.add_name(names[number]);
    return places[number];
  };
  std::map<Limits, std::uint16_t> known_limits;
  const auto limits_number = [&](std::uint32_t number) -> std::uint16_t {
    if (number == 0) return 0;
    const Limits& limits = limits_[number - 1];
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
  std::array<std::uint32_t, 256> starts{};  // of an object's values in the block, by sub-index
  const auto place_values = [&](const EntryPlan& plan, unsigned count) {
    const std::uint8_t length = plan.description.length;
    align(length);
    starts[plan.sub] = static_cast<std::uint32_t>(d.image.size());
    for (unsigned i = 0; i < count; ++i) {
      const std::size_t start = d.image.size();
      d.image.resize(start + length);
      can::store_value(&d.image[start], plan.value, length);
      if (plan.adds_node_id)
        d.node_id_defaults.push_back({static_cast<std::uint32_t>(start) & 0x0FFF'FFFFU, length & 0xFU});
    }
  };
  const auto place_entry = [&](const EntryPlan& plan, const ObjectPlan& object, std::uint32_t base,
                               unsigned count) {
    EntryDescription entry = plan.description;
    entry.name = plan.name == object.name ? 0 : place_of_name(plan.name);
    d.marks_stored = d.marks_stored || entry.stored;
    entry.limits = limits_number(plan.limits);
    if (entry.length == 0) {
      entry.offset = static_cast<std::uint32_t>(d.slots.size()) - base;
      const std::vector<std::uint8_t> text =
          plan.value == 0 ? std::vector<std::uint8_t>{} : texts_[plan.value - 1];
      d.slots.insert(d.slots.end(), count, text);
      return entry;
    }
    entry.offset = starts[plan.sub] - base;
    return entry;
  };

  std::vector<EntryDescription> entries;  // of an object
  std::unordered_multimap<std::size_t, std::uint32_t> known_entries;
  // The sub-index 00H that was not added.
  EntryPlan number_of_subs{};
  number_of_subs.description.type = DataType::unsigned8;
  number_of_subs.description.access = Access::constant;
  number_of_subs.description.length = 1;
  number_of_subs.description.is_plainly_readable = true;
  const std::string_view number_name = highest_sub_name;
  if (const auto known = known_names_.find(number_name); known != known_names_.end()) {
    number_of_subs.name = known->second;
  } else {
    number_of_subs.name = static_cast<std::uint32_t>(names.size());
    names.push_back(number_name);
    places.push_back(0);
  }
  bool in_communication_area = true;
  std::size_t slots_before_pdos = 0;
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
    object.name = place_of_name(spec.name) & 0x7FFF'FFFFU;
    object.highest_sub = object.uniform      ? spec.uniform_count
                         : spec.subs.empty() ? std::uint8_t{0}
                                             : spec.subs.back().sub;
    // Every object begins where its longest value may: so the values of objects that are alike lie alike.
    unsigned longest = 1;
    bool has_values = false;
    for (const EntryPlan& entry : spec.subs) {
      const unsigned length = entry.description.length;
      has_values = has_values || length != 0;
      if (length == 2 || length == 4 || length == 8) longest = std::max(longest, length);
    }
    const bool is_structured = spec.code == ObjectCode::array || spec.code == ObjectCode::record ||
                               spec.code == ObjectCode::structure_definition;
    const bool makes_number = is_structured && spec.find(0) == nullptr;
    has_values = has_values || makes_number;
    if (has_values) align(longest);
    object.offset = static_cast<std::uint32_t>(has_values ? d.image.size() : d.slots.size());
    entries.clear();
    if (makes_number) {
      std::uint8_t highest = object.highest_sub;
      if (highest == 0xFF) {  // FFH describes the object itself and does not count
        highest = spec.subs.size() < 2 ? std::uint8_t{0} : spec.subs[spec.subs.size() - 2].sub;
      }
      number_of_subs.value = highest;
    }
    // Longer values first: nothing is lost between them.
    for (const unsigned length : {8U, 4U, 2U, 1U}) {
      if (makes_number && length == 1) place_values(number_of_subs, 1);
      for (const EntryPlan& plan : spec.subs) {
        const unsigned bytes = plan.description.length;
        const bool is_whole = bytes == 8 || bytes == 4 || bytes == 2;
        if (bytes == 0 || (is_whole ? bytes : 1U) != length) continue;
        place_values(plan, object.uniform && plan.sub != 0 ? spec.uniform_count : 1U);
      }
    }
    if (makes_number) {
      entries.push_back(place_entry(number_of_subs, spec, object.offset, 1));
    } else if (spec.subs.empty()) {
      entries.emplace_back();  // an object without any sub-index
    }
    for (const EntryPlan& entry : spec.subs) {
      const bool stands_for_all = object.uniform && entry.sub != 0;
      const std::size_t wanted = stands_for_all ? 1U : entry.sub;
      while (entries.size() < wanted) entries.emplace_back();  // a gap: no such sub-index
      entries.push_back(place_entry(entry, spec, object.offset, stands_for_all ? spec.uniform_count : 1U));
    }
    object.first_entry = d.add_entries(entries, known_entries);
    d.objects.push_back(object);
    if (index < 0x1400) {
      d.pdo_values_begin = d.image.size();
      slots_before_pdos = d.slots.size();
    }
    if (index < 0x1C00) d.pdo_values_end = d.slots.size() == slots_before_pdos ? d.image.size() : 0;
  }
  if (in_communication_area) {
    d.communication_block_size = d.image.size();
    d.communication_slot_count = d.slots.size();
  }
  std::ranges::sort(d.node_id_defaults, {}, [](const auto& place) -> std::uint32_t { return place.offset; });
  return std::make_shared<const DictionaryDescription>(DictionaryDescription(d.pack()));
}

}  // namespace canopus::canopen
