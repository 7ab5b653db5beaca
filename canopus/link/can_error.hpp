#pragma once
// What a CAN interface says of its controller's errors, in words. SocketCAN has error frames for it, of which
// socketcand passes on the class.

#include <cstdint>
#include <span>
#include <string_view>

#include "canopus/link/controller_status.hpp"

namespace canopus::link {

/// Nobody acknowledges what is sent: the class of Linux's error frames (CAN_ERR_ACK).
inline constexpr std::uint32_t error_class_acknowledgement = 0x20;

/// The sentence for an error frame of this class with these bytes (none: only the class is known), as far as a
/// person has to know it; empty for all others [Linux include/uapi/linux/can/error.h].
[[nodiscard]] std::string_view describe_error_frame(std::uint32_t error_class,
                                                    std::span<const std::uint8_t> data) noexcept;

/// What an error frame says of the controller, as far as it does: its state, and TEC and REC where its driver tells
/// them (bytes 6 and 7). Only the class is known: bytes empty.
void update_status(ControllerStatus& status, std::uint32_t error_class,
                   std::span<const std::uint8_t> data) noexcept;

}  // namespace canopus::link
