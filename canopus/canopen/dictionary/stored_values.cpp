#include "canopus/canopen/dictionary/stored_values.hpp"

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"

namespace canopus::canopen {

namespace {

constexpr std::size_t head_length(StoredLength form) { return 3 + static_cast<std::size_t>(form); }

}  // namespace

void append_stored_value(std::vector<std::uint8_t>& image, StoredLength form, std::uint16_t index,
                         std::uint8_t sub, std::span<const std::uint8_t> value) {
  can::append_value(image, index, 2);
  image.push_back(sub);
  can::append_value(image, value.size(), static_cast<unsigned>(form));
  image.insert(image.end(), value.begin(), value.end());
}

std::optional<StoredValue> StoredValueReader::next() noexcept {
  if (rest_.empty() || !intact_) return std::nullopt;
  const std::size_t head = head_length(form_);
  const std::uint64_t length =
      rest_.size() < head ? 0 : can::load_value(&rest_[3], static_cast<unsigned>(form_));
  if (rest_.size() < head + length) {
    intact_ = false;
    return std::nullopt;
  }
  const StoredValue value{can::load_as<std::uint16_t>(&rest_[0]), rest_[2], rest_.subspan(head, length)};
  rest_ = rest_.subspan(head + length);
  return value;
}

bool are_stored_values(std::span<const std::uint8_t> image, StoredLength form) noexcept {
  StoredValueReader reader(image, form);
  while (reader.next()) {
  }
  return reader.intact();
}

bool apply_stored_values(std::span<const std::uint8_t> image, StoredLength form, ObjectDictionary& dictionary,
                         const std::function<bool(const Entry&)>& wanted) {
  if (!are_stored_values(image, form)) return false;
  bool all_fit = true;
  StoredValueReader reader(image, form);
  while (const auto value = reader.next()) {
    const Entry entry = dictionary.description().find(value->index, value->sub);
    if (!entry) continue;
    const std::uint8_t fixed = entry.description->length;
    const bool fits = fixed == 0 || fixed == value->bytes.size();
    all_fit = all_fit && fits;
    if (fits && wanted(entry)) dictionary.assign(entry, value->bytes);
  }
  return all_fit;
}

}  // namespace canopus::canopen
