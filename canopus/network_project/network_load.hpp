#pragma once
// The bus load of a project's network, computed from its DCFs: process data, SYNC, heartbeats. SDO, EMCY, NMT
// and guarding come on top.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/network_project/network_project.hpp"

namespace canopus::network_project {

/// Frames that a node sends again and again.
struct CyclicFrame {
  std::uint8_t node_id = 0;
  std::string what;  ///< "TPDO1", "SYNC", "heartbeat"
  canopen::CobId cob_id{};
  unsigned length = 0;  ///< bytes
  double steady = 0;    ///< frames a second by timers and SYNC alone
  std::optional<double>
      most;  ///< and with events; nothing: as many as the bus takes (event-driven, no inhibit time)
};

struct NetworkLoad {
  std::uint32_t bit_rate = 0;  ///< bit/s; 0: not known, and so are the loads
  std::vector<CyclicFrame> frames;
  double steady = 0;       ///< share of the bus, 1 = full, each frame with the most stuff bits
  double most = 0;         ///< without those that nothing limits
  unsigned unlimited = 0;  ///< TPDOs that nothing limits
};

[[nodiscard]] NetworkLoad reckon_load(const NetworkProject& project);

/// Bits of a frame with the most stuff bits there can be, and the intermission behind it [ISO 11898-1].
[[nodiscard]] unsigned longest_frame_bits(unsigned length, bool is_extended) noexcept;

}  // namespace canopus::network_project
