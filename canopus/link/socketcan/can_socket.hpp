#pragma once
// A raw socket of Linux SocketCAN: opening with error frames, own frames back and time stamps; frames in batches.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>

#include <linux/can.h>

#include "canopus/can/frame.hpp"
#include "canopus/link/bus_client.hpp"

namespace canopus::link {

struct CanSocket {
  int descriptor = -1;
  int interface = 0;  ///< its index
};
/// The error is a sentence of what is missing or to do. `ip link set` is needed when the interface is down.
[[nodiscard]] std::expected<CanSocket, std::string> open_can_socket(const std::string& interface);

struct ReceivedFrame {
  enum class Kind : std::uint8_t { frame, own, error };
  Kind kind = Kind::frame;
  can::Frame frame{};
  std::uint32_t error_class = 0;  ///< kind error
  std::optional<std::chrono::nanoseconds> received_at{};
};
inline constexpr std::size_t can_batch = 32;

/// Frames that were there, and how many the socket had to drop so far for want of room.
struct ReceivedBatch {
  std::array<ReceivedFrame, can_batch> places{};
  std::size_t count = 0;
  std::optional<std::uint32_t> dropped{};

  [[nodiscard]] std::span<const ReceivedFrame> frames() const noexcept {
    return std::span(places).first(count);
  }
};
/// Fills the batch. An errno when there is no frame (EAGAIN) or the interface went away.
[[nodiscard]] std::expected<void, int> receive_can_frames(int descriptor, ReceivedBatch& batch);
/// The number of frames, from the first on, that the kernel accepted; an errno if none.
[[nodiscard]] std::expected<std::size_t, int> send_can_frames(int descriptor,
                                                              std::span<const can::Frame> frames);
/// Frames the kernel passes on; all with an empty list. At most 512.
void set_can_filter(int descriptor, std::span<const IdentifierFilter> filters);
/// The failure that waits at the socket (0: none) is taken off.
int clear_socket_error(int descriptor);

}  // namespace canopus::link
