#include "canopus/module/layer2/layer2_settings.hpp"

#include <algorithm>

namespace canopus::module {

namespace {

constexpr std::uint16_t unused = 0xFFFF;
constexpr std::uint32_t unused_pair = 0xFFFF'FFFF;
constexpr std::uint16_t highest_transmission = 4;
constexpr unsigned parameter_count = 4;

constexpr bool is_response(std::uint16_t value) {
  return value == static_cast<std::uint16_t>(RtrResponse::automatic) ||
         value == static_cast<std::uint16_t>(RtrResponse::manual) ||
         value == static_cast<std::uint16_t>(RtrResponse::none);
}

/// With every stuff bit, and the space after it [ISO 11898-1].
constexpr unsigned longest_bits(const can::Frame& frame) {
  const auto data = static_cast<unsigned>(8 * frame.length());
  return frame.extended ? 67 + data + (53 + data) / 4 : 47 + data + (33 + data) / 4;
}

constexpr bool is_cyclic(Layer2Transmission type) {
  return type == Layer2Transmission::cycle || type == Layer2Transmission::cycle_changed;
}

}  // namespace

SlotKind Layer2Settings::kind(unsigned slot) const noexcept {
  const std::uint16_t b = word(parameters(slot) + 1);
  if (word(parameters(slot)) != unused) return SlotKind::receive;
  if (b == unused) return SlotKind::disabled;
  return is_response(b) ? SlotKind::transmit : SlotKind::receive;
}

bool Layer2Settings::strict_dlc(unsigned slot) const noexcept {
  return (word(block(slot) + 2) & frame_word::strict_dlc) != 0;
}

std::uint32_t Layer2Settings::block_identifier(BufferAddress block) const noexcept {
  return !extended_ && rules_.base_high_word_ignored ? word(block) : pair(block);
}

can::Frame Layer2Settings::frame_at(BufferAddress block, bool remote) const noexcept {
  can::Frame frame{.identifier = block_identifier(block), .extended = extended_, .remote = remote};
  frame.dlc = static_cast<std::uint8_t>(word(block + 2) & frame_word::dlc);
  for (std::size_t i = 0; i < frame.length(); ++i) {
    frame.data[i] =
        static_cast<std::uint8_t>(word(block + 3 + static_cast<BufferAddress>(i / 2)) >> (i % 2 * 8) & 0xFF);
  }
  return frame;
}

can::Frame Layer2Settings::frame(unsigned slot) const noexcept {
  return frame_at(block(slot), (word(block(slot) + 2) & frame_word::remote) != 0);
}

bool Layer2Settings::stop_message_enabled(unsigned message) const noexcept {
  return pair(stop_block(message)) != unused_pair;
}

can::Frame Layer2Settings::stop_message(unsigned message) const noexcept {
  return frame_at(stop_block(message), false);
}

WriteResult Layer2Settings::check_parameter(BufferAddress address, std::uint16_t value) const noexcept {
  const unsigned slot = (address - layout_.parameters) / parameter_count;
  bool good = true;
  switch ((address - layout_.parameters) % parameter_count) {
    case 0: good = extended_ || value == unused || value <= can::max_base_identifier; break;
    case 1:
      good = value == unused || is_response(value) ||
             value <= (extended_ ? can::max_extended_identifier >> 16 : 0);
      break;
    case 2: good = kind(slot) != SlotKind::transmit || value <= highest_transmission; break;
    default: break;
  }
  return good ? WriteResult::done : WriteResult::invalid;
}

WriteResult Layer2Settings::check_identifier_word(std::uint16_t value, bool high) const noexcept {
  if (value == unused || (high && !extended_ && rules_.base_high_word_ignored)) return WriteResult::done;
  const std::uint32_t highest = extended_ ? can::max_extended_identifier : can::max_base_identifier;
  return value <= (high ? highest >> 16 : highest & 0xFFFF) ? WriteResult::done : WriteResult::invalid;
}

bool Layer2Settings::good_frame_word(unsigned slot, std::uint16_t value) const noexcept {
  if ((value & frame_word::dlc) > 8) return false;
  if (kind(slot) != SlotKind::transmit) return true;
  const bool answers = response(slot) != RtrResponse::none;
  if ((value & frame_word::remote) != 0 && answers) return false;
  return (value & frame_word::strict_dlc) == 0 || answers;
}

std::optional<BufferAddress> Layer2Settings::identifier_error(BufferAddress low,
                                                              std::uint32_t identifier) const noexcept {
  const std::uint32_t highest = extended_ ? can::max_extended_identifier : can::max_base_identifier;
  if (identifier <= highest) return std::nullopt;
  if (identifier == unused_pair) return low;
  return (identifier >> 16) > (highest >> 16) ? low + 1 : low;
}

std::optional<BufferAddress> Layer2Settings::slot_error(unsigned slot) const noexcept {
  switch (kind(slot)) {
    case SlotKind::disabled: return std::nullopt;
    case SlotKind::receive: return identifier_error(parameters(slot), identifier(slot));
    case SlotKind::transmit: break;
  }
  if (word(parameters(slot) + 2) > highest_transmission) return parameters(slot) + 2;
  const std::uint32_t own = block_identifier(block(slot));
  if (const auto wrong = identifier_error(block(slot), own)) return wrong;
  const std::uint16_t form = word(block(slot) + 2);
  if (!good_frame_word(slot, form)) return block(slot) + 2;
  if (rules_.remote_frames_have_no_changes && (form & frame_word::remote) != 0 &&
      (transmission(slot) == Layer2Transmission::exchange_changed ||
       transmission(slot) == Layer2Transmission::cycle_changed)) {
    return parameters(slot) + 2;
  }
  for (unsigned other = 0; rules_.unique_transmit_identifiers && other < slot; ++other) {
    if (kind(other) == SlotKind::transmit && block_identifier(block(other)) == own) return block(slot);
  }
  return std::nullopt;
}

std::optional<BufferAddress> Layer2Settings::stop_message_error(unsigned message) const noexcept {
  if (!stop_message_enabled(message)) return std::nullopt;
  return identifier_error(stop_block(message), block_identifier(stop_block(message)));
}

std::optional<BufferAddress> Layer2Settings::first_error() const noexcept {
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    if (const auto wrong = slot_error(slot)) return wrong;
  }
  for (unsigned message = 0; message < layer2_stop_messages; ++message) {
    if (const auto wrong = stop_message_error(message)) return wrong;
  }
  return cycle_error();
}

