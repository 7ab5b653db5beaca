#include "canopus/module/layer2/layer2.hpp"

#include <algorithm>
#include <utility>

namespace canopus::module {

namespace {

constexpr BufferAddress words_per_slot = 7;
constexpr BufferAddress parameters_per_slot = 4;
constexpr BufferAddress flag_words = (layer2_slots + 15) / 16;

}  // namespace

Layer2::Layer2(const std::optional<Layer2Layout>& layout, const Layer2Rules& rules, BufferMemory& memory,
               can::Controller& controller)
    : layout_(layout),
      rules_(rules),
      memory_(&memory),
      controller_(&controller),
      settings_(layout.value_or(Layer2Layout{}), rules, memory) {
  if (!layout) return;
  memory.attach(layout->parameters, layout->parameters + parameters_per_slot * layer2_slots - 1, *this);
  memory.attach(layout->process_data, layout->process_data + words_per_slot * layer2_slots - 1, *this);
  memory.attach(layout->stop_messages, layout->stop_messages + words_per_slot * layer2_stop_messages - 1,
                *this);
}

void Layer2::start(bool extended) {
  settings_.select(extended);
  online_ = false;
  memory_->set_online(false);
  transmit_.fill({});
  receive_.fill({});
  next_cycle_ = can::never;
  receive_busy_until_ = {};
  snapshot_taken_ = trigger_requested_ = trigger_done_ = false;
  stop_message_ = layer2_stop_messages;
  stop_frame_.reset();
}

std::optional<BufferAddress> Layer2::go_online(can::Time now) {
  if (online_) return std::nullopt;
  std::optional<BufferAddress> wrong = settings_.first_error();
  if (wrong && rules_.errors_keep_offline) return wrong;
  const auto forced = settings_.settle();
  if (!wrong && rules_.rtr_limit_is_error) wrong = forced;
  transmit_.fill({});
  receive_.fill({});
  for (unsigned slot = 0; slot < layer2_slots; ++slot) load(slot);
  for (unsigned message = 0; message < layer2_stop_messages; ++message) {
    stop_messages_[message].reset();
    if (settings_.stop_message_enabled(message) && !settings_.stop_message_error(message))
      stop_messages_[message] = settings_.stop_message(message);
  }
  for (TransmitSlot& slot : transmit_) {
    if (slot.active && slot.cycle != can::Duration{}) slot.due = can::later(now, slot.cycle);
  }
  plan_cycles();
  snapshot_taken_ = false;
  online_ = true;
  memory_->set_online(true);
  for (unsigned slot = 0; rules_.sends_when_online && slot < layer2_slots; ++slot) {
    if (transmit_[slot].active) transmit(slot);
  }
  send_triggered();
  return wrong;
}

void Layer2::load(unsigned slot) {
  if (settings_.slot_error(slot)) return;
  switch (settings_.kind(slot)) {
    case SlotKind::disabled: return;
    case SlotKind::receive:
      receive_[slot].active = true;
      receive_[slot].identifier = settings_.identifier(slot);
      receive_[slot].mask = settings_.mask(slot);
      for (BufferAddress word = 0; rules_.clears_receive_words && word < words_per_slot; ++word) {
        memory_->set_word(settings_.block(slot) + word, 0);
      }
      return;
    case SlotKind::transmit: break;
  }
  TransmitSlot& own = transmit_[slot];
  own.active = true;
  own.transmission = settings_.transmission(slot);
  own.response = settings_.response(slot);
  own.strict_dlc = settings_.strict_dlc(slot);
  const bool cyclic =
      own.transmission == Layer2Transmission::cycle || own.transmission == Layer2Transmission::cycle_changed;
  if (cyclic) own.cycle = settings_.cycle(slot);
  own.next = own.outgoing = own.last = settings_.frame(slot);
}

void Layer2::go_offline() {
  if (!online_) return;
  online_ = false;
  memory_->set_online(false);
  next_cycle_ = can::never;
  if (!stop_frame_) controller_->abort_transmissions();
}

void Layer2::snapshot() {
  snapshot_taken_ = online_;
  if (!online_) return;
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    TransmitSlot& own = transmit_[slot];
    own.next = settings_.frame(slot);
    own.next.identifier = own.outgoing.identifier;  // as it was on going online, whatever restores its words
    own.next_strict_dlc = settings_.strict_dlc(slot);
  }
}

void Layer2::exchange() {
  if (!online_ || !std::exchange(snapshot_taken_, false)) return;
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    TransmitSlot& own = transmit_[slot];
    if (receive_[slot].active) show(slot);
    if (!own.active) continue;
    own.outgoing = own.next;
    own.strict_dlc = own.next_strict_dlc;
    const bool cyclic = rules_.exchange_sends_cyclic;
    const bool sends = own.transmission == Layer2Transmission::exchange ||
                       (cyclic && own.transmission == Layer2Transmission::cycle);
    const bool sends_changes = own.transmission == Layer2Transmission::exchange_changed ||
                               (cyclic && own.transmission == Layer2Transmission::cycle_changed);
    if (sends || (sends_changes && own.outgoing != own.last)) transmit(slot);
  }
}

