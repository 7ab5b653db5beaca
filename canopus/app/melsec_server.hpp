#pragma once
// The PLC's Ethernet door: a TCP server for the MELSEC communication protocol in front of a rack. It runs on
// the event loop that owns the rack, in its thread, and answers a client as soon as its request is complete.
//
// Clients cannot disturb each other or the bus: each has fixed buffers, is answered no further while it does
// not take its replies, and loses its connection when it stops in the middle of a request.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <string>

#include "canopus/link/loop_clock.hpp"
#include "canopus/plc/rack.hpp"

namespace boost::asio {
class io_context;
}

namespace canopus::app {

struct MelsecServerOptions {
  /// Further ones are accepted and closed at once. A CPU has 16 connections.
  std::size_t maximum_clients = 16;
  /// From the beginning of a request to its last byte.
  std::chrono::milliseconds half_request_timeout{5000};
  /// From a reply that the client does not take to the end of its connection.
  std::chrono::milliseconds send_timeout{30000};
};

class MelsecServer {
 public:
  /// All three must outlive the server.
  MelsecServer(boost::asio::io_context& context, plc::Rack& rack, link::LoopClock& clock,
               MelsecServerOptions options = {});
  /// Stops.
  ~MelsecServer();
  MelsecServer(const MelsecServer&) = delete;
  MelsecServer& operator=(const MelsecServer&) = delete;

  /// Opens the door. `host` is an address or a name; port 0 takes a free one. The error is a sentence:
  /// "127.0.0.1:5007: Address already in use".
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port);
  /// The port it listens on, 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// Clients connected now.
  [[nodiscard]] std::size_t clients() const noexcept;
  /// Requests answered since the start.
  [[nodiscard]] std::uint64_t requests() const noexcept;
  /// Closes the door and all connections; nothing is accessed any more.
  void stop() noexcept;

 private:
  struct Parts;
  class Connection;
  std::shared_ptr<Parts> parts_;  // also held by handlers that wait in the context
};

}  // namespace canopus::app
