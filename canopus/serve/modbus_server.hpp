#pragma once
// A port of a rack for Modbus TCP.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>

#include "canopus/plc/modbus/settings.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/serve/tcp_server.hpp"

namespace canopus::serve {

/// The settings of a port.
struct ModbusPort {
  plc::modbus::Settings settings{};
  /// Clients that may write, as far as the settings allow; others never. None: all may.
  std::optional<link::AllowList> writers{};
};

class ModbusServer {
 public:
  /// The first three must outlive the server.
  ModbusServer(boost::asio::io_context& context, plc::Rack& rack, link::LoopClock& clock, ModbusPort port,
               TcpServerOptions options = {}, link::ClientReport report = {});

  /// Starts to accept. `host` is an address or a name; port 0 takes a free one. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port) {
    return server_.listen(host, port);
  }
  /// The port it listens on, 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept { return server_.port(); }
  /// Clients connected now.
  [[nodiscard]] std::size_t clients() const noexcept { return server_.clients(); }
  /// Requests answered since the start.
  [[nodiscard]] std::uint64_t requests() const noexcept { return server_.requests(); }
  /// Closes the port and all connections; nothing is accessed any more.
  void stop() noexcept { server_.stop(); }

 private:
  ModbusPort port_;  // outlives the conversations
  TcpServer server_;
};

}  // namespace canopus::serve
