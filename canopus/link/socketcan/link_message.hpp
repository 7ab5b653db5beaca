#pragma once
// Netlink messages of a network interface, as far as a CAN interface needs them: parsing those of the kernel
// and building ours, without any I/O. [Linux include/uapi/linux/rtnetlink.h, if_link.h, can/netlink.h]

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/link/controller_status.hpp"

namespace canopus::link {

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

}  // namespace canopus::link