// A message that finds no room in the controller is not sent: for types 1 and 3 it stays a changed one.
bool Layer2::transmit(unsigned slot) {
  TransmitSlot& own = transmit_[slot];
  if (!controller_->send(own.outgoing)) return false;
  own.last = own.outgoing;
  set_flag(layout_->rtr_flags, slot, false);
  return true;
}

void Layer2::tick(can::Time now) {
  if (now < next_cycle_) return;
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    TransmitSlot& own = transmit_[slot];
    if (now < own.due) continue;
    own.due = can::later(own.due, own.cycle);
    if (own.transmission == Layer2Transmission::cycle || own.outgoing != own.last) transmit(slot);
  }
  plan_cycles();
}

void Layer2::plan_cycles() noexcept { next_cycle_ = std::ranges::min(transmit_, {}, &TransmitSlot::due).due; }

void Layer2::request_trigger(bool on) {
  trigger_requested_ = on;
  trigger_done_ = false;
  send_triggered();
}

void Layer2::send_triggered() {
  if (!online_ || !trigger_requested_ || trigger_done_) return;
  for (unsigned slot = 0; slot < flag_words * 16; ++slot) {
    if (!flag(layout_->trigger_flags, slot)) continue;
    // Requests on other slots are discarded.
    if (slot < layer2_slots && transmit_[slot].active && (!controller_->has_room() || !transmit(slot)))
      return;
    set_flag(layout_->trigger_flags, slot, false);
  }
  trigger_done_ = true;
}

void Layer2::cpu_stopped() {
  if (!online_) return;
  stop_message_ = 0;
  send_stop_message();
}

// One after another, so that their identifiers do not change their order.
void Layer2::send_stop_message() {
  stop_frame_.reset();
  while (stop_message_ < layer2_stop_messages) {
    const std::optional<can::Frame>& frame = stop_messages_[stop_message_++];
    if (!frame) continue;
    if (controller_->send(*frame)) stop_frame_ = frame;
    return;
  }
}

std::optional<can::Frame> plain_frame(std::span<const std::uint16_t> parameters,
                                      std::span<std::uint16_t> faults, bool extended) {
  enum Parameter : std::size_t { id_low, id_high, rtr, dlc, data };
  const std::uint32_t highest = extended ? can::max_extended_identifier : can::max_base_identifier;
  if (parameters[id_low] > (highest & 0xFFFF)) faults[id_low] = parameters[id_low];
  if (parameters[id_high] > highest >> 16) faults[id_high] = parameters[id_high];
  if (parameters[rtr] > 1) faults[rtr] = parameters[rtr];
  if (parameters[dlc] > 8) faults[dlc] = parameters[dlc];
  const auto checked = faults.first(plain_frame_parameters);
  if (std::ranges::any_of(checked, [](std::uint16_t fault) { return fault != 0; })) return std::nullopt;
  can::Frame frame{.identifier = parameters[id_low] | static_cast<std::uint32_t>(parameters[id_high]) << 16,
                   .extended = extended,
                   .remote = parameters[rtr] == 1,
                   .dlc = static_cast<std::uint8_t>(parameters[dlc])};
  for (std::size_t i = 0; i < frame.length(); ++i) {
    frame.data[i] = static_cast<std::uint8_t>(parameters[data + i / 2] >> (i % 2 * 8) & 0xFF);
  }
  return frame;
}

PlainFrameResult Layer2::send(std::span<const std::uint16_t> parameters, std::span<std::uint16_t> faults) {
  const auto frame = plain_frame(parameters, faults, settings_.extended());
  if (!frame) return PlainFrameResult::setting_error;
  command_frame_ = *frame;
  return controller_->send(*frame) ? PlainFrameResult::queued : PlainFrameResult::no_room;
}

void Layer2::receive(const can::Frame& frame, can::Time now) {
  if (!online_ || frame.extended != settings_.extended()) return;
  if (frame.remote) return answer(frame);
  bool counted = false;
  bool lost = false;
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    ReceiveSlot& own = receive_[slot];
    if (!own.active || ((frame.identifier ^ own.identifier) & ~own.mask) != 0) continue;
    if (!std::exchange(counted, true)) lost = !receive_message(now);
    if (lost) {
      memory_->set_word(layout_->error_codes + slot, slot_error::receive_overflow);
    } else {
      store(own, frame);
    }
  }
}

bool Layer2::receive_message(can::Time now) {
  const can::Time begin = std::max(now, receive_busy_until_);
  if (begin - now > rules_.message_time * (rules_.waiting_messages - 1)) return false;
  receive_busy_until_ = begin + rules_.message_time;
  return true;
}

