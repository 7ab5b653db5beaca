#pragma once
// Emergency error codes [CiA 301 7.2.7.1] that the services of a node raise, or that modules have in their
// tables.

#include <cstdint>

namespace canopus::canopen::emcy_code {

inline constexpr std::uint16_t no_error = 0x0000;  ///< an error is over, or all are
inline constexpr std::uint16_t user_software = 0x6200;
inline constexpr std::uint16_t can_overrun = 0x8110;  ///< frames were lost
inline constexpr std::uint16_t error_passive = 0x8120;
inline constexpr std::uint16_t life_guard_or_heartbeat = 0x8130;
inline constexpr std::uint16_t protocol_error = 0x8200;
inline constexpr std::uint16_t pdo_too_short = 0x8210;  ///< not processed
inline constexpr std::uint16_t pdo_too_long = 0x8220;
inline constexpr std::uint16_t mpdo_destination = 0x8230;  ///< the object a destination MPDO names is missing
inline constexpr std::uint16_t sync_length = 0x8240;
inline constexpr std::uint16_t rpdo_time_out = 0x8250;
/// Plus the node-ID of the node that was lost. In no standard: modules have it [ME3CAN1-Q 8.2.1].
inline constexpr std::uint16_t node_lost = 0x8F00;
inline constexpr std::uint16_t device_specific = 0xFF00;

}  // namespace canopus::canopen::emcy_code
