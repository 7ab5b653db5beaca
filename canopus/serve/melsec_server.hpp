#pragma once
// A port of the PLC's Ethernet module for the MELSEC communication protocol, over TCP or UDP.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>

#include "canopus/plc/melsec/password_guard.hpp"
#include "canopus/plc/melsec/port_settings.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/serve/tcp_server.hpp"
#include "canopus/serve/udp_server.hpp"

namespace canopus::serve {

using MelsecServerOptions = TcpServerOptions;

/// The settings of a port.
struct MelsecPort {
  bool udp = false;
  plc::melsec::PortSettings settings{};
  /// Clients that may write, as far as the settings allow; others never. None: all may.
  std::optional<link::AllowList> writers{};
};

class MelsecServer {
 public:
  /// The first three must outlive the server.
  MelsecServer(boost::asio::io_context& context, plc::Rack& rack, link::LoopClock& clock,
               MelsecServerOptions options = {}, link::ClientReport report = {}, MelsecPort port = {});

  /// Starts to accept. `host` is an address or a name; port 0 takes a free one. The error is a sentence:
  /// "127.0.0.1:5007: Address already in use".
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port);
  /// The port it listens on, 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// Clients connected now; of UDP those that are remembered.
  [[nodiscard]] std::size_t clients() const noexcept;
  /// Requests answered since the start.
  [[nodiscard]] std::uint64_t requests() const noexcept;
  /// Closes the port and all connections; nothing is accessed any more.
  void stop() noexcept;

 private:
  [[nodiscard]] plc::melsec::PortSettings settings_for(const link::InternetAddress& client) const;

  plc::Rack& rack_;
  MelsecPort port_;
  plc::melsec::PasswordGuard guard_;
  std::optional<TcpServer> tcp_;  // one of the two
  std::optional<UdpServer> udp_;
};

}  // namespace canopus::serve
