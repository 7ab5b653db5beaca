#pragma once
// Common to the clients of every TCP server: which may connect, which are refused, replaced or reported, and
// how a connection ends. The server itself implements its protocol.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "canopus/link/allow_list.hpp"
#include "canopus/link/peer.hpp"
#include "canopus/link/tcp/connection_places.hpp"
#include "canopus/link/tcp/connection_timer.hpp"
#include "canopus/link/tcp/tcp_port.hpp"

namespace canopus::link {

/// The port of a server and its clients. `Client` is the server's class of one connection. For close() it has a close(),
/// for make_room() and give_way() name() and place() (a HeldPlace), too.
template <typename Client>
class TcpClients {
 public:
  using Socket = TcpPort::Socket;
  struct Rules {
    AllowList allowed{};   ///< that may connect
    std::size_t most = 0;  ///< connections at a time
    /// With Hold::while_used.
    std::chrono::milliseconds gives_way_after{};
  };

  /// `context` must outlive this.
  TcpClients(boost::asio::io_context& context, Rules rules, ClientReport report)
      : context_(context), rules_(std::move(rules)), report_(std::move(report)), port_(context) {}

  /// Starts to accept. `admit` is called with each connection; `answer` is sent to one for which there is no file
  /// descriptor. `host` is an address or a name; port 0 takes a free one. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port,
                                                        std::function<void(Socket)> admit,
                                                        std::string_view answer = {}) {
    return port_.listen(host, port, users(std::move(admit), answer));
  }
  /// The same at an endpoint, with options that connections inherit.
  [[nodiscard]] boost::system::error_code listen(const TcpPort::Endpoint& endpoint,
                                                 void (*prepare)(TcpPort::Acceptor& acceptor),
                                                 std::function<void(Socket)> admit, std::string_view answer) {
    return port_.listen(endpoint, users(std::move(admit), answer), prepare);
  }
  /// The port it listens on, 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept { return port_.port(); }

  /// Whether the rules allow this client. If not, it is refused with this answer.
  [[nodiscard]] bool may_connect(Socket& socket, std::string_view answer = {}) const {
    if (is_allowed(socket, rules_.allowed)) return true;
    refuse(socket, "is not allowed to connect", answer);
    return false;
  }
  /// Whether there is a place for a client of this name, now that another one may have given way (ConnectionPlaces).
  [[nodiscard]] bool make_room(const std::string& newcomer, HeldPlace::Clock::time_point now) {
    return places().make_room(all_, newcomer, now, reporter());
  }
  /// Closes one of the clients for which `IsMeant` is true in favour of a client of this name, if one gives
  /// way.
  template <typename IsMeant>
  void give_way(const std::string& newcomer, HeldPlace::Clock::time_point now, const IsMeant& is_meant) {
    places().give_way(all_, newcomer, now, reporter(), is_meant);
  }
  [[nodiscard]] bool is_full() const noexcept { return all_.size() >= rules_.most; }
  const std::shared_ptr<Client>& add(const std::shared_ptr<Client>& client) {
    all_.push_back(client);
    return client;
  }
  void remove(const Client& client) {
    std::erase_if(all_, [&](const auto& other) { return other.get() == &client; });
  }
  /// `why`: "was refused: ...". What the answer does not fit into at once is not sent.
  void refuse(Socket& socket, std::string_view why, std::string_view answer = {}) const {
    report(name_of_peer(socket), why);
    boost::system::error_code ignored;
    socket.non_blocking(true, ignored);
    if (!answer.empty()) socket.write_some(boost::asio::buffer(answer), ignored);
    socket.close(ignored);
  }
  /// Reports a message about a client for the user, behind its name.
  void report(const std::string& client, std::string_view what) const {
    if (report_) report_(client + ' ' + std::string(what));
  }

  /// Copy it where a client may be removed meanwhile.
  [[nodiscard]] const std::vector<std::shared_ptr<Client>>& all() const noexcept { return all_; }
  [[nodiscard]] std::size_t size() const noexcept { return all_.size(); }
  [[nodiscard]] boost::asio::io_context& context() const noexcept { return context_; }

  void close_port() noexcept { port_.close(); }
  /// Closes the port and all connections.
  void close() noexcept {
    port_.close();
    for (const auto& client : std::exchange(all_, {})) client->close();
  }

 private:
  [[nodiscard]] TcpPort::Users users(std::function<void(Socket)> admit, std::string_view answer) {
    return {.admit = std::move(admit), .refuse = [this, answer](Socket& socket) {
              refuse(socket, TcpPort::no_descriptor_left, answer);
            }};
  }
  [[nodiscard]] ConnectionPlaces places() const { return {rules_.most, rules_.gives_way_after}; }
  [[nodiscard]] auto reporter() const {
    return [this](const std::string& client, const std::string& what) { report(client, what); };
  }

  boost::asio::io_context& context_;
  Rules rules_;
  ClientReport report_;
  TcpPort port_;
  std::vector<std::shared_ptr<Client>> all_;
};

/// One connection of a server, the base of its class. Handlers that are under way hold it; once it is closed they do
/// nothing, for the server may be gone.
template <typename Client>
class TcpClient : public std::enable_shared_from_this<Client> {
 public:
  /// For messages: "127.0.0.1:50123".
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 protected:
  TcpClient(TcpClients<Client>& clients, std::string name)
      : clients_(&clients), name_(std::move(name)), timer_(clients.context()) {}
  ~TcpClient() = default;

  [[nodiscard]] bool is_closed() const noexcept { return clients_ == nullptr; }
  /// Common part of close() of all classes.
  void close_socket(boost::asio::ip::tcp::socket& socket) noexcept {
    clients_ = nullptr;
    boost::system::error_code ignored;
    socket.shutdown(boost::asio::ip::tcp::socket::shutdown_both, ignored);
    socket.close(ignored);
    timer_.stop();
  }

  /// The connection ends after this time, for this reason (see end()), unless the timer is set or stopped before.
  void set_timer(std::chrono::milliseconds timeout, const char* reason) {
    timer_.set(timeout, [self = this->shared_from_this(), reason] {
      if (!self->is_closed()) self->end(reason);
    });
  }
  void stop_timer() noexcept { timer_.stop(); }
  [[nodiscard]] bool is_timer_set() const noexcept { return timer_.is_set(); }

  void report(std::string_view what) const { clients_->report(name_, what); }
  /// Closes it and takes it off the list. `reason`: the client's fault, if the client did not end the
  /// connection itself.
  void end(const char* reason = nullptr) {
    const auto self = this->shared_from_this();
    TcpClients<Client>& clients = *clients_;
    if (reason != nullptr) report(std::string(reason) + ": its connection is closed");
    self->close();
    clients.remove(*self);
  }

 private:
  TcpClients<Client>* clients_;  // null once it is closed
  std::string name_;
  ConnectionTimer timer_;
};

}  // namespace canopus::link
