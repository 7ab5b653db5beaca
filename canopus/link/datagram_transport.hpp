#pragma once
// A transport over datagrams (UDP): reads them, and writes the frames that wait once the event loop comes by. A frame
// counts as sent when its datagram was handed to the system.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include <boost/asio/ip/udp.hpp>

#include "canopus/link/handler_memory.hpp"
#include "canopus/link/transport.hpp"

namespace canopus::link {

class DatagramTransport : public Transport {
 public:
  using Endpoint = boost::asio::ip::udp::endpoint;
  using Socket = boost::asio::ip::udp::socket;

  DatagramTransport(boost::asio::io_context& io, BusAddress address, BusClientOptions options);

 protected:
  virtual void datagram_received(std::span<const std::uint8_t> bytes, const Endpoint& sender) = 0;
  /// Takes frames off queue() and hands them to the system with write_datagram().
  virtual void write_frames() = 0;

  /// Reads from this socket from now on.
  void use_socket(Socket socket);
  /// False: not now (tried again), or the bus is lost.
  bool write_datagram(Socket& socket, std::span<const std::uint8_t> bytes, const Endpoint& to);
  void disconnect() override;
  void write() override;
  [[nodiscard]] const BusAddress& address() const noexcept { return address_; }
  [[nodiscard]] Socket& socket() noexcept { return socket_; }

 private:
  void read();

  BusAddress address_;
  Socket socket_;
  boost::asio::steady_timer pause_;
  HandlerPlace reading_place_;
  HandlerPlace pause_place_;
  Endpoint sender_;
  std::uint32_t generation_ = 0;
  std::array<std::uint8_t, 65536> input_;
  bool writing_ = false;  // write_frames() is called soon
};

}  // namespace canopus::link
