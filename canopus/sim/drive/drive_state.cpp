#include "canopus/sim/drive/drive_state.hpp"

#include <array>
#include <cstddef>

namespace canopus::sim {

namespace {

enum class Command : std::uint8_t { shutdown, switch_on, enable_operation, disable_voltage, quick_stop };

// Bits 3, 2, 1, 0; a bit that is not tested is a don't-care.
Command command(std::uint16_t word) noexcept {
  if ((word & controlword::enable_voltage) == 0) return Command::disable_voltage;
  if ((word & controlword::quick_stop) == 0) return Command::quick_stop;
  if ((word & controlword::switch_on) == 0) return Command::shutdown;
  return (word & controlword::enable_operation) != 0 ? Command::enable_operation : Command::switch_on;
}

}  // namespace

DriveState next_state(DriveState state, std::uint16_t word, bool fault_reset,
                      bool stays_in_quick_stop) noexcept {
  const Command asked = command(word);
  switch (state) {
    case DriveState::not_ready_to_switch_on: return DriveState::switch_on_disabled;
    case DriveState::switch_on_disabled:
      return asked == Command::shutdown ? DriveState::ready_to_switch_on : state;
    case DriveState::ready_to_switch_on:
    case DriveState::switched_on:
    case DriveState::operation_enabled:
      switch (asked) {
        case Command::disable_voltage: return DriveState::switch_on_disabled;
        case Command::quick_stop:
          return state == DriveState::operation_enabled ? DriveState::quick_stop_active
                                                        : DriveState::switch_on_disabled;
        case Command::shutdown: return DriveState::ready_to_switch_on;
        case Command::switch_on: return DriveState::switched_on;
        case Command::enable_operation: return DriveState::operation_enabled;
      }
      return state;
    case DriveState::quick_stop_active:
      if (asked == Command::disable_voltage) return DriveState::switch_on_disabled;
      return stays_in_quick_stop && asked == Command::enable_operation ? DriveState::operation_enabled
                                                                       : state;
    case DriveState::fault_reaction_active: return state;
    case DriveState::fault: return fault_reset ? DriveState::switch_on_disabled : state;
  }
  return state;
}

std::uint16_t status_bits(DriveState state) noexcept {
  constexpr std::array<std::uint16_t, 8> bits{0x00, 0x40, 0x21, 0x23, 0x27, 0x07, 0x0F, 0x08};
  return bits[static_cast<std::size_t>(state)];
}

}  // namespace canopus::sim
