#include "canopus/canopen/pdo/pdo_mapping.hpp"

#include <algorithm>
#include <vector>

namespace canopus::canopen {
namespace {

constexpr std::uint8_t maximum_mapped_objects = 0x40;
constexpr std::uint16_t first_of_application = 0x2000;

struct Mapping {
  explicit Mapping(std::uint32_t value)
      : index(static_cast<std::uint16_t>(value >> 16)),
        sub(static_cast<std::uint8_t>(value >> 8)),
        bits(static_cast<std::uint8_t>(value)) {}
  std::uint16_t index;
  std::uint8_t sub;
  std::uint8_t bits;
};

// 0001H-0007H; a dictionary that has 0008H itself says which ones it has.
bool is_dummy(const ObjectDictionary& dictionary, const Mapping& mapping) {
  if (mapping.sub != 0 || mapping.index == 0 || mapping.index > 8) return false;
  const DictionaryDescription& description = dictionary.description();
  return description.find(8) != nullptr ? description.find(mapping.index) != nullptr : mapping.index != 8;
}

}  // namespace

void CopyPlan::clear() {
  first_ = no_step;
  rest_.reset();
  rest_count_ = 0;
  length_ = 0;
  is_single_ = false;
  places_ = 0;
}

std::uint64_t CopyPlan::gather_steps(const std::uint8_t* block) const noexcept {
  std::uint64_t frame = gather(first_, block);
  for (const Step& step : rest()) frame |= gather(step, block);
  return frame;
}

void CopyPlan::scatter_steps(std::uint64_t frame, std::uint8_t* block) const noexcept {
  scatter(first_, frame, block);
  for (const Step& step : rest()) scatter(step, frame, block);
}

void CopyPlan::compile(const ObjectDictionary& dictionary, std::uint16_t index) {
  clear();
  const auto count = dictionary.get<std::uint8_t>(index, 0);
  if (count > maximum_mapped_objects) return;
  std::vector<Step> steps;
  unsigned position = 0;
  for (std::uint8_t sub = 1; sub <= count; ++sub) {
    const Mapping mapping(dictionary.get<std::uint32_t>(index, sub));
    if (position + mapping.bits > 64) break;
    const Entry entry = dictionary.description().find(mapping.index, mapping.sub);
    const bool exists = entry && entry.description->length != 0 && entry.description->length <= 8 &&
                        mapping.bits != 0 && !is_dummy(dictionary, mapping);
    if (exists) {
      places_ |= mapping.index < first_of_application
                     ? all_values
                     : value_mask_of(entry.offset, entry.description->length);
      Step step{entry.offset, static_cast<std::uint8_t>(position), mapping.bits, entry.description->length};
      const bool aligned = position % 8 == 0 && mapping.bits == step.bytes * 8;
      const bool continues = aligned && !steps.empty() && steps.back().bits == steps.back().bytes * 8 &&
                             steps.back().bit + steps.back().bits == step.bit &&
                             steps.back().offset + steps.back().bytes == step.offset;
      if (continues) {
        steps.back().bits = static_cast<std::uint8_t>(steps.back().bits + step.bits);
        steps.back().bytes = static_cast<std::uint8_t>(steps.back().bytes + step.bytes);
      } else {
        steps.push_back(step);
      }
    }
    position += mapping.bits;
  }
  length_ = static_cast<std::uint8_t>((position + 7) / 8);
  if (steps.empty()) {
    places_ = all_values;
    return;
  }
  first_ = steps.front();
  rest_count_ = static_cast<std::uint8_t>(steps.size() - 1);
  if (rest_count_ != 0) {
    rest_ = std::make_unique<Step[]>(rest_count_);
    std::copy(steps.begin() + 1, steps.end(), rest_.get());
  }
  is_single_ = rest_count_ == 0 && first_.bits == 8 * first_.bytes;
}

bool CopyPlan::holds(std::uint32_t offset, std::uint8_t length) const noexcept {
  const auto overlaps = [&](const Step& step) {
    return offset < step.offset + step.bytes && step.offset < offset + length;
  };
  return overlaps(first_) || std::ranges::any_of(rest(), overlaps);
}

std::pair<std::uint32_t, std::uint32_t> CopyPlan::extent() const noexcept {
  if (first_.bytes == 0) return {0, 0};
  std::pair<std::uint32_t, std::uint32_t> extent{first_.offset, first_.offset + first_.bytes};
  for (const Step& step : rest()) {
    extent.first = std::min(extent.first, step.offset);
    extent.second = std::max(extent.second, step.offset + step.bytes);
  }
  return extent;
}

AbortCode check_mapping_entry(const ObjectDictionary& dictionary, std::uint32_t value,
                              PdoDirection direction) noexcept {
  const Mapping mapping(value);
  if (is_dummy(dictionary, mapping)) {
    const bool fits = direction == PdoDirection::receive &&
                      mapping.bits == bit_length(static_cast<DataType>(mapping.index));
    return fits ? AbortCode::none : AbortCode::not_mappable;
  }
  const auto entry = dictionary.find(mapping.index, mapping.sub);
  if (!entry) return entry.error();
  const EntryDescription& d = *entry->description;
  const bool mappable = direction == PdoDirection::receive ? d.rpdo_mappable && is_writable(d.access)
                                                           : d.tpdo_mappable && is_readable(d.access);
  const bool fits = mapping.bits == bit_length(d.type) ||
                    (d.type == DataType::boolean && mapping.bits == 8);  // some devices give it a byte
  return mappable && fits && d.length != 0 ? AbortCode::none : AbortCode::not_mappable;
}

AbortCode check_mapping_write(const ObjectDictionary& dictionary, const Entry& entry,
                              std::span<const std::uint8_t> value, bool valid,
                              PdoDirection direction) noexcept {
  if (valid) return AbortCode::device_state;
  if (entry.sub != 0) {
    if (dictionary.get<std::uint8_t>(entry.index, 0) != 0) return AbortCode::unsupported_access;
    std::uint32_t mapping = 0;
    std::memcpy(&mapping, value.data(), std::min<std::size_t>(value.size(), 4));
    return mapping == 0 ? AbortCode::none : check_mapping_entry(dictionary, mapping, direction);
  }
  const std::uint8_t count = value.empty() ? std::uint8_t{0} : value[0];
  if (count > maximum_mapped_objects) return AbortCode::invalid_value;
  const ObjectDescription* object = dictionary.description().find(entry.index);
  if (object == nullptr || count > object->highest_sub) return AbortCode::mapping_length;
  unsigned bits = 0;
  for (std::uint8_t sub = 1; sub <= count; ++sub) {
    const Entry place = dictionary.description().find(entry.index, sub);
    if (!place) return AbortCode::mapping_length;
    const auto mapping = dictionary.get<std::uint32_t>(place);
    if (const AbortCode code = check_mapping_entry(dictionary, mapping, direction); code != AbortCode::none) {
      return code;
    }
    bits += mapping & 0xFF;
  }
  return bits > 64 ? AbortCode::mapping_length : AbortCode::none;
}

}  // namespace canopus::canopen
