#include "canopus/module/engine/layer2_mode.hpp"

#include <chrono>

namespace canopus::module {

namespace {

// With a 29-bit identifier, 8 bytes and every stuff bit, and the space after it.
constexpr unsigned longest_frame_bits = 163;

Layer2Rules rules_of(const ModuleContext& context) {
  Layer2Rules rules = context.model.layer2_rules;
  rules.cycle_unit = context.profile.layer2_cycle_unit;
  rules.message_time = context.profile.layer2_message_time;
  rules.waiting_messages = context.profile.layer2_waiting_messages;
  return rules;
}

}  // namespace

Layer2Mode::Layer2Mode(ModuleContext& context, can::Controller& controller, ControllerMonitor& monitor)
    : context_(context),
      monitor_(monitor),
      layer2_(context.model.layer2, rules_of(context), context.buffer, controller) {
  alarm_.add_part(off_wire_at_);
  alarm_.add_part(layer2_.alarm());
}

void Layer2Mode::initialized() {
  off_wire_at_ = can::never;
  wire_left_ = true;
  monitor_.set_power(context_.state.canopen_mode() || !layer2_.rules().offline_is_silent);
}

// Settings that make no sense keep the module offline.
void Layer2Mode::go_online(can::Time now) {
  join(now);
  if (const auto bad = bad_setting()) {
    return context_.report_word(
        *bad, context_.buffer.word(*bad),
        " is not what was written last, a value out of range: the module stays offline", now);
  }
  const auto wrong = layer2_.go_online(now);
  if (!wrong) return context_.errors.found_good(WordGroup::layer2);
  if (layer2_.online()) {
    context_.errors.record(WriteResult::invalid, *wrong);
  } else {
    context_.errors.found_wrong(WordGroup::layer2, *wrong);
  }
  context_.diagnostics.raise(Diagnosis::invalid_value, now, {*wrong});
  context_.report_word(*wrong, context_.buffer.word(*wrong),
                       " does not go with the other Layer 2 settings: the module stays offline", now);
}

// The function mode is no setting of Y3 [RJ71CN91 App. 1 Y3].
std::optional<BufferAddress> Layer2Mode::bad_setting() const {
  if (!layer2_.rules().bad_words_keep_offline) return std::nullopt;
  for (const BufferAddress address : context_.errors.bad_words()) {
    const BufferRow* row = context_.buffer.row(address, WordAccess::write);
    const bool is_setting = row != nullptr && row->stored == Stored::yes;
    if (is_setting && address != context_.model.settings.function_mode) return address;
  }
  return std::nullopt;
}

void Layer2Mode::go_offline(can::Time now) {
  if (layer2_.online()) off_wire_at_ = can::never;
  layer2_.go_offline();
  leave_when_silent(now);
}

void Layer2Mode::join(can::Time now) {
  if (layer2_.online()) return;
  off_wire_at_ = can::never;
  if (layer2_.rules().offline_is_silent) monitor_.set_power(true);
  wire_left_ = false;
  monitor_.changed(now);
}

void Layer2Mode::leave_when_silent(can::Time now) {
  if (!layer2_.rules().offline_is_silent) return;
  if (context_.controller.error_state() == can::ErrorState::bus_off) layer2_.drop_stop_messages();
  if (layer2_.uses_bus()) {
    off_wire_at_ = can::never;
    wire_left_ = false;
    return;
  }
  if (wire_left_) return;
  if (off_wire_at_ == can::never) {
    const auto longest_frame = std::chrono::microseconds(longest_frame_bits * 1000 / context_.state.bit_rate);
    off_wire_at_ = can::later(now, longest_frame);
  } else if (now >= off_wire_at_) {
    off_wire_at_ = can::never;
    wire_left_ = true;
    monitor_.set_power(false);
  }
}

}  // namespace canopus::module
