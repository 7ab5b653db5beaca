#include "canopus/client/gateway/gateway_server.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

#include "canopus/client/gateway/gateway_session.hpp"

namespace canopus::client {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::string_view refused_line = "ERROR:102 #connection refused\r\n";

}  // namespace

class GatewayServer::Client final : public link::TcpClient<Client>, private GatewaySession::Peer {
 public:
  Client(GatewayServer& server, link::TcpPort::Socket socket)
      : TcpClient(server.clients_, link::name_of_peer(socket)), server_(server), socket_(std::move(socket)) {
    session_.emplace(server.gateway_, static_cast<GatewaySession::Peer&>(*this));
    server.alarm().add_part(session_->alarm());
  }

  /// While a command is under way, too: whether the client is still there is known by reading alone.
  void read() {
    if (reading_ || said_all_ || !session_ || !has_room()) return;
    reading_ = true;
    socket_.async_read_some(asio::buffer(input_),
                            [self = shared_from_this()](const error_code& failure, std::size_t size) {
                              self->reading_ = false;
                              if (self->is_closed()) return;
                              if (failure == asio::error::eof) return self->end_of_input();
                              if (failure) return self->end();
                              self->session_->receive({self->input_.data(), size}, self->server_.clock_());
                              // It may have ended what others waited for.
                              if (!self->is_closed()) self->server_.read_next();
                            });
  }
  /// After anything that may have ended a command.
  void read_next() {
    if (is_closed()) return;
    if (too_slow_) {
      report("takes nothing; its connection ends");
      return end();
    }
    if (said_all_ && !writing_ && !session_->waiting()) return end();
    read();
  }
  void tick(can::Time now) {
    if (is_closed()) return;
    session_->tick(now);
    read_next();
  }
  void close() {
    if (session_) session_->end(server_.clock_());
    session_.reset();
    close_socket(socket_);
  }

 private:
  void send_line(std::string_view line) override {
    if (too_slow_ || is_closed()) return;
    if (waiting_.size() + line.size() > server_.options_.most_waiting) {
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
                        if (self->is_closed()) return;
                        if (failure) return self->end();
                        self->write();
                        if (self->is_full() || self->session_->buffered() == 0) return self->read_next();
                        self->session_->resume(self->server_.clock_());
                        self->server_.read_next();
                      });
  }
  [[nodiscard]] bool is_full() const override {
    return !is_closed() && waiting_.size() > server_.options_.enough_waiting;
  }
  /// A line that waits has an end, and a line without an end is not longer than the session has it.
  [[nodiscard]] bool has_room() const {
    const bool waits = session_->waiting() || is_full();
    return !waits || session_->buffered() < input_.size();
  }
  /// The client may still listen.
  void end_of_input() {
    said_all_ = true;
    set_timer(server_.options_.patience, nullptr);
    read_next();
  }

  GatewayServer& server_;
  link::TcpPort::Socket socket_;
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
      clients_(io, {.allowed = options_.allowed, .most = options_.clients}, std::move(report)) {
  alarm().add_part(gateway_.alarm());
}

GatewayServer::~GatewayServer() { clients_.close(); }

std::expected<void, std::string> GatewayServer::listen(const std::string& host, std::uint16_t port) {
  return clients_.listen(
      host, port, [this](link::TcpPort::Socket socket) { admit(std::move(socket)); }, refused_line);
}

void GatewayServer::admit(link::TcpPort::Socket socket) {
  error_code ignored;
  socket.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  if (!clients_.may_connect(socket, refused_line)) return;
  if (clients_.is_full()) return clients_.refuse(socket, "was refused: too many clients", refused_line);
  clients_.add(std::make_shared<Client>(*this, std::move(socket)))->read();
}

void GatewayServer::read_next() {
  const auto clients = clients_.all();
  for (const auto& client : clients) client->read_next();
}

void GatewayServer::receive(const can::Frame& frame, can::Time now) {
  gateway_.receive(frame, now);
  read_next();
}

void GatewayServer::tick(can::Time now) {
  if (gateway_.deadline() <= now) gateway_.tick(now);
  const auto clients = clients_.all();
  for (const auto& client : clients) client->tick(now);
}

}  // namespace canopus::client
