// A program's access to the modules of a rack besides X and Y: buffer memory and registers.

#include <algorithm>
#include <array>

#include "canopus/module/interface/module.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plc {

namespace {

Device device_of(module::RegisterKind kind) {
  return kind == module::RegisterKind::data ? Device::d : Device::sd;
}

/// Calls `each(number, word)` for every word of `words`, from `first` on, that is a register of the module.
template <typename Word, typename Each>
void for_each_register(const module::RegisterAccess& access, Device device, std::uint32_t first,
                       std::span<Word> words, Each each) {
  for (const module::RegisterRange& range : access.registers()) {
    if (device_of(range.kind) != device) continue;
    const std::uint64_t end = std::min(std::uint64_t{range.last} + 1, std::uint64_t{first} + words.size());
    for (std::uint64_t number = std::max(range.first, first); number < end; ++number) {
      each(range.kind, static_cast<std::uint32_t>(number), words[number - first]);
    }
  }
}

}  // namespace

void Rack::read_registers(Device device, std::uint32_t first, std::span<std::uint16_t> words, can::Time now) {
  if (!on_) return;
  for (const Slot& slot : slots_) {
    if (slot.registers == nullptr) continue;
    for_each_register(*slot.registers, device, first, words,
                      [&](module::RegisterKind kind, std::uint32_t number, std::uint16_t& word) {
                        word = slot.registers->read_register(kind, number, now);
                      });
  }
}

void Rack::write_registers(Device device, std::uint32_t first, std::span<const std::uint16_t> words,
                           can::Time now) {
  if (!on_) return;
  for (const Slot& slot : slots_) {
    if (slot.registers == nullptr) continue;
    for_each_register(*slot.registers, device, first, words,
                      [&](module::RegisterKind kind, std::uint32_t number, std::uint16_t word) {
                        slot.registers->write_register(kind, number, word, now);
                      });
  }
}

bool Rack::is_module_register(Device device, std::uint32_t first, std::uint32_t count) const noexcept {
  const auto is_among = [&](const module::RegisterRange& range) {
    return device_of(range.kind) == device && range.first < first + count && first <= range.last;
  };
  return std::ranges::any_of(slots_, [&](const Slot& slot) {
    return slot.registers != nullptr && std::ranges::any_of(slot.registers->registers(), is_among);
  });
}

Rack::Access Rack::check_buffer(std::uint16_t head_address, module::BufferAddress first,
                                std::uint32_t count) const noexcept {
  const Slot* slot = slot_of_point(head_address);
  if (slot == nullptr || !on_) return std::unexpected(AccessError::no_module);
  const module::BufferAddress size = slot->buffer == nullptr ? 0 : slot->buffer->buffer_memory_size();
  if (first >= size || count > size - first) return std::unexpected(AccessError::beyond_buffer);
  return {};
}

Rack::Access Rack::read_buffer(std::uint16_t head_address, module::BufferAddress first,
                               std::span<std::uint16_t> words, can::Time now) {
  const auto count = static_cast<std::uint32_t>(words.size());
  if (Access access = check_buffer(head_address, first, count); !access) return access;
  const Slot& slot = *slot_of_point(head_address);
  for (std::uint32_t i = 0; i < count; ++i) words[i] = slot.buffer->program_read(first + i, now);
  slot.buffer->accessed(first, count, now);
  return {};
}

Rack::Access Rack::write_buffer(std::uint16_t head_address, module::BufferAddress first,
                                std::span<const std::uint16_t> words, can::Time now) {
  const auto count = static_cast<std::uint32_t>(words.size());
  if (Access access = check_buffer(head_address, first, count); !access) return access;
  const Slot& slot = *slot_of_point(head_address);
  for (std::uint32_t i = 0; i < count; ++i) slot.buffer->write_word(first + i, words[i], now);
  slot.buffer->accessed(first, count, now);
  return {};
}

Rack::Access Rack::read_double_words(std::uint16_t head_address, module::BufferAddress first,
                                     std::span<std::uint32_t> values, can::Time now) {
  const auto count = static_cast<std::uint32_t>(2 * values.size());
  if (Access access = check_buffer(head_address, first, count); !access) return access;
  const Slot& slot = *slot_of_point(head_address);
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    const std::uint32_t low = slot.buffer->program_read(first + 2 * i, now);
    values[i] = low | std::uint32_t{slot.buffer->program_read(first + 2 * i + 1, now)} << 16U;
  }
  slot.buffer->accessed(first, count, now);
  return {};
}

Rack::Access Rack::write_double_words(std::uint16_t head_address, module::BufferAddress first,
                                      std::span<const std::uint32_t> values, can::Time now) {
  const auto count = static_cast<std::uint32_t>(2 * values.size());
  if (Access access = check_buffer(head_address, first, count); !access) return access;
  const Slot& slot = *slot_of_point(head_address);
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    slot.buffer->write_word(first + 2 * i, static_cast<std::uint16_t>(values[i]), now);
    slot.buffer->write_word(first + 2 * i + 1, static_cast<std::uint16_t>(values[i] >> 16U), now);
  }
  slot.buffer->accessed(first, count, now);
  return {};
}

}  // namespace canopus::plc
