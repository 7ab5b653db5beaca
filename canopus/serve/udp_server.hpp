#pragma once
// A UDP server in front of a rack: each datagram is a request, and its reply goes back to where it came from. It runs on the
// event loop that owns the rack, in its thread. Of a rack with a scan of its own datagrams are read and answered at the END of
// the scan (plc/rack/end_processing.hpp).
//
// A client is an address and port. The state of its conversation (a monitor list, the unlocked password) is
// kept for as many clients as there are TCP connections; one more replaces the client with the oldest
// request. A flood of datagrams is read a few at a time, so that other servers have their turn; the system
// drops those that its socket buffer cannot hold. Nothing waits for a client that does not read.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include <boost/asio/io_context.hpp>

#include "canopus/can/time.hpp"
#include "canopus/link/allow_list.hpp"
#include "canopus/link/loop_clock.hpp"
#include "canopus/link/peer.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::serve {

/// A client's requests and replies, one datagram each.
class DatagramConversation {
 public:
  virtual ~DatagramConversation() = default;
  /// The reply, valid until the next call; empty: none.
  virtual std::span<const std::uint8_t> answer(std::span<const std::uint8_t> request, can::Time now) = 0;
};
using MakeDatagramConversation =
    std::function<std::unique_ptr<DatagramConversation>(const link::InternetAddress& client)>;

struct UdpServerOptions {
  link::AllowList allowed{};         ///< clients that get answers
  std::size_t maximum_clients = 16;  ///< that are remembered
  std::size_t turn = 32;             ///< datagrams read before others have their turn
  std::size_t turn_at_end = 256;     ///< likewise at the END of a scan; further ones wait for the next
};

class UdpServer {
 public:
  /// `context`, `rack`, `clock` and what `make` needs must outlive the server.
  UdpServer(boost::asio::io_context& context, plc::Rack& rack, link::LoopClock& clock,
            MakeDatagramConversation make, UdpServerOptions options = {}, link::ClientReport report = {});
  /// Stops.
  ~UdpServer();
  UdpServer(const UdpServer&) = delete;
  UdpServer& operator=(const UdpServer&) = delete;

  /// Starts to answer. `host` is an address or a name; port 0 takes a free one. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port);
  /// The port it listens on, 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// Clients that are remembered.
  [[nodiscard]] std::size_t clients() const noexcept;
  /// Requests answered since the start.
  [[nodiscard]] std::uint64_t requests() const noexcept;
  /// Closes the port; nothing is accessed any more.
  void stop() noexcept;

 private:
  struct Parts;
  std::shared_ptr<Parts> parts_;  // also held by handlers that wait in the context
};

}  // namespace canopus::serve
