#pragma once
// NMT states and commands [CiA 301 7.2.8, 7.3.2], and the identifiers of the pre-defined connection set
// [7.3.3].

#include <cstdint>
#include <string_view>

namespace canopus::canopen {

/// NMT state as heartbeat, guarding and 1F82H carry it; initialising is the boot-up message's 00H.
enum class NmtState : std::uint8_t {
  initialising = 0x00,
  stopped = 0x04,
  operational = 0x05,
  pre_operational = 0x7F,
};

/// Command byte of the NMT frame 000H [command, node-ID].
enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};

/// "pre-operational", "operational", ... ; "unknown" for other values.
[[nodiscard]] constexpr std::string_view name(NmtState state) noexcept {
  switch (state) {
    case NmtState::initialising: return "initialising";
    case NmtState::stopped: return "stopped";
    case NmtState::operational: return "operational";
    case NmtState::pre_operational: return "pre-operational";
  }
  return "unknown";
}

namespace cob_id {
inline constexpr std::uint32_t nmt = 0x000;
inline constexpr std::uint32_t sync = 0x080;
inline constexpr std::uint32_t emcy = 0x080;  ///< + node-ID
inline constexpr std::uint32_t time = 0x100;
inline constexpr std::uint32_t sdo_response = 0x580;   ///< server to client, + node-ID
inline constexpr std::uint32_t sdo_request = 0x600;    ///< client to server, + node-ID
inline constexpr std::uint32_t error_control = 0x700;  ///< boot-up, heartbeat, guarding, + node-ID
/// Of a base identifier: which service, without the node-ID.
inline constexpr std::uint32_t function_code = 0x780;
}  // namespace cob_id

}  // namespace canopus::canopen
