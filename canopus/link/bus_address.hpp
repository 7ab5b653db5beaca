#pragma once
// The addresses of buses that a client can join:
//
//   socketcand:127.0.0.1:29536/line1    the bus line1 behind a socketcand server (`canopus run` has one per bus)
//   socketcand:127.0.0.1:29536          the only bus behind that server; other makes of servers need the name
//   socketcan:can0                      a CAN interface of this machine (Linux SocketCAN)
//   slcan:/dev/ttyACM0@250000           a Lawicel adapter at a serial device, and the bit rate to open it with
//   slcan:/dev/ttyUSB0,115200@250000    the same with the speed of the serial line (default 115200)
//   slcan:tcp:192.168.1.9:3333@250000   a Lawicel adapter behind TCP
//   udp-multicast:239.74.163.2:43113    python-can's virtual bus of a network
//   cannelloni:192.168.1.9:20000        a cannelloni over UDP; we listen on port 20000, too, or on the port
//                                       behind a further colon
//   cannelloni:tcp:192.168.1.9:20000    a cannelloni server over TCP

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

namespace canopus::link {

struct BusAddress {
  enum class Kind : std::uint8_t { socketcand, socketcan, slcan, udp_multicast, cannelloni };
  Kind kind = Kind::socketcand;
  std::string host{};      ///< name, IPv4 address or IPv6 address (without its brackets)
  std::uint16_t port = 0;  ///< 1..65535 where there is a host
  /// socketcand: the bus's name, may be empty; socketcan: the interface's, 1..15 characters; slcan: the path of the
  /// serial device, empty for TCP.
  std::string bus{};
  bool tcp = false;                ///< slcan and cannelloni: TCP
  std::uint16_t local_port = 0;    ///< cannelloni over UDP: where we listen
  std::uint32_t bit_rate = 0;      ///< slcan: bit/s of the bus; 0: the adapter is opened as it is
  std::uint32_t serial_speed = 0;  ///< slcan: bit/s of a serial device

  friend bool operator==(const BusAddress&, const BusAddress&) = default;
};

/// Host and port may be left out from the right where there is a usual port: `socketcand:`, `socketcand:localhost` mean
/// port 29536. The error is a sentence that names the text and what was expected.
[[nodiscard]] std::expected<BusAddress, std::string> parse_bus_address(std::string_view text);

/// As parse_bus_address() reads it.
[[nodiscard]] std::string describe(const BusAddress& address);

}  // namespace canopus::link
