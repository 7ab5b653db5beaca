#include "canopus/link/socketcand_connection.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <poll.h>

#include "canopus/link/controller_status.hpp"

namespace canopus::link {
namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

/// The other side has closed the connection or its end was received, even if data is still unread.
bool is_closed_by_peer(tcp::socket& socket) {
  pollfd state{socket.native_handle(), POLLRDHUP, 0};
  return ::poll(&state, 1, 0) > 0 && (state.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

}  // namespace

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
  time_ = now;
  const auto before = session_.state();
  if (failure) {
    read_all_ = true;
    client_is_gone(now);
  } else {
    session_.receive({input_.data(), size});
  }
  after_input(before, now);
  server_->clock.touched();
}

/// Nothing to answer any more, but its last frames are still to go out.
void SocketcandServer::Client::client_is_gone(can::Time now) {
  if (gone_) return;
  gone_ = true;
  session_.end_jobs();
  queued_ = std::min<std::size_t>(queued_, writing_ ? 1 : 0);
  close_at_.bring_forward(can::later(now, server_->limits.linger));
}

/// The session's new state after input determines the connection's next action.
void SocketcandServer::Client::after_input(SocketcandSession::State before, can::Time now) {
  using State = SocketcandSession::State;
  if (before != State::raw && session_.state() == State::raw) {
    hold_until_ = can::later(now, server_->limits.settle);
  }
  if (!session_.waiting()) {
    check_at_ = can::never;
  } else if (check_at_ == can::never) {
    check_at_ = can::later(now, check_interval);
    if (!gave_up_) progress_at_ = now;
  }
  if (ending()) {
    if (close_at_ == can::never) close_at_ = can::later(now, server_->limits.linger);
    end_soon();
  }
  read();
}

void SocketcandServer::Client::receive(const can::Frame& frame, can::Time now) {
  // Remote frames are not passed on: the protocol's raw mode has no element for them that clients support.
  if (server_ == nullptr || ending() || frame.remote) return;
  if (session_.state() != SocketcandSession::State::raw) return session_.filter(frame, now);
  queue_frame(frame, now, SocketcandData::together);
}

void SocketcandServer::Client::queue_frame(const can::Frame& frame, can::Time time, SocketcandData data) {
  report_lost();
  Message* slot = lost_ == 0 ? claim_slot(reserved_for_answers) : nullptr;
  if (slot == nullptr) {
    ++server_->statistics.frames_lost;
    if (++lost_ == server_->limits.lost_frames) judge_reading();
    return;
  }
  ++server_->statistics.frames_to_clients;
  slot->length = static_cast<std::uint8_t>(write_socketcand_frame(slot->text, frame, time, data));
  slot->frame = true;
  write_next();
}

void SocketcandServer::Client::unacknowledged(can::Time now) {
  if (server_ == nullptr || ending() || session_.state() != SocketcandSession::State::raw) return;
  std::array<char, socketcand_max_message> text;
  message({text.data(), write_socketcand_error(text, error_class_acknowledgement, now)});
}

void SocketcandServer::Client::controller_error(std::uint32_t error_class, can::Time now) {
  if (server_ == nullptr || ending() || session_.state() != SocketcandSession::State::raw) return;
  report_lost();
  Message* slot = lost_ == 0 ? claim_slot(reserved_for_answers) : nullptr;
  if (slot == nullptr) return;  // frames matter more to a client that is slow
  slot->length = static_cast<std::uint8_t>(write_socketcand_error(slot->text, error_class, now));
  slot->frame = true;
  write_next();
}

void SocketcandServer::Client::tick(can::Time now) {
  if (server_ == nullptr) return;
  time_ = now;
  session_.tick(now);
  if (now >= check_at_) check_client(now);
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
void SocketcandServer::Client::check_client(can::Time now) {
  check_at_ = can::later(now, check_interval);
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

bool SocketcandServer::Client::restart(std::uint32_t bit_rate) {
  if (attachment_ == nullptr || !attachment_->restart(bit_rate)) return false;
  server_->statistics.frames_dropped += std::exchange(on_the_way_, 0);
  return true;
}

void SocketcandServer::Client::bus_has_room(can::Time now) {
  if (server_ == nullptr) return;
  time_ = now;
  const auto before = session_.state();
  session_.resume();
  after_input(before, now);
}

/// The next free slot of the queue, if `reserve` more would still be free.
SocketcandServer::Client::Message* SocketcandServer::Client::claim_slot(std::size_t reserve) {
  if (queued_ + reserve >= queue_.size()) return nullptr;
  return &queue_[(front_ + queued_++) % queue_.size()];
}

/// Reports to a client that was too slow what it missed, once it has read half of what waits for it.
void SocketcandServer::Client::report_lost() {
  if (lost_ == 0 || queued_ > queue_.size() / 2) return;
  const std::string text = "< error lost " + std::to_string(lost_) + " frames, read faster >";
  lost_ = 0;
  message(text);
}

/// Ends a client whose socket takes nothing. Real time decides, not frames: a plant that was late catches up with
/// thousands of them at once, and no client can read them in between.
void SocketcandServer::Client::judge_reading() {
  stall_.expires_after(server_->limits.stall);
  stall_.async_wait([self = shared_from_this(), before = written_](const error_code& failure) {
    if (failure || self->server_ == nullptr) return;
    self->report_lost();
    if (self->lost_ < self->server_->limits.lost_frames) return;
    if (self->written_ != before) return self->judge_reading();
    ++self->server_->statistics.clients_too_slow;
    self->too_slow_ = true;
    self->leave();
  });
}

void SocketcandServer::Client::message(std::string_view text) {
  if (gone_) return;
  Message* slot = claim_slot(0);
  if (slot == nullptr) return leave_later();  // unreachable, see reserved_for_answers
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
  ++written_;
  if (failure) {
    client_is_gone(server_->clock.now());
    if (server_ == nullptr) return;
    server_->clock.touched();
  }
  write_next();
  read();
  if (ending()) end_soon();
}

/// Called when all pending output is sent: disconnects if the client has closed; otherwise shuts down the
/// send direction and reads until the client closes too. Closing with unread input would reset the connection
/// and lose the last message.
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
  stall_.cancel();
  attachment_.reset();
  server.clock.touched();
  server.clients.remove(*this);
  server.statistics.frames_dropped += dropped;
  if (too_slow_) server.clients.report(name_, "does not read its frames: its connection is closed");
  if (dropped == 1) server.clients.report(name_, "left: 1 frame that it had sent was dropped");
  if (dropped > 1) {
    server.clients.report(name_,
                          "left: " + std::to_string(dropped) + " frames that it had sent were dropped");
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

}  // namespace canopus::link
