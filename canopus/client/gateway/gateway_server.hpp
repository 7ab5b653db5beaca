#pragma once
// The TCP port of an ASCII gateway [CiA 309-3]: a session for each client, all on one bus. Clients cannot disturb each
// other: lines have a greatest length, a client waits while its command is under way or its answers wait for it, and one
// that does not take its events loses its connection.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "canopus/client/gateway/gateway.hpp"
#include "canopus/link/allow_list.hpp"
#include "canopus/link/peer.hpp"
#include "canopus/link/tcp_clients.hpp"

namespace canopus::client {

class GatewayServer final : public can::Participant {
 public:
  struct Options {
    link::AllowList allowed{};  ///< clients that may connect
    std::size_t clients = 32;   ///< one more gets a line and is closed
    /// Bytes that wait for a client; with more its connection ends.
    std::size_t most_waiting = 4 << 20;
    /// With more of them its next command waits.
    std::size_t enough_waiting = 64 << 10;
    /// Time that a client has after its last input to finish its commands and read their answers.
    std::chrono::milliseconds patience{60'000};
  };
  /// The bus's time.
  using Clock = std::function<can::Time()>;

  GatewayServer(boost::asio::io_context& io, Gateway& gateway, Clock clock, Options options,
                link::ClientReport report);
  ~GatewayServer() override;
  GatewayServer(const GatewayServer&) = delete;
  GatewayServer& operator=(const GatewayServer&) = delete;

  /// `host` is an address or a name; port 0 takes a free one. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port);
  [[nodiscard]] std::uint16_t port() const noexcept { return clients_.port(); }
  [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }

  // can::Participant: for the gateway and the sessions
  void receive(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;

 private:
  class Client;
  void admit(link::TcpPort::Socket socket);
  void read_next();

  Gateway& gateway_;
  Clock clock_;
  Options options_;
  link::TcpClients<Client> clients_;
};

}  // namespace canopus::client
