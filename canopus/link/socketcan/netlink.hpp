#pragma once
// Queries and configures network interfaces (rtnetlink), and receives notifications of their changes.

#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/link/controller_status.hpp"

namespace canopus::link {

/// Netlink messages of a network interface, as far as a CAN interface needs them: parsing those of the kernel
/// and building ours, without any I/O. [Linux include/uapi/linux/rtnetlink.h, if_link.h, can/netlink.h]
struct LinkMessage {
  enum class Kind : std::uint8_t {
    link,    ///< an interface, as it is now
    gone,    ///< it is no more
    answer,  ///< to a request of ours: `error` is 0 or an errno
  };
  Kind kind = Kind::link;
  int error = 0;
  int index = 0;
  bool up = false;
  std::string name{};
  std::string type{};  ///< "can", "vcan"
  /// A controller's state. Virtual interfaces have none.
  std::optional<ControllerStatus> controller{};
  std::uint32_t restart_ms = 0;  ///< from bus-off to the automatic restart; 0: there is none
};

/// The complete messages of one recv(); others are skipped.
[[nodiscard]] std::vector<LinkMessage> read_link_messages(std::span<const std::uint8_t> bytes);

using NetlinkRequest = std::vector<std::uint8_t>;
/// Asks for one interface.
[[nodiscard]] NetlinkRequest link_request(std::string_view name, std::uint32_t sequence);
[[nodiscard]] NetlinkRequest set_link_up(int index, bool up, std::uint32_t sequence);
/// For an interface that is down.
[[nodiscard]] NetlinkRequest set_link_bit_rate(int index, std::uint32_t bit_rate, std::uint32_t sequence);

/// A socket for requests, or, `with_events`, for what the kernel reports by itself. A machine may have none (then
/// everything is an error).
class Netlink {
 public:
  explicit Netlink(bool with_events);
  ~Netlink();
  Netlink(const Netlink&) = delete;
  Netlink& operator=(const Netlink&) = delete;

  /// For waiting on events; -1: none.
  [[nodiscard]] int descriptor() const noexcept { return socket_; }
  /// Leaves the descriptor to its new owner.
  int release() noexcept;

  /// The error is an errno.
  [[nodiscard]] std::expected<LinkMessage, int> request(const std::string& name);
  [[nodiscard]] std::expected<void, int> set_up(int index, bool up);
  [[nodiscard]] std::expected<void, int> set_bit_rate(int index, std::uint32_t bit_rate);

 private:
  [[nodiscard]] std::expected<LinkMessage, int> exchange(const NetlinkRequest& request);
  [[nodiscard]] std::expected<void, int> command(const NetlinkRequest& request);

  int socket_ = -1;
  std::uint32_t sequence_ = 0;
};

}  // namespace canopus::link
