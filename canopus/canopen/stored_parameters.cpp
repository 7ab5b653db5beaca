#include "canopus/canopen/stored_parameters.hpp"

#include <utility>

#include "canopus/canopen/cob_id.hpp"

namespace canopus::canopen {
namespace {

constexpr std::uint32_t save_signature = 0x65766173;  // "save"
constexpr std::uint32_t load_signature = 0x64616F6C;  // "load"
constexpr std::uint32_t on_command = 1;
constexpr std::uint32_t autonomously = 2;

bool is_in_group(std::uint8_t group, std::uint16_t index) {
  switch (group) {
    case 1: return true;
    case 2: return index >= 0x1000 && index <= 0x1FFF;
    case 3: return index >= 0x6000 && index <= 0x9FFF;
    default: return index >= 0x2000 && index <= 0x5FFF;
  }
}

// The image: for each value its index (2 bytes), sub-index (1), length (4) and bytes, in order of index.
struct Record {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::span<const std::uint8_t> whole;
  std::span<const std::uint8_t> value;
};

constexpr std::size_t header_size = 7;

// Calls visit(record) for each record; stops at the first that is not complete.
template <typename Visit>
void for_each_record(std::span<const std::uint8_t> image, Visit&& visit) {
  while (image.size() >= header_size) {
    const std::size_t length = CobId::from(image.subspan(3, 4)).raw;
    if (length > image.size() - header_size) return;
    visit(Record{static_cast<std::uint16_t>(image[0] | image[1] << 8), image[2],
                 image.first(header_size + length), image.subspan(header_size, length)});
    image = image.subspan(header_size + length);
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

void append(std::vector<std::uint8_t>& image, const Entry& entry, std::span<const std::uint8_t> value) {
  image.push_back(static_cast<std::uint8_t>(entry.index));
  image.push_back(static_cast<std::uint8_t>(entry.index >> 8));
  image.push_back(entry.sub);
  for (const std::uint8_t byte : little_endian(value.size(), 4)) image.push_back(byte);
  image.insert(image.end(), value.begin(), value.end());
}

}  // namespace

StoredParameters::StoredParameters(NodeContext& node) : node_(node) {
  for_each_entry(node.dictionary.description(), [this](const Entry& entry) {
    marks_entries_ = marks_entries_ || entry.description->stored;
  });
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

AbortCode StoredParameters::keep(Image image) {
  if (store_ != nullptr) return store_->save(image);
  own_image_ = std::move(image);
  return AbortCode::none;
}

void StoredParameters::apply(std::uint16_t first, std::uint16_t last) {
  restore_pending_ = false;
  for_each_record(load(), [&](const Record& record) {
    if (record.index < first || record.index > last) return;
    const Entry entry = node_.dictionary.description().find(record.index, record.sub);
    if (!entry || !is_stored(entry)) return;
    const std::uint8_t length = entry.description->length;
    if (length == 0 || length == record.value.size()) node_.dictionary.assign(entry, record.value);
  });
}

AbortCode StoredParameters::save(std::uint8_t group) {
  Image image;
  for_each_record(load(), [&](const Record& record) {
    if (is_in_group(group, record.index)) return;
    image.insert(image.end(), record.whole.begin(), record.whole.end());
  });
  for_each_entry(node_.dictionary.description(), [&](const Entry& entry) {
    if (is_in_group(group, entry.index) && is_stored(entry)) {
      append(image, entry, node_.dictionary.bytes(entry));
    }
  });
  return keep(std::move(image));
}

AbortCode StoredParameters::restore(std::uint8_t group) {
  Image image;
  for_each_record(load(), [&](const Record& record) {
    if (is_in_group(group, record.index)) return;
    image.insert(image.end(), record.whole.begin(), record.whole.end());
  });
  const AbortCode code = keep(std::move(image));
  if (code == AbortCode::none) restore_pending_ = true;
  return code;
}

void StoredParameters::object_written(const Entry& entry) {
  if ((node_.dictionary.get<std::uint32_t>(0x1010, 1) & autonomously) == 0 || restore_pending_) return;
  if (entry.index != 0x1010 && entry.index != 0x1011 && is_stored(entry)) static_cast<void>(save(1));
}

AbortCode StoredParameters::before_read(ObjectDictionary& dictionary, const Entry& entry, can::Time) {
  if (entry.sub != 0) dictionary.set(entry, dictionary.get<std::uint32_t>(entry) | on_command);
  return AbortCode::none;
}

AbortCode StoredParameters::before_write(ObjectDictionary& dictionary, const Entry& entry,
                                         std::span<const std::uint8_t> value, can::Time) {
  if (entry.sub == 0) return AbortCode::write_of_read_only;
  const bool saves = entry.index == 0x1010;
  if (CobId::from(value).raw != (saves ? save_signature : load_signature)) return AbortCode::cannot_store;
  if (saves && restore_pending_) return AbortCode::device_state;
  value_before_ = dictionary.get<std::uint32_t>(entry);
  return saves ? save(entry.sub) : restore(entry.sub);
}

void StoredParameters::after_write(ObjectDictionary& dictionary, const Entry& entry, can::Time) {
  dictionary.set(entry, value_before_);  // the signature is a command, not a value
}

}  // namespace canopus::canopen
