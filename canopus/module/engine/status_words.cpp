#include "canopus/module/engine/status_words.hpp"

#include <algorithm>

#include "canopus/module/engine/layer2_mode.hpp"

namespace canopus::module {

namespace {

// [ME3CAN1-Q 3.5.8]
constexpr std::uint16_t passive_counter = 128;
constexpr std::uint16_t bus_off_counter = 256;

}  // namespace

unsigned error_counter(const can::Controller& controller) {
  return std::max<unsigned>(controller.transmit_error_counter(), controller.receive_error_counter());
}

StatusWords::StatusWords(const std::optional<StatusWordsLayout>& layout, BufferMemory& memory,
                         const Sources& sources)
    : layout_(layout.value_or(StatusWordsLayout{})), sources_(sources) {
  for (const auto& address : {layout_.communication_status, layout_.transmit_errors, layout_.receive_errors,
                              layout_.active_bit_rate}) {
    if (address) memory.attach(*address, *address, *this);
  }
}

std::uint16_t StatusWords::read_word(BufferAddress address, can::Time) const {
  if (address == layout_.communication_status) return static_cast<std::uint16_t>(communication_status());
  if (address == layout_.active_bit_rate) {
    const ModuleState& state = sources_.state;
    if (layout_.no_bit_rate_offline && !state.canopen_mode() && !sources_.layer2.online()) return 0;
    return static_cast<std::uint16_t>(sources_.state.bit_rate * layout_.active_bit_rate_per_kbit);
  }
  const can::Controller& controller = sources_.controller;
  if (controller.error_state() == can::ErrorState::bus_off) return bus_off_counter;
  if (address == layout_.transmit_errors) return controller.transmit_error_counter();
  return std::min<std::uint16_t>(controller.receive_error_counter(), passive_counter);
}

WriteResult StatusWords::write_word(BufferAddress address, std::uint16_t value, can::Time) {
  if (address != layout_.communication_status) return WriteResult::ignored;
  if ((value & layout_.bits.nmt_reset_seen) == 0) nmt_reset_seen_ = false;
  if ((value & layout_.bits.time_seen) == 0) time_seen_ = false;
  return WriteResult::done;
}

unsigned StatusWords::communication_status() const {
  const CommunicationStatusBits& bits = layout_.bits;
  const ModuleState& state = sources_.state;
  unsigned status = 0;
  if (state.initializing() || sources_.is_resetting) status |= bits.initialization;
  if (nmt_reset_seen_) status |= bits.nmt_reset_seen;
  if (time_seen_) status |= bits.time_seen;
  if (!state.running()) return status;
  if (error_counter(sources_.controller) >= warning_counter &&
      sources_.controller.error_state() == can::ErrorState::error_active) {
    status |= bits.warning_level;
  }
  if (!state.canopen_mode()) {
    if (sources_.layer2.online()) status |= bits.layer2_online;
    return status;
  }
  if (!sources_.is_resetting) status |= bits.online;
  switch (sources_.node.state()) {
    case canopen::NmtState::operational: status |= bits.operational | bits.operational_state; break;
    case canopen::NmtState::pre_operational: status |= bits.pre_operational_state; break;
    case canopen::NmtState::stopped:
    case canopen::NmtState::initialising: break;
  }
  const manager::NmtMaster& master = sources_.master;
  if (master.lss_active()) status |= bits.lss_active;
  if (master.halted()) status |= bits.start_up_failed;
  if (layout_.bits.optional_slave_failed != 0 && master.optional_slave_failed())
    status |= bits.optional_slave_failed;
  if (master.starting()) status |= bits.slave_start_up;
  if (master.active()) status |= bits.nmt_master;
  return status;
}

}  // namespace canopus::module
