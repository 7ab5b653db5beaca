#include "canopus/link/socketcand_server.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include "canopus/link/socketcand_session.hpp"

namespace canopus::link {
namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// What the server and the handlers under way have in common.
struct SocketcandServer::Shared : std::enable_shared_from_this<Shared> {
  Shared(asio::io_context& context, tcp::endpoint local, std::string name, AttachToBus attach_to_bus,
         LoopClock& loop, SocketcandLimits given)
      : io(context),
        endpoint(std::move(local)),
        bus_name(std::move(name)),
        attach(std::move(attach_to_bus)),
        clock(loop),
        limits(given),
        acceptor(context),
        pause(context) {}

  void accept();
  void admit(tcp::socket socket);
  static void refuse(tcp::socket& socket);
  void remove(const Client* client);

  asio::io_context& io;
  tcp::endpoint endpoint;
  std::string bus_name;
  AttachToBus attach;
  LoopClock& clock;
  SocketcandLimits limits;
  tcp::acceptor acceptor;
  asio::steady_timer pause;
  std::vector<std::shared_ptr<Client>> clients;
  SocketcandStatistics statistics;
};

/// One connection: a socket on one side, a place on the bus on the other, a session between them.
///
/// Bus callbacks only queue messages and start socket operations; what takes the client off the bus happens
/// in handlers of the io_context, never inside the bus.
class SocketcandServer::Client final : public std::enable_shared_from_this<Client>,
                                       public can::Participant,
                                       private can::Sink,
                                       private SocketcandSession::Peer {
 public:
  Client(Shared& server, tcp::socket socket)
      : server_(&server),
        socket_(std::move(socket)),
        session_(server.bus_name, *this, *this),
        queue_(std::max(server.limits.queue, 2 * reserved_for_answers)) {}

  [[nodiscard]] bool attach() {
    attachment_ = server_->attach(*this);
    return attachment_ != nullptr;
  }

  [[nodiscard]] tcp::socket& socket() { return socket_; }

  void start() {
    session_.start();
    read();
  }

  /// Ends the connection and leaves the bus at once.
  void leave() {
    if (server_ == nullptr) return;
    error_code ignored;
    socket_.close(ignored);
    attachment_.reset();
    Shared& server = *std::exchange(server_, nullptr);
    server.remove(this);
  }

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& /*frame*/, can::Time now) override {
    if (on_the_way_ > 0) --on_the_way_;
    bus_has_room(now);
  }
  void controller_changed(can::Time now) override { bus_has_room(now); }
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override { return std::min(hold_until_, close_at_); }

 private:
  /// Queued text. Frames can be lost to a full queue and be held back; answers cannot.
  struct Message {
    std::array<char, socketcand_max_message> text;
    std::uint8_t length = 0;
    bool frame = false;
  };
  /// Bytes read at a time. An element of 3 characters has an answer, so they make less than
  /// most_answers messages, what the session kept of the last ones included.
  static constexpr std::size_t read_size = 1024;
  static constexpr std::size_t most_answers = (read_size + socketcand_max_element) / 3 + 1;
  /// Slots that frames leave free, so that answers always find one; input is only read while most_answers of
  /// them are free, so a client that asks and never reads is slowed down by TCP.
  static constexpr std::size_t reserved_for_answers = 512;
  static_assert(most_answers < reserved_for_answers);

  // can::Sink, for the session
  bool send(const can::Frame& frame) override;
  // SocketcandSession::Peer
  void message(std::string_view text) override;

  void read();
  void on_read(const error_code& failure, std::size_t size);
  void on_written(const error_code& failure);
  void write_next();
  Message* claim_slot(std::size_t reserve);
  void report_lost();
  void bus_has_room(can::Time now);
  void after_input(SocketcandSession::State before, can::Time now);
  void end_soon();
  void leave_later();
  [[nodiscard]] bool ending() const {
    return ending_ || session_.state() == SocketcandSession::State::closed;
  }

  Shared* server_;  // null once the client has left
  tcp::socket socket_;
  SocketcandSession session_;
  std::unique_ptr<BusAttachment> attachment_;
  std::array<char, read_size> input_;
  std::vector<Message> queue_;  // ring
  std::size_t front_ = 0;
  std::size_t queued_ = 0;
  bool writing_ = false;
  bool reading_ = false;
  bool ending_ = false;                // closed by the client, or about to leave
  std::uint64_t lost_ = 0;             // frames since there was room last
  std::uint32_t on_the_way_ = 0;       // frames given to the bus and not yet transmitted
  can::Time hold_until_ = can::never;  // frames wait for this moment when it is not never
  can::Time close_at_ = can::never;    // when to close whatever is still unsent
};

