#include "canopus/serve/web/web_server.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <fmt/format.h>

#include "canopus/link/tcp_port.hpp"
#include "canopus/serve/connection_timer.hpp"
#include "canopus/serve/web/web_outbox.hpp"
#include "canopus/serve/web/web_request.hpp"
#include "canopus/serve/web/web_wish.hpp"

namespace canopus::serve {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using MonotonicClock = std::chrono::steady_clock;

struct WebServer::Parts : std::enable_shared_from_this<Parts> {
  Parts(asio::io_context& io, link::LoopClock& the_clock, Use the_use, WebServerOptions the_options,
        link::ClientReport the_report)
      : context(io),
        clock(the_clock),
        use(std::move(the_use)),
        options(the_options),
        report(std::move(the_report)),
        port(io),
        timer(io) {}

  void admit(tcp::socket socket);
  void remove(const Connection& connection);
  void watch();
  void show_state();
  void show_messages();
  void show_views();
  void flush();
  void say(const std::string& client, const std::string& what) const {
    if (report) report(client + ' ' + what);
  }

  asio::io_context& context;
  link::LoopClock& clock;
  Use use;
  WebServerOptions options;
  link::ClientReport report;
  link::TcpPort port;
  std::string address;
  std::vector<std::shared_ptr<Connection>> connections;
  std::deque<WebOutbox::Text> latest;  // events, for newcomers
  asio::steady_timer timer;
  bool is_watched = false;       // the timer runs
  bool is_viewed = false;        // somebody looks at more than the state
  std::size_t first_viewer = 0;  // whose turn it is, of the connections
  bool is_open = false;
};

/// One client: a request and its answer, or a request and then a WebSocket. Handlers hold it; it forgets the server when
/// the server is gone.
class WebServer::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Parts& parts, tcp::socket socket)
      : parts_(&parts),
        stream_(std::move(socket)),
        name_(link::name_of_peer(stream_.next_layer())),
        timer_(parts.context),
        outbox_(parts.options.most_events, parts.use.lost) {}

  void start() {
    error_code ignored;
    socket().set_option(tcp::no_delay(true), ignored);
    set_timer(parts_->options.head_timeout, "left a request incomplete");
    receive();
  }

  [[nodiscard]] bool watches() const noexcept { return state_ == State::watches; }
  [[nodiscard]] bool wants_messages() const noexcept { return watches() && wants_messages_; }

  void add_event(const WebOutbox::Text& event) { outbox_.add_event(event); }
  void set_state(const WebOutbox::Text& state) { outbox_.set_state(state); }
  void set_messages(const WebOutbox::Text& messages) { outbox_.set_messages(messages); }
  [[nodiscard]] const std::vector<std::string>& views() const noexcept { return views_; }
  void set_view(std::size_t number, const WebOutbox::Text& view) { outbox_.set_view(number, view); }

  /// Sends what waits, when nothing is under way.
  void send() {
    if (state_ != State::watches || is_sending_ || outbox_.empty()) return;
    is_sending_ = true;
    output_ = outbox_.take();
    set_timer(parts_->options.send_timeout, "does not take what it is sent");
    stream_.async_write(asio::buffer(output_), [self = shared_from_this()](error_code error, std::size_t) {
      if (self->parts_ == nullptr) return;
      self->is_sending_ = false;
      if (error) return self->end();
      self->timer_.stop();
      self->send();
    });
  }

  /// Beast waits without end for a client that it has closed to close its side, too.
  void look_for_end(MonotonicClock::time_point now) {
    if (state_ == State::watches && now - heard_at_ > parts_->options.silent_timeout) end();
  }

  void close() noexcept {
    parts_ = nullptr;
    error_code ignored;
    socket().shutdown(tcp::socket::shutdown_both, ignored);
    socket().close(ignored);
    timer_.stop();
  }

 private:
  enum class State : std::uint8_t {
    asks,      // up to the end of the request's head
    answers,   // the connection ends behind it
    upgrades,  // to WebSocket
    watches,
  };

  tcp::socket& socket() noexcept { return stream_.next_layer(); }

  void receive() {
    socket().async_read_some(asio::buffer(buffer_),
                             [self = shared_from_this()](error_code error, std::size_t count) {
                               if (self->parts_ != nullptr) self->received(error, count);
                             });
  }

  void received(const error_code& error, std::size_t count) {
    if (error) return end();
    input_.append(buffer_.data(), count);
    const std::size_t length = end_of_head(input_);
    if (length == 0 && input_.size() <= longest_web_head) return receive();
    const auto request =
        read_head(length == 0 ? std::string_view(input_) : std::string_view(input_).substr(0, length));
    if (!request) return answer(request.error());
    if (length != input_.size()) return answer({.status = 400, .body = "a request has no body here\n"});
    const WebAnswer result = answer_to(*request, parts_->address, parts_->port.port());
    if (result.status != 101) return answer(result);
    upgrade(*request);
  }

  void answer(const WebAnswer& answer) {
    state_ = State::answers;
    output_ = written(answer);
    set_timer(parts_->options.send_timeout, "does not take its answer");
    asio::async_write(socket(), asio::buffer(output_), [self = shared_from_this()](error_code, std::size_t) {
      if (self->parts_ == nullptr) return;
      error_code ignored;
      self->socket().shutdown(tcp::socket::shutdown_send, ignored);
      self->drain();
    });
  }

  /// Waits for the client's end: a socket that is closed with bytes unread would take the answer back.
  void drain() {
    socket().async_read_some(asio::buffer(buffer_),
                             [self = shared_from_this()](error_code error, std::size_t) {
                               if (self->parts_ == nullptr) return;
                               if (error || ++self->drained_ > most_drained) return self->end();
                               self->drain();
                             });
  }

  void upgrade(const WebRequest& request) {
    state_ = State::upgrades;
    stream_.set_option(websocket::stream_base::timeout{.handshake_timeout = parts_->options.head_timeout,
                                                       .idle_timeout = parts_->options.silent_timeout * 2 / 3,
                                                       .keep_alive_pings = true});
    stream_.read_message_max(parts_->options.longest_message);
    stream_.text(true);
    stream_.auto_fragment(false);
    stream_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
      response.set(boost::beast::http::field::server, "canopus");
    }));
    stream_.control_callback(
        [this](websocket::frame_type, boost::beast::string_view) { heard_at_ = MonotonicClock::now(); });
    heard_at_ = MonotonicClock::now();
    stream_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (self->parts_ == nullptr) return;
      if (error) return self->end();
      self->timer_.stop();
      self->state_ = State::watches;
      self->parts_->watch();
      if (self->parts_ == nullptr) return;  // the run ended on the way there
      for (const WebOutbox::Text& latest : self->parts_->latest) self->outbox_.add_event(latest);
      self->listen();
      self->parts_->show_state();
    });
  }

  void listen() {
    stream_.async_read(message_, [self = shared_from_this()](error_code error, std::size_t) {
      if (self->parts_ == nullptr) return;
      if (error == websocket::error::message_too_big) return self->end("sent a message that is too long");
      if (error) return self->end();
      const auto bytes = self->message_.cdata();
      auto wish = read_wish({static_cast<const char*>(bytes.data()), bytes.size()});
      if (wish && wish->messages) self->wants_messages_ = *wish->messages;
      if (wish && wish->views) self->views_ = std::move(*wish->views);
      self->message_.clear();
      const auto now = MonotonicClock::now();
      self->heard_at_ = now;
      if (now - self->second_began_ > std::chrono::seconds(1)) {
        self->second_began_ = now;
        self->messages_ = 0;
      }
      if (++self->messages_ > self->parts_->options.most_messages) return self->end("sends too much");
      self->listen();
    });
  }

  void set_timer(std::chrono::milliseconds timeout, const char* reason) {
    timer_.set(timeout, [self = shared_from_this(), reason] {
      if (self->parts_ != nullptr) self->end(self->state_ == State::answers ? nullptr : reason);
    });
  }

  /// `reason`: what the client did, when it was not its client that ended the connection.
  void end(const char* reason = nullptr) {
    const auto self = shared_from_this();
    Parts& parts = *parts_;
    if (reason != nullptr) parts.say(name_, std::string(reason) + ": its connection is closed");
    close();
    parts.remove(*this);
  }

  static constexpr int most_drained = 64;

  Parts* parts_;
  websocket::stream<tcp::socket> stream_;
  std::string name_;
  ConnectionTimer timer_;
  WebOutbox outbox_;
  State state_ = State::asks;
  std::array<char, 2048> buffer_{};
  std::string input_;
  std::string output_;
  boost::beast::flat_buffer message_;
  bool is_sending_ = false;
  bool wants_messages_ = false;
  std::vector<std::string> views_;
  int drained_ = 0;
  unsigned messages_ = 0;
  MonotonicClock::time_point heard_at_{};
  MonotonicClock::time_point second_began_ = MonotonicClock::now();
};

