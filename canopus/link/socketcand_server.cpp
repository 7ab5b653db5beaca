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
#include <netinet/tcp.h>
#include <poll.h>

#include "canopus/link/can_error.hpp"
#include "canopus/link/socketcand_session.hpp"

namespace canopus::link {
namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// What the server and the handlers under way have in common.
struct SocketcandServer::Shared : std::enable_shared_from_this<Shared> {
  Shared(asio::io_context& context, tcp::endpoint local, std::string name, AttachToBus attach_to_bus,
         LoopClock& loop, SocketcandLimits given, ClientReport to_report)
      : io(context),
        endpoint(std::move(local)),
        bus_name(std::move(name)),
        attach(std::move(attach_to_bus)),
        clock(loop),
        limits(std::move(given)),
        report(std::move(to_report)),
        acceptor(context),
        pause(context) {}

  void accept();
  void admit(tcp::socket socket);
  void refuse(tcp::socket& socket, std::string_view answer, std::string_view why) const;
  void remove(const Client* client);

  asio::io_context& io;
  tcp::endpoint endpoint;
  std::string bus_name;
  AttachToBus attach;
  LoopClock& clock;
  SocketcandLimits limits;
  ClientReport report;
  tcp::acceptor acceptor;
  asio::steady_timer pause;
  std::vector<std::shared_ptr<Client>> clients;
  SocketcandStatistics statistics;
};

namespace {

/// The other side has closed the connection or its end has come, whatever there still is to be read.
bool is_closed_by_peer(tcp::socket& socket) {
  pollfd state{socket.native_handle(), POLLRDHUP, 0};
  return ::poll(&state, 1, 0) > 0 && (state.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

/// Little is to wait in the system between a client and this server: a client that is faster than the bus
/// shall feel it, and what one that left has sent shall not keep the bus busy. Connections inherit both: the
/// window they offer to the client, and the segment size, by which the client's side measures what it
/// gathers. About 80 KiB instead of 4 MiB.
void keep_little(tcp::acceptor& acceptor) {
  constexpr int window = 2 * 1024;
  constexpr int segment = 1400;
  error_code ignored;
  acceptor.set_option(asio::socket_base::receive_buffer_size(window), ignored);
  using MaximumSegment = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_MAXSEG>;
  acceptor.set_option(MaximumSegment(segment), ignored);
}

}  // namespace

/// One connection: a socket on one side, a place on the bus on the other, a session between them.
///
/// Bus callbacks only queue messages and start socket operations; what takes the client off the bus happens
/// in handlers of the io_context, never inside the bus.
class SocketcandServer::Client final : public std::enable_shared_from_this<Client>,
                                       public AttachedClient,
                                       private can::Sink,
                                       private SocketcandSession::Peer {
 public:
  Client(Shared& server, tcp::socket socket)
      : server_(&server),
        socket_(std::move(socket)),
        name_(name_of_peer(socket_)),
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
  void leave();

  // AttachedClient
  void unacknowledged(can::Time now) override;
  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& /*frame*/, can::Time now) override {
    if (on_the_way_ > 0) --on_the_way_;
    progress_at_ = now;
    gave_up_ = false;
    bus_has_room(now);
  }
  void controller_changed(can::Time now) override { bus_has_room(now); }
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override {
    return std::min({hold_until_, close_at_, look_at_});
  }

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
  /// How often a client that is not read, because the bus is full, is looked at.
  static constexpr can::Duration look_interval = std::chrono::milliseconds(20);
  /// What is read at most of the input that a client left behind, to count its frames.
  static constexpr std::size_t most_counted = 256 * 1024;

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
  void client_is_gone(can::Time now);
  void look(can::Time now);
  [[nodiscard]] std::uint64_t drop_input();
  void end_soon();
  void leave_later();
  /// The client hears nothing any more.
  [[nodiscard]] bool ending() const {
    return gone_ || leaving_ || session_.state() == SocketcandSession::State::closed;
  }

  Shared* server_;  // null once the client has left
  tcp::socket socket_;
  std::string name_;
  SocketcandSession session_;
  std::unique_ptr<BusAttachment> attachment_;
  std::array<char, read_size> input_;
  std::vector<Message> queue_;  // ring
  std::size_t front_ = 0;
  std::size_t queued_ = 0;
  bool writing_ = false;
  bool reading_ = false;
  bool gone_ = false;                  // the client has closed; its last frames are still to go out
  bool read_all_ = false;              // to the end of the connection
  bool gave_up_ = false;               // frames are dropped until the bus takes one again
  bool too_slow_ = false;              // read nothing for so long that its connection ends
  bool leaving_ = false;               // leave() is about to come
  std::uint64_t lost_ = 0;             // frames since there was room last
  std::uint32_t on_the_way_ = 0;       // frames given to the bus and not yet transmitted
  can::Time hold_until_ = can::never;  // frames wait for this moment when it is not never
  can::Time close_at_ = can::never;    // when to close whatever is still unsent
  can::Time look_at_ = can::never;     // when to look after a client that waits for the bus
  can::Time progress_at_{};            // when the bus took a frame last, or waiting began
};

void SocketcandServer::Client::read() {
  if (reading_ || server_ == nullptr || session_.waiting() || read_all_ || leaving_) return;
  if (!gone_ && queue_.size() - queued_ < most_answers) return;
  reading_ = true;
  socket_.async_read_some(asio::buffer(input_),
                          [self = shared_from_this()](const error_code& failure, std::size_t size) {
                            self->on_read(failure, size);
                          });
}

void SocketcandServer::Client::on_read(const error_code& failure, std::size_t size) {
  if (server_ == nullptr) return;
  const can::Time now = server_->clock.now();
  if (server_ == nullptr) return;  // the run ended on the way there
  reading_ = false;
  const auto before = session_.state();
  if (failure) {
    read_all_ = true;
    client_is_gone(now);
  } else {
    session_.receive({input_.data(), size});
  }
  after_input(before, now);
  attachment_->refresh();
  server_->clock.touched();
}

/// Nothing to answer any more, but its last frames are still to go out.
void SocketcandServer::Client::client_is_gone(can::Time now) {
  if (gone_) return;
  gone_ = true;
  queued_ = std::min<std::size_t>(queued_, writing_ ? 1 : 0);
  close_at_ = std::min(close_at_, can::later(now, server_->limits.linger));
}

/// What the session made of its input decides what the connection does next.
void SocketcandServer::Client::after_input(SocketcandSession::State before, can::Time now) {
  using State = SocketcandSession::State;
  if (before != State::raw && session_.state() == State::raw) {
    hold_until_ = can::later(now, server_->limits.settle);
  }
  if (!session_.waiting()) {
    look_at_ = can::never;
  } else if (look_at_ == can::never) {
    look_at_ = can::later(now, look_interval);
    if (!gave_up_) progress_at_ = now;
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
      too_slow_ = true;
      leave_later();
    }
    return;
  }
  ++server_->statistics.frames_to_clients;
  slot->length = static_cast<std::uint8_t>(write_socketcand_frame(slot->text, frame, now));
  slot->frame = true;
  write_next();
}

void SocketcandServer::Client::unacknowledged(can::Time now) {
  if (server_ == nullptr || ending() || session_.state() != SocketcandSession::State::raw) return;
  std::array<char, socketcand_max_message> text;
  message({text.data(), write_socketcand_error(text, error_class_acknowledgement, now)});
}

void SocketcandServer::Client::tick(can::Time now) {
  if (server_ == nullptr) return;
  if (now >= look_at_) look(now);
  if (now >= close_at_) {
    close_at_ = can::never;
    leave_later();
  }
  if (now >= hold_until_) {
    hold_until_ = can::never;
    write_next();
  }
}

/// A client that waits for the bus is not read, so neither its end nor its patience shows by itself.
void SocketcandServer::Client::look(can::Time now) {
  look_at_ = can::later(now, look_interval);
  if (is_closed_by_peer(socket_)) client_is_gone(now);
  const auto before = session_.state();
  if (now - progress_at_ >= server_->limits.patience) {
    if (!std::exchange(gave_up_, true)) message("< error the bus takes no frames, they are dropped >");
    session_.drop_waiting();
  }
  after_input(before, now);
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
  if (gone_) return;
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
  front_ = (front_ + 1) % queue_.size();
  --queued_;
  if (failure) {
    client_is_gone(server_->clock.now());
    if (server_ == nullptr) return;
    attachment_->refresh();
    server_->clock.touched();
  }
  write_next();
  read();
  if (ending()) end_soon();
}

/// Once everything is out that was to go out: leaves when the client has closed, else says that nothing more
/// comes and reads on until it closes too. Closing over unread input would take back the last message.
void SocketcandServer::Client::end_soon() {
  if (queued_ > 0 || on_the_way_ > 0 || leaving_) return;
  if (gone_) {
    if (read_all_ && !session_.waiting()) leave_later();
    return;
  }
  error_code ignored;
  socket_.shutdown(tcp::socket::shutdown_send, ignored);
}

void SocketcandServer::Client::leave_later() {
  if (std::exchange(leaving_, true)) return;
  asio::post(server_->io, [self = shared_from_this()] { self->leave(); });
}

void SocketcandServer::Client::leave() {
  if (server_ == nullptr) return;
  (void)server_->clock.now();  // it leaves now, not at the bus's last event
  if (server_ == nullptr) return;
  Shared& server = *std::exchange(server_, nullptr);
  const std::uint64_t dropped = gone_ ? on_the_way_ + drop_input() : 0;
  error_code ignored;
  socket_.close(ignored);
  attachment_.reset();
  server.clock.touched();
  server.remove(this);
  server.statistics.frames_dropped += dropped;
  if (!server.report) return;
  if (too_slow_) server.report(name_ + " does not read its frames: its connection is closed");
  if (dropped == 1) server.report(name_ + " left: 1 frame that it had sent was dropped");
  if (dropped > 1) {
    server.report(name_ + " left: " + std::to_string(dropped) + " frames that it had sent were dropped");
  }
}

/// Counts the frames that the client had sent and that were not given to the bus.
std::uint64_t SocketcandServer::Client::drop_input() {
  session_.drop();
  error_code failure;
  socket_.non_blocking(true, failure);
  for (std::size_t size = 0; !failure && size < most_counted;) {
    const std::size_t count = socket_.read_some(asio::buffer(input_), failure);
    session_.receive({input_.data(), count});
    size += count;
  }
  return session_.frames_dropped();
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
  socket.set_option(asio::socket_base::keep_alive(true), ignored);  // a machine that vanished is noticed
  // Frames that wait in the kernel are as late as those in the queue, but are not counted.
  socket.set_option(asio::socket_base::send_buffer_size(64 * 1024), ignored);
  if (!is_allowed(socket, limits.allowed)) {
    return refuse(socket, "< error not allowed >", "is not allowed to connect");
  }
  constexpr std::string_view too_many = "< error too many clients >";
  if (clients.size() >= limits.clients) return refuse(socket, too_many, "was refused: too many clients");
  const auto client = std::make_shared<Client>(*this, std::move(socket));
  (void)clock.now();  // it joins now, not at the bus's last event
  if (!client->attach()) return refuse(client->socket(), too_many, "was refused: the bus takes no more");
  clients.push_back(client);
  client->start();
  clock.touched();
}

void SocketcandServer::Shared::refuse(tcp::socket& socket, std::string_view answer,
                                      std::string_view why) const {
  if (report) report(name_of_peer(socket) + ' ' + std::string(why));
  error_code ignored;
  socket.non_blocking(true, ignored);
  socket.write_some(asio::buffer(answer), ignored);
  socket.close(ignored);
}

void SocketcandServer::Shared::remove(const Client* client) {
  std::erase_if(clients, [client](const auto& entry) { return entry.get() == client; });
}

SocketcandServer::SocketcandServer(asio::io_context& io, const tcp::endpoint& endpoint, std::string bus_name,
                                   AttachToBus attach, LoopClock& clock, SocketcandLimits limits,
                                   ClientReport report)
    : shared_(std::make_shared<Shared>(io, endpoint, std::move(bus_name), std::move(attach), clock, limits,
                                       std::move(report))) {}

SocketcandServer::~SocketcandServer() { close(); }

std::expected<void, std::string> SocketcandServer::listen() {
  tcp::acceptor& acceptor = shared_->acceptor;
  error_code failure;
  acceptor.open(shared_->endpoint.protocol(), failure);
  if (!failure) acceptor.set_option(tcp::acceptor::reuse_address(true), failure);
  if (!failure) keep_little(acceptor);
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
