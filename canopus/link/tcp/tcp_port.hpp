#pragma once
// A TCP port that takes connections until it is closed, on the event loop of its io_context. When the process
// has no file descriptor left, a client is still accepted, to refuse it with a message; after other errors of
// accept() it waits and tries again.

#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

namespace canopus::link {

class TcpPort {
 public:
  using Acceptor = boost::asio::ip::tcp::acceptor;
  using Endpoint = boost::asio::ip::tcp::endpoint;
  using Socket = boost::asio::ip::tcp::socket;
  struct Users {
    /// A client has connected, and is still there.
    std::function<void(Socket socket)> admit{};
    /// A client has connected, and there is no file descriptor for it (no_descriptor_left). Its socket is closed
    /// behind this.
    std::function<void(Socket& socket)> refuse{};
  };

  /// Why a client is turned away then.
  static constexpr const char* no_descriptor_left =
      "was refused: the process has no file descriptor left (ulimit -n)";

  /// Nothing happens before listen(). `context` must outlive the port.
  explicit TcpPort(boost::asio::io_context& context);
  /// close()
  ~TcpPort();
  TcpPort(const TcpPort&) = delete;
  TcpPort& operator=(const TcpPort&) = delete;

  /// Starts to accept; the users are kept until close(). `prepare` sets options that connections inherit.
  [[nodiscard]] boost::system::error_code listen(const Endpoint& endpoint, Users users,
                                                 void (*prepare)(Acceptor& acceptor) = nullptr);
  /// The same. `host` is an address or a name; port 0 takes a free one. The error is a sentence:
  /// "127.0.0.1:5007: Address already in use".
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port,
                                                        Users users);
  /// The port it listens on (the one the system chose when that was 0); 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// No callback is called after this.
  void close() noexcept;

 private:
  struct State;
  std::shared_ptr<State> state_;  // also held by handlers that wait in the context
};

}  // namespace canopus::link