void WebServer::Parts::admit(tcp::socket socket) {
  const std::string name = link::name_of_peer(socket);
  if (!link::is_allowed(socket, link::AllowList())) return say(name, "is not allowed to connect");
  if (connections.size() >= options.maximum_clients) {
    return say(name, fmt::format("was refused: all {} connections are in use", options.maximum_clients));
  }
  const auto connection = std::make_shared<Connection>(*this, std::move(socket));
  connections.push_back(connection);
  connection->start();
}

void WebServer::Parts::remove(const Connection& connection) {
  std::erase_if(connections, [&](const auto& other) { return other.get() == &connection; });
}

/// States are made as long as somebody watches.
void WebServer::Parts::watch() {
  if (std::exchange(is_watched, true)) return;
  timer.expires_after(options.state_interval);
  timer.async_wait([self = shared_from_this()](const error_code& error) {
    if (error || !self->is_open) return;
    self->is_watched = false;
    const auto watchers = self->connections;
    for (const auto& one : watchers) one->look_for_end(MonotonicClock::now());
    if (std::ranges::none_of(self->connections, [](const auto& one) { return one->watches(); })) {
      if (self->use.messages) (void)self->use.messages(false);
      self->show_views();
      return;
    }
    self->watch();
    self->show_state();
  });
}

