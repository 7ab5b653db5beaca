#pragma once
// Service discovery of socketcand: a broadcast datagram to UDP port 42000 with the address of a server and the name of its bus, by
// which clients (python-can's detect_beacon, Kayak) find it [socketcand doc/protocol.md, service discovery].

#include <array>
#include <chrono>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>

namespace canopus::link {

inline constexpr unsigned short socketcand_beacon_port = 42000;

/// The text of a beacon, an element CANBeacon of XML with the name of the plant, the URL of the server
/// (can://127.0.0.1:29536) and the name of the bus.
[[nodiscard]] std::string socketcand_beacon(const std::string& name, const std::string& bus,
                                            const boost::asio::ip::tcp::endpoint& server);

/// Where the beacon of a server at this address goes: on this machine if it is the server's alone, else into its network. No
/// broadcast is known for IPv6: this machine.
[[nodiscard]] boost::asio::ip::udp::endpoint beacon_destination(const boost::asio::ip::address& server);

class SocketcandBeacon {
 public:
  /// The protocol wants at most 3 s from one to the next.
  static constexpr std::chrono::milliseconds period{2000};

  /// Sends `text` now and each period, in real time. What the system refuses to send is left out. `context` outlives it.
  SocketcandBeacon(boost::asio::io_context& context, const boost::asio::ip::udp::endpoint& to,
                   std::string text);
  ~SocketcandBeacon();
  SocketcandBeacon(const SocketcandBeacon&) = delete;
  SocketcandBeacon& operator=(const SocketcandBeacon&) = delete;

 private:
  struct Sender;
  std::shared_ptr<Sender> sender_;  // handlers may outlive the beacon by one round of the loop
};

}  // namespace canopus::link
