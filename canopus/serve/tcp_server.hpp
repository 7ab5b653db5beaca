#pragma once
// A TCP server in front of a rack: one conversation per client, in the protocol of its factory. It runs on
// the event loop that owns the rack, in its thread, and answers a client as soon as its request is complete;
// of a rack with a scan of its own at the END of the scan (plc/rack/end_processing.hpp). Clients that ask at
// the same time are answered in the order in which the loop finds their requests. Requests that a connection
// has received completely are executed then, even if its client has disconnected.
//
// Clients cannot disturb each other or the bus: each has fixed buffers, gets no further answers while it does
// not read its replies, and loses its connection when it stops in the middle of a request. An idle one is
// checked by TCP keep-alive, as a CPU does, and is closed when all connections are in use. A connection that
// its client did not end is reported.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <boost/asio/io_context.hpp>

#include "canopus/can/time.hpp"
#include "canopus/link/allow_list.hpp"
#include "canopus/link/loop_clock.hpp"
#include "canopus/link/peer.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::serve {

/// A client's requests and replies; see plc/melsec/session.hpp, whose functions these are.
class Conversation {
 public:
  virtual ~Conversation() = default;
  [[nodiscard]] virtual std::span<std::uint8_t> space() = 0;
  virtual void received(std::size_t count) = 0;
  [[nodiscard]] virtual bool has_request() = 0;
  virtual std::size_t process(can::Time now) = 0;
  [[nodiscard]] virtual std::span<const std::uint8_t> output() const = 0;
  virtual void sent(std::size_t count) = 0;
  [[nodiscard]] virtual bool over() const = 0;
  /// Why it is over, in the words of a report; empty: what came is no request of the protocol.
  [[nodiscard]] virtual std::string_view refusal() const { return {}; }
  [[nodiscard]] virtual bool half_request() const = 0;
};

/// A protocol's session as a conversation.
template <typename Session>
class ConversationOf final : public Conversation {
 public:
  template <typename... Arguments>
  explicit ConversationOf(Arguments&&... arguments) : session_(std::forward<Arguments>(arguments)...) {}

  [[nodiscard]] std::span<std::uint8_t> space() override { return session_.space(); }
  void received(std::size_t count) override { session_.received(count); }
  [[nodiscard]] bool has_request() override { return session_.has_request(); }
  std::size_t process(can::Time now) override { return session_.process(now); }
  [[nodiscard]] std::span<const std::uint8_t> output() const override { return session_.output(); }
  void sent(std::size_t count) override { session_.sent(count); }
  [[nodiscard]] bool over() const override { return session_.over(); }
  [[nodiscard]] std::string_view refusal() const override {
    if constexpr (requires { session_.refusal(); }) return session_.refusal();
    return {};
  }
  [[nodiscard]] bool half_request() const override { return session_.half_request(); }

 private:
  Session session_;
};

/// Makes the conversation of a client at this address.
using MakeConversation = std::function<std::unique_ptr<Conversation>(const link::InternetAddress& client)>;

struct TcpServerOptions {
  link::AllowList allowed{};  ///< clients that may connect
  /// A CPU has 16 connections. A further client takes the place of the one that has sent no request for the
  /// longest time; when that is shorter than `gives_way_after`, it is closed at once.
  std::size_t maximum_clients = 16;
  std::chrono::milliseconds gives_way_after{10000};
  /// A client from which nothing came for `alive_check_start` gets TCP keep-alive messages, one per interval.
  /// The number of unanswered alive checks that ends the connection: after 45 s as with a Q03UDVCPU
  /// [SH-080811 3.6].
  std::chrono::seconds alive_check_start{5};
  std::chrono::seconds alive_check_interval{5};
  int alive_checks = 8;
  /// From the beginning of a request to its last byte.
  std::chrono::milliseconds half_request_timeout{5000};
  /// From a reply that the client does not take to the end of its connection.
  std::chrono::milliseconds send_timeout{30000};
};

class TcpServer {
 public:
  /// `context`, `rack`, `clock` and what `make` needs must outlive the server. `protocol` is for reports: "MC
  /// protocol".
  TcpServer(boost::asio::io_context& context, plc::Rack& rack, link::LoopClock& clock, std::string protocol,
            MakeConversation make, TcpServerOptions options = {}, link::ClientReport report = {});
  /// Stops.
  ~TcpServer();
  TcpServer(const TcpServer&) = delete;
  TcpServer& operator=(const TcpServer&) = delete;

  /// Starts to accept. `host` is an address or a name; port 0 takes a free one. The error is a sentence:
  /// "127.0.0.1:5007: Address already in use".
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port);
  /// The port it listens on, 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// Clients connected now.
  [[nodiscard]] std::size_t clients() const noexcept;
  /// Requests answered since the start.
  [[nodiscard]] std::uint64_t requests() const noexcept;
  /// Closes the port and all connections; nothing is accessed any more.
  void stop() noexcept;

 private:
  struct Parts;
  class Connection;
  std::shared_ptr<Parts> parts_;  // also held by handlers that wait in the context
};

}  // namespace canopus::serve