/// One text for all.
void WebServer::Parts::show_state() {
  (void)clock.now();
  if (!is_open) return;  // the run ended on the way there
  const auto text = std::make_shared<const std::string>(use.state());
  for (const auto& connection : connections) {
    if (connection->watches()) connection->set_state(text);
  }
  show_messages();
  show_views();
  flush();
}

void WebServer::Parts::show_messages() {
  if (!use.messages) return;
  const auto wants = [](const auto& one) { return one->wants_messages(); };
  std::string event = use.messages(std::ranges::any_of(connections, wants));
  if (event.empty()) return;
  const auto text = std::make_shared<const std::string>(std::move(event));
  for (const auto& connection : connections) {
    if (wants(connection)) connection->set_messages(text);
  }
}

/// What several look at is made once, and of all that they look at not so much at a time that it would delay the plant.
void WebServer::Parts::show_views() {
  if (!use.view) return;
  std::map<std::string_view, WebOutbox::Text> made;
  for (std::size_t turn = 0; turn < connections.size(); ++turn) {
    if (made.size() >= options.most_views) break;
    const auto& connection = connections[++first_viewer % connections.size()];
    if (!connection->watches()) continue;
    for (std::size_t i = 0; i < connection->views().size(); ++i) {
      const std::string& view = connection->views()[i];
      const auto [text, is_new] = made.try_emplace(view);
      if (is_new) text->second = std::make_shared<const std::string>(use.view(view));
      if (!text->second->empty()) connection->set_view(i, text->second);
    }
  }
  if (made.empty() && is_viewed) (void)use.view({});
  is_viewed = !made.empty();
}

void WebServer::Parts::flush() {
  const auto watchers = connections;  // a write may end its connection
  for (const auto& connection : watchers) connection->send();
}

WebServer::WebServer(asio::io_context& context, link::LoopClock& clock, Use use, WebServerOptions options,
                     link::ClientReport report)
    : parts_(std::make_shared<Parts>(context, clock, std::move(use), options, std::move(report))) {}

WebServer::~WebServer() { stop(); }

std::expected<void, std::string> WebServer::listen(const std::string& host, std::uint16_t port) {
  const std::string address = host == "localhost" ? "127.0.0.1" : host;
  const auto parsed = link::parse_internet_address(address);
  if (!parsed || !link::is_loopback(*parsed)) {
    return std::unexpected(
        fmt::format("{}: the page is for this machine alone; expected 127.0.0.1 or ::1 (from "
                    "another machine: ssh -L)",
                    host));
  }
  parts_->address = address;
  auto result =
      parts_->port.listen(address, port,
                          {.admit = [parts = parts_](tcp::socket socket) { parts->admit(std::move(socket)); },
                           .refuse =
                               [parts = parts_](tcp::socket& socket) {
                                 parts->say(link::name_of_peer(socket), link::TcpPort::no_descriptor_left);
                               }});
  parts_->is_open = result.has_value();
  return result;
}

std::string WebServer::url() const {
  const std::string& address = parts_->address;
  return address.find(':') == std::string::npos ? fmt::format("http://{}:{}/", address, port())
                                                : fmt::format("http://[{}]:{}/", address, port());
}

std::uint16_t WebServer::port() const noexcept { return parts_->port.port(); }

std::size_t WebServer::clients() const noexcept { return parts_->connections.size(); }

/// Goes out with the next state: nothing is written inside of the timeline, and a thousand events are one message.
void WebServer::event(std::string_view json) {
  const auto text = std::make_shared<const std::string>(json);
  parts_->latest.push_back(text);
  if (parts_->latest.size() > parts_->options.most_events) parts_->latest.pop_front();
  for (const auto& connection : parts_->connections) {
    if (connection->watches()) connection->add_event(text);
  }
}

void WebServer::stop() noexcept {
  parts_->is_open = false;
  parts_->port.close();
  error_code ignored;
  parts_->timer.cancel(ignored);
  for (const auto& connection : parts_->connections) connection->close();
  parts_->connections.clear();
}

}  // namespace canopus::serve