void SocketcandServer::Client::read() {
  if (reading_ || server_ == nullptr || session_.waiting() || ending_) return;
  if (queue_.size() - queued_ < most_answers) return;
  reading_ = true;
  socket_.async_read_some(asio::buffer(input_),
                          [self = shared_from_this()](const error_code& failure, std::size_t size) {
                            self->on_read(failure, size);
                          });
}

void SocketcandServer::Client::on_read(const error_code& failure, std::size_t size) {
  if (server_ == nullptr) return;
  const can::Time now = server_->clock.now();
  reading_ = false;
  const auto before = session_.state();
  if (failure) {
    ending_ = true;  // it has closed: nothing to answer, but its last frames are still to go out
    queued_ = std::min<std::size_t>(queued_, writing_ ? 1 : 0);
    if (on_the_way_ == 0 || failure != asio::error::eof) return leave();
  } else {
    session_.receive({input_.data(), size});
  }
  after_input(before, now);
  attachment_->refresh();
  server_->clock.touched();
}

/// What the session made of its input decides what the connection does next.
void SocketcandServer::Client::after_input(SocketcandSession::State before, can::Time now) {
  using State = SocketcandSession::State;
  if (before != State::raw && session_.state() == State::raw) {
    hold_until_ = can::later(now, server_->limits.settle);
  }
  if (ending()) {
    if (close_at_ == can::never) close_at_ = can::later(now, server_->limits.linger);
    end_soon();
  }
  read();
}

void SocketcandServer::Client::receive(const can::Frame& frame, can::Time now) {
  // Remote frames are not passed on: the protocol's raw mode has no word for them that clients know.
  if (server_ == nullptr || ending() || session_.state() != SocketcandSession::State::raw || frame.remote) {
    return;
  }
  report_lost();
  Message* slot = lost_ == 0 ? claim_slot(reserved_for_answers) : nullptr;
  if (slot == nullptr) {
    ++server_->statistics.frames_lost;
    if (++lost_ == server_->limits.lost_frames) {
      ++server_->statistics.clients_too_slow;
      leave_later();
    }
    return;
  }
  ++server_->statistics.frames_to_clients;
  slot->length = static_cast<std::uint8_t>(write_socketcand_frame(slot->text, frame, now));
  slot->frame = true;
  write_next();
}

void SocketcandServer::Client::tick(can::Time now) {
  if (now >= close_at_) {
    close_at_ = can::never;
    leave_later();
  }
  if (now >= hold_until_) {
    hold_until_ = can::never;
    write_next();
  }
}

bool SocketcandServer::Client::send(const can::Frame& frame) {
  if (attachment_ == nullptr || !attachment_->send(frame)) return false;
  ++on_the_way_;
  ++server_->statistics.frames_from_clients;
  return true;
}

void SocketcandServer::Client::bus_has_room(can::Time now) {
  if (server_ == nullptr) return;
  const auto before = session_.state();
  session_.resume();
  after_input(before, now);
}

/// The next free slot of the queue, if `reserve` more would still be free.
SocketcandServer::Client::Message* SocketcandServer::Client::claim_slot(std::size_t reserve) {
  if (queued_ + reserve >= queue_.size()) return nullptr;
  return &queue_[(front_ + queued_++) % queue_.size()];
}

/// Tells a client that was too slow what it missed, once it has read half of what waits for it.
void SocketcandServer::Client::report_lost() {
  if (lost_ == 0 || queued_ > queue_.size() / 2) return;
  const std::string text = "< error lost " + std::to_string(lost_) + " frames, read faster >";
  lost_ = 0;
  message(text);
}

void SocketcandServer::Client::message(std::string_view text) {
  Message* slot = claim_slot(0);
  if (slot == nullptr) return leave_later();  // cannot be, see reserved_for_answers
  text = text.substr(0, slot->text.size());
  std::ranges::copy(text, slot->text.begin());
  slot->length = static_cast<std::uint8_t>(text.size());
  slot->frame = false;
  write_next();
}

