#include "canopus/module/canopen/emergency_buffer.hpp"

#include <algorithm>

namespace canopus::module {

EmergencyBuffer::EmergencyBuffer(const std::optional<EmergencyBufferLayout>& layout, BufferMemory& memory)
    : layout_(layout.value_or(EmergencyBufferLayout{})),
      words_(layout_.has_words ? (layout_.stack + layout_.ring) * words_per_record : 0) {
  if (words_.empty()) return;
  memory.attach(layout_.first, layout_.first + static_cast<BufferAddress>(words_.size()) - 1, *this);
}

void EmergencyBuffer::record(const canopen::Emergency& message) {
  const std::size_t room = layout_.stack + layout_.ring;
  if (hold_clear_ || room == 0) return;
  active_.set(message.node_id, message.code != 0);
  if (number_ != 0xFF) ++number_;
  if (messages_.size() == room) {
    messages_.erase(messages_.begin() + static_cast<std::ptrdiff_t>(layout_.stack));  // the ring's oldest
  }
  messages_.push_back({message, number_});
}

const EmergencyBuffer::Received* EmergencyBuffer::next_unread() noexcept {
  const auto found = std::ranges::find(messages_, false, &Received::was_read);
  if (found == messages_.end()) return nullptr;
  found->was_read = true;
  return &*found;
}

void EmergencyBuffer::refresh() {
  if (words_.empty()) return;
  std::ranges::fill(words_, std::uint16_t{0});
  auto word = words_.begin();
  const auto pair = [](std::uint8_t high, std::uint8_t low) {
    return static_cast<std::uint16_t>(high << 8 | low);
  };
  for (const Received& received : messages_) {
    const canopen::Emergency& message = received.message;
    const auto& bytes = message.manufacturer;
    *word++ = message.node_id;
    *word++ = message.code;
    *word++ = pair(bytes[0], message.error_register);
    *word++ = pair(bytes[2], bytes[1]);
    *word++ = pair(bytes[4], bytes[3]);
  }
}

void EmergencyBuffer::clear() {
  messages_.clear();
  active_.reset();
  number_ = 0;
  std::ranges::fill(words_, std::uint16_t{0});
}

}  // namespace canopus::module
