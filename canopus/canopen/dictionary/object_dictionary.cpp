#include "canopus/canopen/dictionary/object_dictionary.hpp"

#include <algorithm>
#include <stdexcept>

namespace canopus::canopen {

ObjectDictionary::ObjectDictionary(std::shared_ptr<const DictionaryDescription> description,
                                   std::uint8_t node_id)
    : block_(description->block_size() + spare),
      description_(std::move(description)),
      slots_(description_->slot_count()),
      handler_numbers_(description_->objects().size()),
      handlers_{nullptr} {
  description_->load_defaults(block(), node_id);
}

std::expected<Entry, AbortCode> ObjectDictionary::find(std::uint16_t index, std::uint8_t sub) const noexcept {
  const ObjectDescription* object = description_->find(index);
  if (object == nullptr) return std::unexpected(AbortCode::no_object);
  const Entry entry = description_->find(*object, sub);
  if (!entry) return std::unexpected(AbortCode::no_sub_index);
  return entry;
}

AbortCode ObjectDictionary::prepare_read(std::uint16_t index, std::uint8_t sub, can::Time now, Entry& found) {
  const ObjectDescription* object = description_->find(index);
  if (object == nullptr) return AbortCode::no_object;
  found = description_->find(*object, sub);
  if (!found) return AbortCode::no_sub_index;
  if (!is_readable(found.description->access)) return AbortCode::read_of_write_only;
  ObjectHandler* behaviour = handler(*object);
  return behaviour != nullptr ? behaviour->before_read(*this, found, now) : AbortCode::none;
}

std::expected<std::span<const std::uint8_t>, AbortCode> ObjectDictionary::read(std::uint16_t index,
                                                                               std::uint8_t sub,
                                                                               can::Time now) {
  Entry entry;
  if (const AbortCode code = prepare_read(index, sub, now, entry); code != AbortCode::none) {
    return std::unexpected(code);
  }
  return bytes(entry);
}

ObjectStream* ObjectDictionary::stream(const Entry& entry) const {
  if (entry.description->length != 0) return nullptr;
  ObjectHandler* behaviour = handler(*description_->find(entry.index));
  return behaviour != nullptr ? behaviour->stream(entry) : nullptr;
}

AbortCode ObjectDictionary::write(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> value,
                                  can::Time now) {
  const ObjectDescription* object = description_->find(index);
  if (object == nullptr) return AbortCode::no_object;
  const Entry entry = description_->find(*object, sub);
  if (!entry) return AbortCode::no_sub_index;
  if (const AbortCode code = description_->check_write(entry, value); code != AbortCode::none) return code;
  ObjectHandler* behaviour = handler(*object);
  if (behaviour != nullptr) {
    if (const AbortCode code = behaviour->before_write(*this, entry, value, now); code != AbortCode::none) {
      return code;
    }
  }
  assign(entry, value);
  if (behaviour != nullptr) behaviour->after_write(*this, entry, now);
  if (write_observer_ != nullptr) write_observer_->object_written(entry, now);
  return AbortCode::none;
}

std::span<const std::uint8_t> ObjectDictionary::bytes(const Entry& entry) const noexcept {
  if (entry.description->length != 0) return {&block_[entry.offset], entry.description->length};
  const auto& slot = slots_[entry.offset];
  return slot ? std::span<const std::uint8_t>(*slot) : description_->default_bytes(entry.offset);
}

void ObjectDictionary::assign(const Entry& entry, std::span<const std::uint8_t> value) {
  if (entry.description->length != 0) {
    std::copy_n(value.begin(), std::min<std::size_t>(value.size(), entry.description->length),
                block_.begin() + entry.offset);
    return;
  }
  auto& slot = slots_[entry.offset];
  if (!slot) {
    slot = std::make_unique<std::vector<std::uint8_t>>(value.begin(), value.end());
  } else {
    slot->assign(value.begin(), value.end());
  }
}

void ObjectDictionary::attach(std::uint16_t first, std::uint16_t last, ObjectHandler& handler) {
  auto known = std::find(handlers_.begin(), handlers_.end(), &handler);
  if (known == handlers_.end()) {
    if (handlers_.size() > 0xFF) throw std::length_error("an object dictionary has at most 255 handlers");
    // A usual node has nine; there are many nodes.
    constexpr std::size_t usual = 9;
    if (handlers_.size() == handlers_.capacity())
      handlers_.reserve(std::max(usual + 1, handlers_.size() + 2));
    known = handlers_.insert(handlers_.end(), &handler);
  }
  last_short_ = {};
  const auto number = static_cast<std::uint8_t>(known - handlers_.begin());
  for (const ObjectDescription& object : description_->objects(first, last)) {
    handler_numbers_[description_->position(object)] = number;
  }
}

void ObjectDictionary::restore(const Attachments& earlier) noexcept {
  std::ranges::copy(earlier.handler_numbers, handler_numbers_.begin());
  handlers_.resize(earlier.handlers);
  last_short_ = {};
}

void ObjectDictionary::reset(std::uint8_t node_id) {
  description_->load_defaults(block(), node_id);
  for (auto& slot : slots_) slot.reset();
}

void ObjectDictionary::reset_communication(std::uint8_t node_id) {
  description_->load_defaults(std::span(block_).first(description_->communication_block_size()), node_id);
  for (std::size_t i = 0; i < description_->communication_slot_count(); ++i) slots_[i].reset();
}

}  // namespace canopus::canopen
