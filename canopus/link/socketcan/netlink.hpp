#pragma once
// Queries and configures network interfaces (rtnetlink), and receives notifications of their changes.

#include <cstdint>
#include <expected>
#include <string>

#include "canopus/link/socketcan/link_message.hpp"

namespace canopus::link {

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
