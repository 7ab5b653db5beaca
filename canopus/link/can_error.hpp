#pragma once
// Texts for the errors of a CAN interface's controller. SocketCAN reports them by error frames; socketcand
// forwards their class.

#include <cstdint>
#include <span>
#include <string_view>

#include "canopus/link/controller_status.hpp"

namespace canopus::link {

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
