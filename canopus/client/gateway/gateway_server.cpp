#include "canopus/client/gateway/gateway_server.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include "canopus/client/gateway/gateway_session.hpp"

namespace canopus::client {

namespace asio = boost::asio;
using boost::system::error_code;

/// Handlers that are under way keep it alive; after close() they do nothing.
class GatewayServer::Client final : public std::enable_shared_from_this<Client>,
                                    private GatewaySession::Peer {
 public:
  Client(GatewayServer& server, link::TcpPort::Socket socket)
      : server_(&server),
        name_(link::name_of_peer(socket)),
        socket_(std::move(socket)),
        patience_(socket_.get_executor()) {
    session_.emplace(server.gateway_, static_cast<GatewaySession::Peer&>(*this));
  }

  /// While a command is under way, too: whether the client is still there is known by reading alone.
  void read() {
    if (reading_ || said_all_ || !session_ || !has_room()) return;
    reading_ = true;
    socket_.async_read_some(asio::buffer(input_),
                            [self = shared_from_this()](const error_code& failure, std::size_t size) {
                              self->reading_ = false;
                              if (self->server_ == nullptr) return;
                              if (failure == asio::error::eof) return self->end_of_input();
                              if (failure) return self->leave({});
                              self->session_->receive({self->input_.data(), size}, self->server_->clock_());
                              // It may have ended what others waited for.
                              if (self->server_ != nullptr) self->server_->go_on();
                            });
  }
  /// After anything that may have ended a command.
  void go_on() {
    if (server_ == nullptr) return;
    if (too_slow_) return leave("takes nothing; its connection ends");
    if (said_all_ && !writing_ && !session_->waiting()) return leave({});
    read();
  }
  void tick(can::Time now) {
    if (server_ == nullptr) return;
    session_->tick(now);
    go_on();
  }
  [[nodiscard]] can::Time deadline() const noexcept { return session_->deadline(); }
  void close() {
    if (session_ && server_ != nullptr) session_->end(server_->clock_());
    session_.reset();
    server_ = nullptr;
    error_code ignored;
    patience_.cancel(ignored);
    socket_.close(ignored);
  }

 private:
  void say(std::string_view line) override {
    if (too_slow_ || server_ == nullptr) return;
    if (waiting_.size() + line.size() > server_->options_.most_waiting) {
      too_slow_ = true;
      return;
    }
    waiting_.append(line);
    write();
  }
  void write() {
    if (writing_ || waiting_.empty()) return;
    writing_ = true;
    std::swap(waiting_, output_);
    waiting_.clear();
    asio::async_write(socket_, asio::buffer(output_),
                      [self = shared_from_this()](const error_code& failure, std::size_t) {
                        self->writing_ = false;
                        if (self->server_ == nullptr) return;
                        if (failure) return self->leave({});
                        self->write();
                        if (self->is_full() || self->session_->buffered() == 0) return self->go_on();
                        self->session_->resume(self->server_->clock_());
                        self->server_->go_on();
                      });
  }
  [[nodiscard]] bool is_full() const override {
    return server_ != nullptr && waiting_.size() > server_->options_.enough_waiting;
  }
  /// A line that waits has an end, and a line without an end is not longer than the session has it.
  [[nodiscard]] bool has_room() const {
    const bool waits = session_->waiting() || is_full();
    return !waits || session_->buffered() < input_.size();
  }
  /// The client may still listen.
  void end_of_input() {
    said_all_ = true;
    patience_.expires_after(server_->options_.patience);
    patience_.async_wait([self = shared_from_this()](const error_code& failure) {
      if (!failure && self->server_ != nullptr) self->leave({});
    });
    go_on();
  }
  void leave(std::string_view why) {
    GatewayServer* server = server_;
    if (!why.empty() && server->report_) server->report_(name_ + ' ' + std::string(why));
    const auto self = shared_from_this();
    close();
    server->remove(this);
  }

  GatewayServer* server_;
  std::string name_;
  link::TcpPort::Socket socket_;
  asio::steady_timer patience_;
  std::optional<GatewaySession> session_;
  std::array<char, 4096> input_;
  std::string waiting_;
  std::string output_;
  bool reading_ = false;
  bool writing_ = false;
  bool too_slow_ = false;
  bool said_all_ = false;
};

GatewayServer::GatewayServer(asio::io_context& io, Gateway& gateway, Clock clock, Options options,
                             link::ClientReport report)
    : gateway_(gateway),
      clock_(std::move(clock)),
      options_(std::move(options)),
      report_(std::move(report)),
      port_(io) {}

GatewayServer::~GatewayServer() {
  port_.close();
  for (const auto& client : clients_) client->close();
}

std::expected<void, std::string> GatewayServer::listen(const std::string& host, std::uint16_t port) {
  return port_.listen(
      host, port,
      {.admit = [this](link::TcpPort::Socket socket) { admit(std::move(socket)); },
       .refuse =
           [this](link::TcpPort::Socket& socket) { refuse(socket, link::TcpPort::no_descriptor_left); }});
}

void GatewayServer::admit(link::TcpPort::Socket socket) {
  error_code ignored;
  socket.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  if (!link::is_allowed(socket, options_.allowed)) return refuse(socket, "is not allowed to connect");
  if (clients_.size() >= options_.clients) return refuse(socket, "was refused: too many clients");
  clients_.push_back(std::make_shared<Client>(*this, std::move(socket)));
  clients_.back()->read();
}

void GatewayServer::refuse(link::TcpPort::Socket& socket, const std::string& why) {
  if (report_) report_(link::name_of_peer(socket) + ' ' + why);
  error_code ignored;
  socket.non_blocking(true, ignored);
  socket.write_some(asio::buffer(std::string_view("ERROR:102 #connection refused\r\n")), ignored);
  socket.close(ignored);
}

void GatewayServer::remove(const Client* client) {
  std::erase_if(clients_, [client](const auto& entry) { return entry.get() == client; });
}

void GatewayServer::go_on() {
  const auto clients = clients_;
  for (const auto& client : clients) client->go_on();
}

void GatewayServer::receive(const can::Frame& frame, can::Time now) {
  gateway_.receive(frame, now);
  go_on();
}

void GatewayServer::tick(can::Time now) {
  if (gateway_.deadline() <= now) gateway_.tick(now);
  const auto clients = clients_;
  for (const auto& client : clients) client->tick(now);
}

can::Time GatewayServer::deadline() const noexcept {
  can::Time first = gateway_.deadline();
  for (const auto& client : clients_) first = std::min(first, client->deadline());
  return first;
}

}  // namespace canopus::client
