#pragma once
// One CAN message as python-can's udp_multicast bus sends it, without any I/O: one datagram is one MessagePack map of
// the eleven fields of a message. python-can refuses a map with other fields, so we write exactly these.
// [python-can 4.1 can/interfaces/udp_multicast; MessagePack specification]

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string_view>

#include "canopus/can/frame.hpp"

namespace canopus::link {

inline constexpr std::size_t multicast_max_datagram = 256;

/// Writes a frame with its time (since 1970, UTC) and returns the length.
std::size_t write_multicast_datagram(std::span<std::uint8_t, multicast_max_datagram> out,
                                     const can::Frame& frame, std::chrono::nanoseconds time) noexcept;

struct MulticastMessage {
  enum class Kind : std::uint8_t {
    frame,
    error_frame,  ///< of a controller; its identifier and data have the class (can_error.hpp)
    fd_frame,     ///< CAN FD: not for us
  };
  Kind kind = Kind::frame;
  can::Frame frame{};
  std::chrono::nanoseconds time{};  ///< the sender's time stamp; 0 if it is not valid
};

/// The error names the fault of the datagram. Unknown fields are skipped; bytes behind the map are a mistake.
[[nodiscard]] std::expected<MulticastMessage, std::string_view> read_multicast_datagram(
    std::span<const std::uint8_t> datagram) noexcept;

}  // namespace canopus::link
