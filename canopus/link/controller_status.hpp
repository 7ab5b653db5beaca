#pragma once
// Status of the CAN controller behind a transport.

#include <cstdint>
#include <span>
#include <string_view>

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

// Texts for the errors of a CAN interface's controller. SocketCAN reports them by error frames; socketcand
// forwards their class.

/// No acknowledge for transmitted frames: class of Linux's error frames (CAN_ERR_ACK).
inline constexpr std::uint32_t error_class_acknowledgement = 0x20;

/// The sentence for an error frame of this class with these bytes (none: only the class is known); empty for
/// error frames that need no report [Linux include/uapi/linux/can/error.h].
[[nodiscard]] std::string_view describe_error_frame(std::uint32_t error_class,
                                                    std::span<const std::uint8_t> data) noexcept;

/// The controller's state that an error frame contains, and TEC and REC where the driver supplies them (bytes
/// 6 and 7). Only the class is known: bytes empty.
void update_status(ControllerStatus& status, std::uint32_t error_class,
                   std::span<const std::uint8_t> data) noexcept;

}  // namespace canopus::link