void Layer2::store(ReceiveSlot& slot, const can::Frame& frame) {
  const std::uint16_t unread = rules_.overflow_is_of_new_data ? frame_word::new_data : frame_word::flags;
  if ((slot.flags & unread) != 0) slot.flags |= frame_word::overflow;
  slot.flags |= frame_word::new_frame;
  if (!slot.any || frame != slot.stored) slot.flags |= frame_word::new_data;
  slot.any = true;
  slot.stored = frame;
}

// Flags that the program has not cleared stay, and mean that it has not seen the message before this one.
void Layer2::show(unsigned slot) {
  ReceiveSlot& own = receive_[slot];
  if (own.flags == 0) return;
  const BufferAddress block = settings_.block(slot);
  const auto unread = static_cast<std::uint16_t>(memory_->word(block + 2) & frame_word::flags);
  const std::uint16_t lost = rules_.overflow_is_of_new_data ? frame_word::new_data : frame_word::flags;
  if ((unread & lost) != 0) own.flags |= frame_word::overflow;
  memory_->set_word(block, static_cast<std::uint16_t>(own.stored.identifier & 0xFFFF));
  memory_->set_word(block + 1, static_cast<std::uint16_t>(own.stored.identifier >> 16));
  memory_->set_word(block + 2, static_cast<std::uint16_t>(unread | own.flags | own.stored.length()));
  memory_->set_words(block + 3, own.stored.data);
  own.flags = 0;
}

void Layer2::answer(const can::Frame& request) {
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    const TransmitSlot& own = transmit_[slot];
    if (!own.active || own.outgoing.identifier != request.identifier) continue;
    if (own.strict_dlc && own.outgoing.dlc != request.dlc) continue;
    if (own.response == RtrResponse::automatic) transmit(slot);
    if (own.response == RtrResponse::manual) set_flag(layout_->rtr_flags, slot, true);
  }
}

void Layer2::transmitted(const can::Frame& frame) {
  if (stop_frame_ && *stop_frame_ == frame) send_stop_message();
  send_triggered();
}

unsigned Layer2::first_slot_error() const noexcept {
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    if (memory_->word(layout_->error_codes + slot) != 0) return slot + 1;
  }
  return 0;
}

bool Layer2::any_slot_error() const noexcept {
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    if (memory_->word(layout_->error_codes + slot) != 0) return true;
  }
  return false;
}

WriteResult Layer2::write_word(BufferAddress address, std::uint16_t value, can::Time) {
  WriteResult result = WriteResult::done;
  if (address >= layout_->process_data && address < layout_->process_data + words_per_slot * layer2_slots) {
    return write_block(address, value);
  }
  if (address >= layout_->stop_messages &&
      address < layout_->stop_messages + words_per_slot * layer2_stop_messages) {
    const BufferAddress word = (address - layout_->stop_messages) % words_per_slot;
    if (word < 2) result = settings_.check_identifier_word(value, word == 1);
  } else {
    result = settings_.check_parameter(address, value);
  }
  if (result == WriteResult::done) memory_->set_word(address, value);
  return result;
}

WriteResult Layer2::write_block(BufferAddress address, std::uint16_t value) {
  const unsigned slot = (address - layout_->process_data) / words_per_slot;
  const BufferAddress word = (address - layout_->process_data) % words_per_slot;
  const bool receives = settings_.kind(slot) == SlotKind::receive;
  if (word < 2) {
    const WriteResult result = settings_.check_identifier_word(value, word == 1);
    if (result != WriteResult::done) return result;
  } else if (word == 2 && receives) {
    // The program may take the flags away; the rest is the module's.
    value = static_cast<std::uint16_t>(memory_->word(address) & (value | ~frame_word::flags));
  } else if (word == 2) {
    if (online_ && rules_.frame_word_is_configuration && value != memory_->word(address))
      return WriteResult::refused;
    if (!settings_.good_frame_word(slot, value)) return WriteResult::invalid;
    value &= frame_word::dlc | frame_word::strict_dlc | frame_word::remote;
  } else if (receives) {
    return WriteResult::ignored;
  }
  memory_->set_word(address, value);
  return WriteResult::done;
}

bool Layer2::flag(BufferAddress first, unsigned slot) const noexcept {
  return (memory_->word(first + slot / 16) >> (slot % 16) & 1U) != 0;
}

void Layer2::set_flag(BufferAddress first, unsigned slot, bool on) {
  const std::uint16_t bit = static_cast<std::uint16_t>(1U << (slot % 16));
  const std::uint16_t word = memory_->word(first + slot / 16);
  memory_->set_word(first + slot / 16, static_cast<std::uint16_t>(on ? word | bit : word & ~bit));
}

}  // namespace canopus::module
