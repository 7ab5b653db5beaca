#pragma once
// How people name a bus that a client is to join:
//
//   socketcand:127.0.0.1:29536/line1    the bus line1 behind a socketcand server (`canopus run` has one per
//   bus) socketcand:127.0.0.1:29536          the only bus behind that server; servers of other makes want the
//   name socketcan:can0                      a CAN interface of this machine (Linux SocketCAN)

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

namespace canopus::link {

struct BusAddress {
  enum class Kind : std::uint8_t { socketcand, socketcan };
  Kind kind = Kind::socketcand;
  std::string host{};      ///< socketcand: name, IPv4 address or IPv6 address (without its brackets)
  std::uint16_t port = 0;  ///< socketcand: 1..65535
  std::string
      bus{};  ///< socketcand: the bus's name, may be empty; socketcan: the interface's, 1..15 characters

  friend bool operator==(const BusAddress&, const BusAddress&) = default;
};

/// Host and port may be left out from the right: `socketcand:`, `socketcand:localhost` mean port 29536. The
/// error is a sentence that names the text and what was expected.
[[nodiscard]] std::expected<BusAddress, std::string> parse_bus_address(std::string_view text);

/// As parse_bus_address() reads it.
[[nodiscard]] std::string describe(const BusAddress& address);

}  // namespace canopus::link
