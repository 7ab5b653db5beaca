#pragma once
// The state machine of a drive [CiA 402 part 2; 6040H, 6041H].

#include <cstdint>

namespace canopus::sim {

enum class DriveState : std::uint8_t {
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};

/// Bits of 6040H.
namespace controlword {
inline constexpr std::uint16_t switch_on = 0x0001;
inline constexpr std::uint16_t enable_voltage = 0x0002;
inline constexpr std::uint16_t quick_stop = 0x0004;  ///< active low: 0 requests it
inline constexpr std::uint16_t enable_operation = 0x0008;
inline constexpr std::uint16_t new_set_point = 0x0010;  ///< profile position; homing: start
inline constexpr std::uint16_t change_at_once = 0x0020;
inline constexpr std::uint16_t relative = 0x0040;
inline constexpr std::uint16_t fault_reset = 0x0080;  ///< its rising edge
inline constexpr std::uint16_t halt = 0x0100;
}  // namespace controlword

/// Bits of 6041H.
namespace statusword {
inline constexpr std::uint16_t voltage_enabled = 0x0010;
inline constexpr std::uint16_t warning = 0x0080;
inline constexpr std::uint16_t remote = 0x0200;
inline constexpr std::uint16_t target_reached = 0x0400;
inline constexpr std::uint16_t internal_limit = 0x0800;
inline constexpr std::uint16_t set_point_acknowledge = 0x1000;  ///< speed 0, homing attained
inline constexpr std::uint16_t following_error = 0x2000;        ///< homing error
}  // namespace statusword

/// The next state after a controlword: transitions 2 to 12, 15 and 16. `fault_reset`: bit 7 has risen.
/// `stays_in_quick_stop`: 605AH is 5 to 8, operation can be enabled again (16). Two transitions at once, 3
/// and 4, are one.
[[nodiscard]] DriveState next_state(DriveState state, std::uint16_t controlword, bool fault_reset,
                                    bool stays_in_quick_stop) noexcept;

/// Bits 0 to 3, 5 and 6 of 6041H.
[[nodiscard]] std::uint16_t status_bits(DriveState state) noexcept;

}  // namespace canopus::sim
