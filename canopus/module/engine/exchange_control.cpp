#include "canopus/module/engine/exchange_control.hpp"

#include <utility>

namespace canopus::module {

ExchangeControl::ExchangeControl(const std::optional<ExchangeControlLayout>& layout, BufferMemory& memory,
                                 const Data& data)
    : layout_(layout), memory_(&memory), data_(data) {
  if (layout) memory.attach(layout->address, layout->address, *this);
}

void ExchangeControl::begin(bool canopen_mode, can::Time now, can::Duration duration) {
  canopen_mode_ = canopen_mode;
  if (layout_ && layout_->at_once) {
    data_.process_data.snapshot();
    waiting_ = true;
    return exchange_if_operational(now);
  }
  end_ = can::later(now, duration);
  if (!canopen_mode) return data_.layer2.snapshot();
  const unsigned bits = layout_ ? memory_->written(layout_->address) : 0U;
  const bool process_data = layout_ && (bits & layout_->process_data) != 0;
  const bool emergencies = layout_ && (bits & layout_->emergencies) != 0;
  const bool input = layout_ && (bits & layout_->inputs) != 0 && data_.lift.active();
  const bool names_none = !process_data && !emergencies && !input;
  emergencies_ = emergencies || names_none;
  if (input) data_.lift.exchange_input();
  if (by_refresh_ || (!process_data && !names_none)) return;
  running_ = true;
  latch_transmit_data();
}

bool ExchangeControl::end_if_due(can::Time now) {
  if (now < end_) return false;
  end_ = can::never;
  if (std::exchange(emergencies_, false)) data_.emergencies.refresh();
  if (!canopen_mode_) data_.layer2.exchange();
  waiting_ = running_;
  const bool may_wait = !layout_ || layout_->waits_for_operational;
  if (!may_wait && data_.node.state() != canopen::NmtState::operational) waiting_ = running_ = false;
  return true;
}

void ExchangeControl::refresh(can::Time now) {
  if (!by_refresh_ || data_.node.state() != canopen::NmtState::operational) return;
  latch_transmit_data();
  exchange_process_data(now);
}

void ExchangeControl::latch_transmit_data() {
  data_.process_data.snapshot();
  if (data_.lift.active()) data_.lift.snapshot();
}

void ExchangeControl::exchange_process_data(can::Time now) {
  waiting_ = running_ = false;
  data_.process_data.exchange(data_.node);
  if (data_.lift.active()) data_.lift.exchange();
  data_.node.values_changed(now);
}

void ExchangeControl::reset() noexcept {
  running_ = waiting_ = emergencies_ = false;
  end_ = can::never;
}

std::uint16_t ExchangeControl::read_word(BufferAddress address, can::Time) const {
  if (layout_->reads_choice) return memory_->word(address);
  if (layout_->at_once) {
    const bool valid = data_.node.state() == canopen::NmtState::operational &&
                       data_.controller.error_state() != can::ErrorState::bus_off;
    return valid ? layout_->exchanging : std::uint16_t{0};
  }
  if (runs_in_layer2()) return layout_->layer2_running;
  return running_ ? layout_->running : std::uint16_t{0};
}

WriteResult ExchangeControl::write_word(BufferAddress address, std::uint16_t value, can::Time) {
  memory_->store(address, value);
  return WriteResult::done;
}

}  // namespace canopus::module
