#include "canopus/web/server/connection.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

#include "canopus/web/access/secret.hpp"
#include "canopus/web/server/server_parts.hpp"

namespace canopus::web {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using WebTime = std::chrono::steady_clock;

namespace {

/// "/events?key=0123..."; an empty key is no secret.
bool holds_key(std::string_view target, std::string_view key) {
  if (key.empty()) return true;
  constexpr std::string_view field = "?key=";
  const std::size_t begin = target.find(field);
  return begin != std::string_view::npos && is_same_secret(target.substr(begin + field.size()), key);
}

}  // namespace

WebServer::Connection::Connection(Parts& parts, tcp::socket socket, std::string name)
    : TcpClient(parts.clients, std::move(name)),
      parts_(parts),
      stream_(WebClientSocket(std::move(socket))),
      outbox_(parts.options.most_events, parts.use.lost),
      user_{.address = this->name()},
      address_(link::address_of_peer(stream_.next_layer())) {}

void WebServer::Connection::start() {
  error_code ignored;
  socket().set_option(tcp::no_delay(true), ignored);
  // Browsers open connections in reserve: one that nothing comes on is closed, and that is no error.
  set_timer(parts_.options.head_timeout, nullptr);
  receive();
}

/// A connection with a key or a session stays; of the others those first that only ask.
link::Hold WebServer::Connection::hold() const noexcept {
  if (state_ == State::watches) return session_ || knows_key_ ? link::Hold::firm : link::Hold::weak;
  return session_ || knows_key_ || logs_in_ ? link::Hold::weak : link::Hold::none;
}

void WebServer::Connection::send() {
  if (is_closed() || state_ != State::watches || is_sending_ || outbox_.empty()) return;
  is_sending_ = true;
  output_ = outbox_.pop_all();
  set_timer(parts_.options.send_timeout, "does not take what it is sent");
  stream_.async_write(asio::buffer(output_), [self = shared_from_this()](error_code error, std::size_t) {
    if (self->is_closed()) return;
    self->is_sending_ = false;
    if (error) return self->end();
    self->stop_timer();
    self->send();
  });
}

void WebServer::Connection::end_if_over(WebTime::time_point now) {
  if (state_ != State::watches) return;
  if (now - received_at_ > parts_.options.silent_timeout || (session_ && session_->is_over)) end();
}

void WebServer::Connection::close() noexcept { close_socket(socket()); }

void WebServer::Connection::receive() {
  socket().async_read_some(asio::buffer(buffer_),
                           [self = shared_from_this()](error_code error, std::size_t count) {
                             if (!self->is_closed()) self->received(error, count);
                           });
}

void WebServer::Connection::received(const error_code& error, std::size_t count) {
  if (error) return end();
  if (input_.empty()) {
    const auto rest =
        std::chrono::ceil<std::chrono::milliseconds>(began_ + parts_.options.head_timeout - WebTime::now());
    set_timer(std::max(rest, std::chrono::milliseconds(0)), "left a request incomplete");
  }
  input_.append(buffer_.data(), count);
  if (head_size_ == 0 && !receive_head()) return;
  const std::size_t length = head_size_ + body_length(*request_);
  if (input_.size() > length) return answer({.status = 400, .body = "a request has no body here\n"});
  WebAnswer result = answer_to(*request_, parts_.place);
  const bool wants_body = result.next == WebNext::log_in || result.next == WebNext::log_out;
  if (wants_body && input_.size() < length) return receive();
  handle_request(std::move(result));
}

/// False: it is not there yet, or refused.
bool WebServer::Connection::receive_head() {
  head_size_ = end_of_head(input_);
  if (head_size_ == 0 && input_.size() <= longest_web_head) {
    receive();
    return false;
  }
  if (const auto refusal = parts_.gate->refusal(address_, WebTime::now())) {
    answer(*refusal);
    return false;
  }
  auto request =
      read_head(head_size_ == 0 ? std::string_view(input_) : std::string_view(input_).substr(0, head_size_));
  if (!request) {
    answer(request.error());
    return false;
  }
  request_ = std::move(*request);
  return true;
}

/// A whole request.
void WebServer::Connection::handle_request(WebAnswer result) {
  const std::string_view form = std::string_view(input_).substr(head_size_);
  session_ = parts_.gate->session_of(*request_, parts_.place, WebTime::now());
  switch (result.next) {
    case WebNext::log_in: return log_in(form);
    case WebNext::log_out: {
      const Authenticator::Client client{.address = address_, .name = name()};
      return answer(parts_.gate->log_out(form, session_.get(), client, parts_.place));
    }
    case WebNext::session: {
      const bool has_body = result.has_body;
      result = Authenticator::described(session_.get());
      result.has_body = has_body;
      return answer(result);
    }
    case WebNext::page:
      if (session_ == nullptr) {
        return answer({.status = 303,
                       .body = "log in first\n",
                       .has_body = result.has_body,
                       .fields = "Location: /login\r\n"});
      }
      break;
    case WebNext::send: break;
  }
  if (result.status != 101) return answer(result);
  if (parts_.place.has_users && session_ == nullptr) return answer({.status = 401, .body = "log in first\n"});
  upgrade();
}

void WebServer::Connection::log_in(std::string_view form) {
  state_ = State::answers;
  logs_in_ = true;
  set_timer(parts_.options.send_timeout, nullptr);
  parts_.gate->log_in(form, {.address = address_, .name = name()}, parts_.place, WebTime::now(),
                      [client = weak_from_this()](const WebAnswer& result) {
                        const auto self = client.lock();
                        if (self && !self->is_closed()) self->answer(result);
                      });
}

void WebServer::Connection::answer(const WebAnswer& answer) {
  state_ = State::answers;
  logs_in_ = false;
  output_ = written(answer);
  const bool has_file = answer.file && answer.has_body;
  const std::array<asio::const_buffer, 2> bytes{asio::buffer(output_),
                                                has_file ? asio::buffer(*answer.file) : asio::const_buffer()};
  set_timer(parts_.options.send_timeout, nullptr);
  asio::async_write(socket(), bytes,
                    [self = shared_from_this(), file = answer.file](error_code, std::size_t) {
                      if (self->is_closed()) return;
                      error_code ignored;
                      self->socket().shutdown(tcp::socket::shutdown_send, ignored);
                      self->drain();
                    });
}

/// Waits for the client's end: a socket that is closed with bytes unread would take the answer back.
void WebServer::Connection::drain() {
  socket().async_read_some(asio::buffer(buffer_), [self = shared_from_this()](error_code error, std::size_t) {
    if (self->is_closed()) return;
    if (error || ++self->drained_ > most_drained) return self->end();
    self->drain();
  });
}

void WebServer::Connection::upgrade() {
  const WebServerOptions& options = parts_.options;
  const std::string_view target(request_->target().data(), request_->target().size());
  if (session_) user_.name = session_->user.name;
  knows_key_ = holds_key(target, session_ ? session_->key : options.key);
  if (knows_key_) user_.role = session_ ? session_->user.role : options.role;
  if (!parts_.has_room_for_watcher(*this)) {
    return answer({.status = 503,
                   .body = session_ ? "this user watches too many pages; close one of them\n"
                                    : "too many watch without the key of the page\n"});
  }
  state_ = State::upgrades;
  stream_.next_layer().set_most_frames(options.most_messages);
  stream_.set_option(websocket::stream_base::timeout{.handshake_timeout = options.head_timeout,
                                                     .idle_timeout = options.silent_timeout * 2 / 3,
                                                     .keep_alive_pings = true});
  stream_.read_message_max(user_.role == WebRole::look ? options.longest_message : options.longest_command);
  stream_.text(true);
  stream_.auto_fragment(false);
  stream_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    response.set(boost::beast::http::field::server, "canopus");
  }));
  stream_.control_callback(
      [this](websocket::frame_type, boost::beast::string_view) { received_at_ = WebTime::now(); });
  received_at_ = WebTime::now();
  stream_.async_accept(*request_, [self = shared_from_this()](error_code error) {
    if (self->is_closed()) return;
    if (error) return self->end();
    self->stop_timer();
    (void)self->parts_.clock.now();  // what has happened up to now comes with the latest events
    if (self->is_closed()) return;   // the run ended on the way there
    self->state_ = State::watches;
    self->parts_.watch();
    for (const SendQueue::Text& event : self->parts_.latest) self->outbox_.add_event(event);
    self->listen();
    // The others have theirs, and get the next one in a moment: fifty that come at once are fifty messages, not a thousand.
    self->outbox_.set_state(self->parts_.newest_state());
    self->send();
  });
}

