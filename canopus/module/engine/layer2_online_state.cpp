#include "canopus/module/engine/layer2_online_state.hpp"

#include <chrono>

namespace canopus::module {

namespace {

// With a 29-bit identifier, 8 bytes and every stuff bit, and the space after it.
constexpr unsigned longest_frame_bits = 163;

}  // namespace

void Layer2OnlineState::initialized() {
  off_wire_at_ = can::never;
  wire_left_ = true;
  parts_.controller.set_power(parts_.state.canopen_mode() || !parts_.layer2.rules().offline_is_silent);
}

// Settings that make no sense keep the module offline.
void Layer2OnlineState::go_online(can::Time now) {
  join(now);
  if (const auto bad = bad_setting()) {
    return parts_.report_word(*bad, parts_.buffer.word(*bad),
                              " is not what was written last, a value out of range: the module stays offline",
                              now);
  }
  const auto wrong = parts_.layer2.go_online(now);
  if (!wrong) return parts_.errors.found_good(WordGroup::layer2);
  if (parts_.layer2.online()) {
    parts_.errors.record(WriteResult::invalid, *wrong);
  } else {
    parts_.errors.found_wrong(WordGroup::layer2, *wrong);
  }
  parts_.diagnostics.raise(Diagnosis::invalid_value, now, {*wrong});
  parts_.report_word(*wrong, parts_.buffer.word(*wrong),
                     " does not go with the other Layer 2 settings: the module stays offline", now);
}

// The function mode is no setting of Y3 [RJ71CN91 App. 1 Y3].
std::optional<BufferAddress> Layer2OnlineState::bad_setting() const {
  if (!parts_.layer2.rules().bad_words_keep_offline) return std::nullopt;
  for (const BufferAddress address : parts_.errors.bad_words()) {
    const BufferRow* row = parts_.buffer.row(address, WordAccess::write);
    const bool is_setting = row != nullptr && row->stored == Stored::yes;
    if (is_setting && address != parts_.model.settings.function_mode) return address;
  }
  return std::nullopt;
}

void Layer2OnlineState::go_offline(can::Time now) {
  if (parts_.layer2.online()) off_wire_at_ = can::never;
  parts_.layer2.go_offline();
  leave_when_silent(now);
}

// [RJ71CN91 App. 1 Y3, App. 2 G24] The bit rate is what its word says now; bus-off is left.
void Layer2OnlineState::join(can::Time now) {
  if (parts_.layer2.online()) return;
  off_wire_at_ = can::never;
  const Layer2Rules& rules = parts_.layer2.rules();
  if (rules.online_applies_bit_rate) {
    const std::uint16_t bit_rate = parts_.settings.bit_rate();
    if (bit_rate != parts_.state.bit_rate || parts_.controller.error_state() == can::ErrorState::bus_off) {
      parts_.state.bit_rate = bit_rate;
      controller_.restart(bit_rate * 1000U);
    }
  }
  if (rules.offline_is_silent) parts_.controller.set_power(true);
  wire_left_ = false;
  controller_.changed(now);
}

void Layer2OnlineState::leave_when_silent(can::Time now) {
  if (!parts_.layer2.rules().offline_is_silent) return;
  if (parts_.controller.error_state() == can::ErrorState::bus_off) parts_.layer2.drop_stop_messages();
  if (parts_.layer2.uses_bus()) {
    off_wire_at_ = can::never;
    wire_left_ = false;
    return;
  }
  if (wire_left_) return;
  if (off_wire_at_ == can::never) {
    const auto longest_frame = std::chrono::microseconds(longest_frame_bits * 1000 / parts_.state.bit_rate);
    off_wire_at_ = can::later(now, longest_frame);
  } else if (now >= off_wire_at_) {
    off_wire_at_ = can::never;
    wire_left_ = true;
    parts_.controller.set_power(false);
  }
}

}  // namespace canopus::module