/// Writes the oldest message, alone: one message, one segment.
void SocketcandServer::Client::write_next() {
  if (writing_ || queued_ == 0 || server_ == nullptr) return;
  const Message& next = queue_[front_];
  if (next.frame && hold_until_ != can::never) return;
  writing_ = true;
  asio::async_write(socket_, asio::buffer(next.text.data(), next.length),
                    [self = shared_from_this()](const error_code& failure, std::size_t) {
                      self->writing_ = false;
                      self->on_written(failure);
                    });
}

void SocketcandServer::Client::on_written(const error_code& failure) {
  if (server_ == nullptr) return;
  if (failure) return leave();
  front_ = (front_ + 1) % queue_.size();
  --queued_;
  write_next();
  read();
  if (ending()) end_soon();
}

/// Once everything is out that was to go out: leaves when the client has closed, else tells it that nothing
/// more comes and reads on until it closes too. Closing over unread input would take back the last message.
void SocketcandServer::Client::end_soon() {
  if (queued_ > 0 || on_the_way_ > 0) return;
  if (ending_) return leave_later();
  error_code ignored;
  socket_.shutdown(tcp::socket::shutdown_send, ignored);
}

void SocketcandServer::Client::leave_later() {
  ending_ = true;
  asio::post(server_->io, [self = shared_from_this()] { self->leave(); });
}

void SocketcandServer::Shared::accept() {
  acceptor.async_accept([self = shared_from_this()](const error_code& failure, tcp::socket socket) {
    if (!self->acceptor.is_open()) return;
    if (!failure) {
      self->admit(std::move(socket));
      return self->accept();
    }
    // Most likely no file descriptor is left: trying again at once would only burn the processor.
    self->pause.expires_after(std::chrono::milliseconds(100));
    self->pause.async_wait([self](const error_code&) {
      if (self->acceptor.is_open()) self->accept();
    });
  });
}

void SocketcandServer::Shared::admit(tcp::socket socket) {
  ++statistics.connections;
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  // Frames that wait in the kernel are as late as those in the queue, but are not counted.
  socket.set_option(asio::socket_base::send_buffer_size(64 * 1024), ignored);
  if (clients.size() >= limits.clients) return refuse(socket);
  const auto client = std::make_shared<Client>(*this, std::move(socket));
  if (!client->attach()) return refuse(client->socket());
  clients.push_back(client);
  client->start();
}

void SocketcandServer::Shared::refuse(tcp::socket& socket) {
  constexpr std::string_view text = "< error too many clients >";
  error_code ignored;
  socket.write_some(asio::buffer(text), ignored);
  socket.close(ignored);
}

void SocketcandServer::Shared::remove(const Client* client) {
  std::erase_if(clients, [client](const auto& entry) { return entry.get() == client; });
}

SocketcandServer::SocketcandServer(asio::io_context& io, const tcp::endpoint& endpoint, std::string bus_name,
                                   AttachToBus attach, LoopClock& clock, SocketcandLimits limits)
    : shared_(std::make_shared<Shared>(io, endpoint, std::move(bus_name), std::move(attach), clock, limits)) {
}

SocketcandServer::~SocketcandServer() { close(); }

std::expected<void, std::string> SocketcandServer::listen() {
  tcp::acceptor& acceptor = shared_->acceptor;
  error_code failure;
  acceptor.open(shared_->endpoint.protocol(), failure);
  if (!failure) acceptor.set_option(tcp::acceptor::reuse_address(true), failure);
  if (!failure) acceptor.bind(shared_->endpoint, failure);
  if (!failure) acceptor.listen(tcp::acceptor::max_listen_connections, failure);
  if (failure) {
    error_code ignored;
    acceptor.close(ignored);
    return std::unexpected("cannot listen on " + shared_->endpoint.address().to_string() + ':' +
                           std::to_string(shared_->endpoint.port()) + ": " + failure.message());
  }
  shared_->accept();
  return {};
}

std::uint16_t SocketcandServer::port() const noexcept {
  error_code failure;
  const auto local = shared_->acceptor.local_endpoint(failure);
  return failure ? std::uint16_t{0} : local.port();
}

SocketcandStatistics SocketcandServer::statistics() const noexcept {
  SocketcandStatistics statistics = shared_->statistics;
  statistics.clients = shared_->clients.size();
  return statistics;
}

void SocketcandServer::close() {
  error_code ignored;
  shared_->acceptor.close(ignored);
  shared_->pause.cancel();
  const auto clients = shared_->clients;  // leave() takes each off the list
  for (const auto& client : clients) client->leave();
}

}  // namespace canopus::link
