#include "canopus/canopen/node/stored_parameters.hpp"

#include <utility>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/stored_values.hpp"

namespace canopus::canopen {
namespace {

constexpr std::uint32_t save_signature = 0x65766173;  // "save"
constexpr std::uint32_t load_signature = 0x64616F6C;  // "load"
constexpr std::uint32_t on_command = 1;
constexpr std::uint8_t all_parameters = 1;

bool is_in_group(std::uint8_t group, std::uint16_t index) {
  switch (group) {
    case all_parameters: return true;
    case 2: return index >= 0x1000 && index <= 0x1FFF;
    case 3: return index >= 0x6000 && index <= 0x9FFF;
    default: return index >= 0x2000 && index <= 0x5FFF;
  }
}

// Calls visit(entry) for each sub-index there is.
template <typename Visit>
void for_each_entry(const DictionaryDescription& description, Visit&& visit) {
  for (const ObjectDescription& object : description.objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      if (const Entry entry = description.find(object, static_cast<std::uint8_t>(sub))) visit(entry);
    }
  }
}

}  // namespace

StoredParameters::StoredParameters(NodeContext& node) : node_(node) {
  marks_entries_ = node.dictionary.description().marks_stored();
  const Entry save_all = node.dictionary.description().find(0x1010, 1);
  has_save_all_ = save_all && save_all.description->length != 0;
  save_all_ = has_save_all_ ? save_all.offset : 0;
  node.dictionary.attach(0x1010, 0x1011, *this);
}

bool StoredParameters::is_stored(const Entry& entry) const noexcept {
  const EntryDescription& d = *entry.description;
  if (marks_entries_) return d.stored;
  return is_writable(d.access) && is_readable(d.access) && d.type != DataType::domain && !d.rpdo_mappable &&
         !d.tpdo_mappable && entry.index >= 0x1000 && entry.index != 0x1003 && entry.index != 0x1010 &&
         entry.index != 0x1011;
}

StoredParameters::Image StoredParameters::load() { return store_ != nullptr ? store_->load() : own_image_; }

AbortCode StoredParameters::store(Image image) {
  if (store_ != nullptr) return store_->save(image);
  own_image_ = std::move(image);
  return AbortCode::none;
}

void StoredParameters::apply(std::uint16_t first, std::uint16_t last) {
  restore_pending_ = false;
  const auto wanted = [&](const Entry& entry) {
    return entry.index >= first && entry.index <= last && is_stored(entry);
  };
  const bool whole = apply_stored_values(load(), node_.options.stored_length, node_.dictionary, wanted);
  if (!whole && store_ != nullptr) store_->found_damaged();
}

// What is stored beside a group.
StoredParameters::Image StoredParameters::load_others(std::uint8_t group) {
  Image others;
  if (group == all_parameters) return others;
  const StoredLength form = node_.options.stored_length;
  const Image whole = load();
  if (!are_stored_values(whole, form)) return others;
  StoredValueReader reader(whole, form);
  while (const auto value = reader.next()) {
    if (!is_in_group(group, value->index)) {
      append_stored_value(others, form, value->index, value->sub, value->bytes);
    }
  }
  return others;
}

AbortCode StoredParameters::save(std::uint8_t group) {
  const StoredLength form = node_.options.stored_length;
  Image image = load_others(group);
  bool all_fit = true;
  for_each_entry(node_.dictionary.description(), [&](const Entry& entry) {
    if (!is_in_group(group, entry.index) || !is_stored(entry)) return;
    const auto value = node_.dictionary.bytes(entry);
    all_fit = all_fit && value.size() <= longest_stored_value(form);
    if (all_fit) append_stored_value(image, form, entry.index, entry.sub, value);
  });
  return all_fit ? store(std::move(image)) : AbortCode::cannot_store;
}

AbortCode StoredParameters::restore(std::uint8_t group) {
  const AbortCode code = store(load_others(group));
  if (code == AbortCode::none) restore_pending_ = true;
  return code;
}

void StoredParameters::save_written(const Entry& entry) {
  if (restore_pending_) return;
  if (entry.index != 0x1010 && entry.index != 0x1011 && is_stored(entry)) {
    static_cast<void>(save(all_parameters));
  }
}

AbortCode StoredParameters::before_read(ObjectDictionary& dictionary, const Entry& entry, can::Time) {
  if (entry.sub != 0) dictionary.set(entry, dictionary.get<std::uint32_t>(entry) | on_command);
  return AbortCode::none;
}

AbortCode StoredParameters::before_write(ObjectDictionary& dictionary, const Entry& entry,
                                         std::span<const std::uint8_t> value, can::Time) {
  if (entry.sub == 0) return AbortCode::write_of_read_only;
  const bool saves = entry.index == 0x1010;
  if (can::load_u32(value) != (saves ? save_signature : load_signature)) return AbortCode::cannot_store;
  if (saves && restore_pending_ && !node_.options.save_before_restored) return AbortCode::device_state;
  value_before_ = dictionary.get<std::uint32_t>(entry);
  return saves ? save(entry.sub) : restore(entry.sub);
}

void StoredParameters::after_write(ObjectDictionary& dictionary, const Entry& entry, can::Time) {
  dictionary.set(entry, value_before_);  // the signature is a command, not a value
}

}  // namespace canopus::canopen
