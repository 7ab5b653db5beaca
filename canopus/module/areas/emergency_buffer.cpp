#include "canopus/module/areas/emergency_buffer.hpp"

#include <algorithm>

namespace canopus::module {

EmergencyBuffer::EmergencyBuffer(const std::optional<EmergencyBufferLayout>& layout, BufferMemory& memory)
    : layout_(layout.value_or(EmergencyBufferLayout{})),
      words_((layout_.stack + layout_.ring) * words_per_record) {
  if (words_.empty()) return;
  memory.attach(layout_.first, layout_.first + static_cast<BufferAddress>(words_.size()) - 1, *this);
}

void EmergencyBuffer::record(const canopen::Emergency& message) {
  if (hold_clear_ || words_.empty()) return;
  if (messages_.size() == layout_.stack + layout_.ring) {
    messages_.erase(messages_.begin() + static_cast<std::ptrdiff_t>(layout_.stack));  // the ring's oldest
  }
  messages_.push_back(message);
}

void EmergencyBuffer::refresh() {
  std::ranges::fill(words_, std::uint16_t{0});
  auto word = words_.begin();
  const auto pair = [](std::uint8_t high, std::uint8_t low) {
    return static_cast<std::uint16_t>(high << 8 | low);
  };
  for (const canopen::Emergency& message : messages_) {
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
  std::ranges::fill(words_, std::uint16_t{0});
}

}  // namespace canopus::module
