#pragma once
// Bits of 1F80H and 1F81H [CiA 302-2; ME3CAN1-Q 4.8.5, 4.8.6], for the master, for what checks the
// objects, and for what writes them.

#include <chrono>
#include <cstdint>

#include "canopus/can/time.hpp"

namespace canopus::manager {

/// 1F80H: what this node is, and how the network starts.
namespace start_up_bit {
inline constexpr std::uint32_t nmt_master = 0x01;
inline constexpr std::uint32_t start_all_nodes = 0x02;       ///< by one command, not node by node
inline constexpr std::uint32_t wait_for_application = 0x04;  ///< not Operational by itself
inline constexpr std::uint32_t do_not_start_slaves = 0x08;
inline constexpr std::uint32_t reset_all_nodes = 0x10;  ///< when a mandatory slave is lost
inline constexpr std::uint32_t flying_master = 0x20;
inline constexpr std::uint32_t stop_all_nodes = 0x40;  ///< when a mandatory slave is lost; counts before 10H
inline constexpr std::uint32_t all = 0x7F;
}  // namespace start_up_bit

/// 1F81H, low byte: what the master does with a node.
namespace assignment_bit {
inline constexpr std::uint32_t slave = 0x01;       ///< the node is a slave of this master
inline constexpr std::uint32_t boot_slave = 0x04;  ///< it is booted; else there is error control alone
inline constexpr std::uint32_t mandatory = 0x08;
inline constexpr std::uint32_t keep_alive = 0x10;  ///< not reset while it is Operational
inline constexpr std::uint32_t check_software = 0x20;
inline constexpr std::uint32_t update_software = 0x40;
inline constexpr std::uint32_t restore = 0x80;  ///< before it is configured, as 1F8AH says
inline constexpr std::uint32_t all = 0xFD;      ///< bit 1 is reserved
}  // namespace assignment_bit

/// 1F81H, the other bytes: guarding. None unless both are more than 0.
[[nodiscard]] constexpr unsigned retry_factor(std::uint32_t assignment) noexcept {
  return assignment >> 8 & 0xFF;
}
[[nodiscard]] constexpr can::Duration guard_time(std::uint32_t assignment) noexcept {
  return std::chrono::milliseconds(assignment >> 16);
}
/// The same the other way. `guard_time` in ms, 0..65535.
[[nodiscard]] constexpr std::uint32_t guarding_bits(std::uint32_t guard_time,
                                                    unsigned retry_factor) noexcept {
  return guard_time << 16 | (retry_factor & 0xFF) << 8;
}

}  // namespace canopus::manager
