#pragma once
// Status of the CAN controller behind a transport.

#include <cstdint>

#include "canopus/can/controller.hpp"

namespace canopus::link {

/// The known state of the controller behind a bus client.
struct ControllerStatus {
  can::ErrorState state = can::ErrorState::error_active;
  std::uint16_t transmit_errors = 0;  ///< TEC
  std::uint16_t receive_errors = 0;   ///< REC
  std::uint32_t bit_rate = 0;         ///< bit/s, 0: not known
  std::uint16_t sample_point = 0;     ///< per mille of a bit, 0: not known
  bool counters_known = false;        ///< false: the transport does not supply TEC and REC

  friend bool operator==(const ControllerStatus&, const ControllerStatus&) = default;
};

}  // namespace canopus::link
