#pragma once
// What a CAN interface says of its controller's errors, in words. SocketCAN has error frames for it, of which
// socketcand passes on the class.

#include <cstdint>
#include <span>
#include <string_view>

namespace canopus::link {

/// Nobody acknowledges what is sent: the class of Linux's error frames (CAN_ERR_ACK).
inline constexpr std::uint32_t error_class_acknowledgement = 0x20;

/// The sentence for an error frame of this class with these bytes (none: only the class is known), as far as a
/// person has to know it; empty for all others [Linux include/uapi/linux/can/error.h].
[[nodiscard]] std::string_view describe_error_frame(std::uint32_t error_class,
                                                    std::span<const std::uint8_t> data) noexcept;

}  // namespace canopus::link