std::optional<BufferAddress> Layer2Settings::cycle_error() const noexcept {
  if (!rules_.rate_of_cycles) return std::nullopt;
  constexpr std::int64_t whole = 1'000'000;
  std::int64_t share = 0;  // of the bus, in millionths
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    if (kind(slot) != SlotKind::transmit || !is_cyclic(transmission(slot))) continue;
    const can::Duration time =
        std::chrono::nanoseconds(whole * longest_bits(frame(slot)) / word(*rules_.rate_of_cycles));
    const can::Duration period = std::max(cycle(slot), rules_.cycle_unit);
    share += whole * time.count() / period.count();
    if (share > whole) return parameters(slot) + 3;
  }
  return std::nullopt;
}

std::optional<BufferAddress> Layer2Settings::settle() noexcept {
  std::optional<BufferAddress> first_forced;
  unsigned answering = 0;
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    if (kind(slot) != SlotKind::transmit) continue;
    if (!rules_.cycle_of_zero && is_cyclic(transmission(slot)) && word(parameters(slot) + 3) == 0)
      memory_->set_word(parameters(slot) + 3, 1);
    if (response(slot) == RtrResponse::none || ++answering <= layer2_rtr_slots) continue;
    memory_->set_word(parameters(slot) + 1, static_cast<std::uint16_t>(RtrResponse::none));
    // Without an answer there is nothing to check a DLC for.
    memory_->set_word(block(slot) + 2,
                      static_cast<std::uint16_t>(word(block(slot) + 2) & ~frame_word::strict_dlc));
    if (!first_forced) first_forced = parameters(slot) + 1;
  }
  return first_forced;
}

}  // namespace canopus::module
