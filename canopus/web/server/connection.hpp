#pragma once
// One client of the page's server: a request and its answer, or a request and then a WebSocket.

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "canopus/link/tcp_clients.hpp"
#include "canopus/web/http/frame_count.hpp"
#include "canopus/web/http/limits.hpp"
#include "canopus/web/http/request.hpp"
#include "canopus/web/server/client_message.hpp"
#include "canopus/web/server/send_queue.hpp"
#include "canopus/web/server/server.hpp"

namespace canopus::web {

class WebServer::Connection : public link::TcpClient<Connection> {
 public:
  Connection(Parts& parts, boost::asio::ip::tcp::socket socket, std::string name);

  void start();

  [[nodiscard]] bool watches() const noexcept { return state_ == State::watches; }
  [[nodiscard]] link::InternetAddress network() const noexcept { return network_of(address_); }
  [[nodiscard]] bool has_place_of_watcher() const noexcept { return watches() || state_ == State::upgrades; }
  /// The name of the user who has logged in; nullptr: none has.
  [[nodiscard]] const std::string* user() const noexcept { return session_ ? &session_->user.name : nullptr; }
  [[nodiscard]] bool knows_key() const noexcept { return knows_key_; }
  /// The oldest give way first.
  [[nodiscard]] link::HeldPlace place() const noexcept { return {.hold = hold(), .used = began_}; }
  /// Of what is on its way to the client, and of replies.
  [[nodiscard]] std::size_t waiting_bytes() const noexcept {
    return outbox_.reply_bytes() + (is_sending_ ? output_.size() : 0);
  }
  [[nodiscard]] bool wants_messages() const noexcept { return watches() && wants_messages_; }

  void add_event(const SendQueue::Text& event) { outbox_.add_event(event); }
  void set_state(const SendQueue::Text& state) { outbox_.set_state(state); }
  void set_messages(const SendQueue::Text& messages) { outbox_.set_messages(messages); }
  [[nodiscard]] const std::vector<std::string>& views() const noexcept { return views_; }
  void set_view(std::size_t number, const SendQueue::Text& view) { outbox_.set_view(number, view); }

  /// Sends what waits, when nothing is under way.
  void send();
  /// Beast waits without end for a client that it has closed to close its side, too.
  void end_if_over(std::chrono::steady_clock::time_point now);
  void close() noexcept;
  using TcpClient::end;

 private:
  enum class State : std::uint8_t {
    asks,      // up to the end of the request
    answers,   // the connection ends behind it
    upgrades,  // to WebSocket
    watches,
  };

  boost::asio::ip::tcp::socket& socket() noexcept { return stream_.next_layer(); }
  void receive();
  void received(const boost::system::error_code& error, std::size_t count);
  [[nodiscard]] bool receive_head();
  void handle_request(WebAnswer result);
  void log_in(std::string_view form);
  void answer(const WebAnswer& answer);
  void drain();
  void upgrade();
  void listen();
  void handle(ClientMessage wish);
  void reply(std::string event);
  [[nodiscard]] link::Hold hold() const noexcept;

  static constexpr int most_drained = 64;

  Parts& parts_;
  boost::beast::websocket::stream<WebClientSocket> stream_;
  SendQueue outbox_;
  WebUser user_;
  link::InternetAddress address_;
  std::optional<WebRequest> request_;
  std::size_t head_size_ = 0;            // 0: it is not there yet
  std::shared_ptr<WebSession> session_;  // of the user who has logged in
  State state_ = State::asks;
  std::array<char, 2048> buffer_{};
  std::string input_;
  std::string output_;
  boost::beast::flat_buffer message_;
  bool is_sending_ = false;
  bool wants_messages_ = false;
  std::vector<std::string> views_;
  int drained_ = 0;
  bool logs_in_ = false;
  bool knows_key_ = false;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point received_at_{};
};

}  // namespace canopus::web
