#pragma once
// A bus of another process or of this machine's hardware, joined as a client: frames go in, frames come out.
// Behind the one interface are a socketcand server (TCP) and SocketCAN (a raw socket of the kernel).
//
// Everything runs on the thread of the io_context.

#include <chrono>
#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>

#include "canopus/can/controller.hpp"
#include "canopus/link/bus_address.hpp"

namespace canopus::link {

/// Hears a bus. May send from inside.
class BusClientUser {
 public:
  virtual void frame_received(const can::Frame& frame) = 0;
  /// The connection ended and does not come back; a sentence says why.
  virtual void bus_lost(const std::string& reason) = 0;
  /// The other side says that something went wrong, for example that frames were lost. The bus goes on.
  virtual void bus_complains(std::string_view /*text*/) {}

 protected:
  ~BusClientUser() = default;
};

class BusClient : public can::Sink {
 public:
  virtual ~BusClient() = default;
  /// Frames sent by this client itself are not heard. send() is false when 4096 frames wait already, or the
  /// bus is lost.
  virtual void set_user(BusClientUser* user) = 0;
  /// Ends the connection once everything sent so far is on its way to the bus; runs the io_context until
  /// then, or for `time_out`. False when it was not done by then. Nothing is heard from now on.
  virtual bool close(std::chrono::milliseconds time_out) = 0;
};

/// Joins a bus; runs the io_context until that is done, or for `time_out`. The error is a sentence with the
/// address: "socketcand:127.0.0.1:29536: Connection refused".
[[nodiscard]] std::expected<std::unique_ptr<BusClient>, std::string> open_bus(
    boost::asio::io_context& io, const BusAddress& address, std::chrono::milliseconds time_out);

// The two kinds, for open_bus().
[[nodiscard]] std::expected<std::unique_ptr<BusClient>, std::string> open_socketcand(
    boost::asio::io_context& io, const BusAddress& address, std::chrono::milliseconds time_out);
[[nodiscard]] std::expected<std::unique_ptr<BusClient>, std::string> open_socketcan(
    boost::asio::io_context& io, const BusAddress& address);

}  // namespace canopus::link