void WebServer::Connection::listen() {
  stream_.async_read(message_, [self = shared_from_this()](error_code error, std::size_t) {
    if (self->is_closed()) return;
    if (error == websocket::error::message_too_big) return self->end("sent a message that is too long");
    if (self->stream_.next_layer().has_sent_too_much()) return self->end("sends too much");
    if (error) return self->end();
    self->received_at_ = WebTime::now();
    const auto bytes = self->message_.cdata();
    if (auto wish = parse_client_message({static_cast<const char*>(bytes.data()), bytes.size()}))
      self->handle(std::move(*wish));
    self->message_.clear();
    self->message_.shrink_to_fit();  // a device file may be 2 MiB
    if (!self->is_closed()) self->listen();
  });
}

void WebServer::Connection::handle(ClientMessage wish) {
  if (session_) session_->used = WebTime::now();
  if (wish.messages) wants_messages_ = *wish.messages;
  if (wish.views) views_ = std::move(*wish.views);
  if (!wish.command || !parts_.use.command) return;
  parts_.use.command(user_, wish.command->text, wish.command->id,
                     [client = weak_from_this()](std::string event) {
                       if (const auto self = client.lock()) self->reply(std::move(event));
                     });
}

void WebServer::Connection::reply(std::string event) {
  if (is_closed()) return;
  parts_.state = nullptr;
  if (user_.role != WebRole::look) stream_.next_layer().discount_frame();
  if (!outbox_.add_reply(std::move(event))) return end("does not take the replies to its commands");
  send();
  if (!is_closed()) parts_.limit_waiting();
}

}  // namespace canopus::web
