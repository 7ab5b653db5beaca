#include "canopus/link/transport.hpp"

#include <utility>

#include <boost/asio/post.hpp>

namespace canopus::link {

using boost::system::error_code;
using Clock = std::chrono::steady_clock;

Transport::Transport(boost::asio::io_context& io, BusClientOptions options)
    : io_(io), options_(options), pause_(io), complaint_pause_(io) {}

void Transport::set_user(BusClientListener* user) {
  user_ = user;
  if (user == nullptr || undelivered_.empty()) return;
  boost::asio::post(io_, [self = shared_from_this()] {
    if (self->user_ != nullptr && !self->undelivered_.empty())
      self->deliver_complaint(std::exchange(self->undelivered_, {}));
  });
}

bool Transport::send(const can::Frame& frame) {
  if (state_ != State::open || closing_ || queue_.size() + under_way() >= most_waiting) return false;
  queue_.push_back(frame);
  write();
  return true;
}

void Transport::close() {
  user_ = nullptr;
  state_ = State::ended;
  pause_.cancel();
  complaint_pause_.cancel();
  disconnect();
}

std::expected<void, std::string> Transport::restart(std::uint32_t /*bit_rate*/) {
  return std::unexpected("the bit rate of this bus is not set from here");
}

void Transport::opened() {
  if (state_ == State::ended) return;
  const bool resumed = state_ == State::interrupted;
  state_ = State::open;
  if (resumed && user_ != nullptr) user_->bus_resumed();
}

void Transport::failed(std::string reason) {
  if (state_ == State::ended) return;
  const State before = state_;
  complaint_pause_.cancel();
  if (const auto text = complaints_.finish(); text && before == State::open) deliver_complaint(*text);
  if (state_ == State::ended) return;
  disconnect();
  queue_.clear();
  handed_over_.clear();
  reason_ = std::move(reason);
  if (before == State::opening || !options_.keep_trying || closing_) {
    state_ = State::ended;
    if (before != State::opening && user_ != nullptr) user_->bus_lost(reason_);
    return;
  }
  state_ = State::interrupted;
  pause_.expires_after(options_.retry);
  pause_.async_wait([self = shared_from_this()](const error_code& failure) {
    if (!failure && self->state_ == State::interrupted) self->connect();
  });
  if (before == State::open && user_ != nullptr) user_->bus_interrupted(reason_);
}

void Transport::fail_later(std::string reason) {
  boost::asio::post(io_, [self = shared_from_this(), reason = std::move(reason)] {
    if (self->state_ == State::open) self->failed(reason);
  });
}

void Transport::received(const can::Frame& frame, std::optional<std::chrono::nanoseconds> received_at) {
  if (user_ != nullptr) user_->frame_received_at(frame, received_at);
}

void Transport::sent(const can::Frame& frame, std::optional<std::chrono::nanoseconds> sent_at) {
  if (user_ != nullptr) user_->frame_sent_at(frame, sent_at);
}

void Transport::sent_later(const can::Frame& frame) {
  handed_over_.push_back(frame);
  if (std::exchange(reporting_, true)) return;
  boost::asio::post(io_, [self = shared_from_this()] { self->report_later(); });
}

void Transport::report_later() {
  reporting_ = false;
  // Frames sent in a callback are reported in the next round; after a failure the queue is empty.
  for (std::size_t count = handed_over_.size(); count > 0 && !handed_over_.empty(); --count) {
    const can::Frame frame = handed_over_.front();
    handed_over_.pop_front();
    sent(frame);
  }
}

void Transport::deliver_complaint(std::string_view text) {
  if (user_ != nullptr) {
    user_->bus_complains(text);
  } else if (state_ != State::ended && undelivered_.empty()) {
    undelivered_ = text;
  }
}

void Transport::complain(std::string_view text) {
  if (const auto complaint = complaints_.complain(text, Clock::now().time_since_epoch()))
    deliver_complaint(*complaint);
  await_complaints();
}

void Transport::announce(std::string_view text) { deliver_complaint(printable_complaint(text)); }

void Transport::await_complaints() {
  const auto due = complaints_.deadline();
  if (!due || state_ == State::ended) return;
  complaint_pause_.expires_at(Clock::time_point(*due));
  complaint_pause_.async_wait([self = shared_from_this()](const error_code& failure) {
    if (failure) return;
    if (const auto complaint = self->complaints_.tick(Clock::now().time_since_epoch()))
      self->deliver_complaint(*complaint);
    self->await_complaints();
  });
}

void Transport::set_status(const ControllerStatus& status) {
  if (status == status_) return;
  status_ = status;
  if (user_ != nullptr) user_->controller_changed(status);
}

namespace {

class TransportClient final : public BusClient {
 public:
  explicit TransportClient(std::shared_ptr<Transport> transport) : transport_(std::move(transport)) {}
  ~TransportClient() override { transport_->close(); }
  TransportClient(const TransportClient&) = delete;
  TransportClient& operator=(const TransportClient&) = delete;

  bool send(const can::Frame& frame) override { return transport_->send(frame); }
  void set_user(BusClientListener* user) override { transport_->set_user(user); }
  bool close(std::chrono::milliseconds time_out) override {
    transport_->set_user(nullptr);
    transport_->finish();
    const auto done = [this] {
      return transport_->state() != Transport::State::open || transport_->finished();
    };
    const bool is_done = transport_->run_until(done, Clock::now() + time_out);
    transport_->close();
    return is_done;
  }
  ControllerStatus status() const override { return transport_->status(); }
  std::expected<void, std::string> restart(std::uint32_t bit_rate) override {
    return transport_->restart(bit_rate);
  }
  std::optional<std::expected<void, std::string>> restarted() const override {
    return transport_->restarted();
  }
  void set_filter(std::span<const IdentifierFilter> filters) override { transport_->set_filter(filters); }
  bool is_flushed() override { return transport_->is_flushed(); }
  void abort_transmissions() override { transport_->abort_transmissions(); }

 private:
  std::shared_ptr<Transport> transport_;
};

}  // namespace

std::expected<std::unique_ptr<BusClient>, std::string> open_transport(std::shared_ptr<Transport> transport,
                                                                      std::chrono::milliseconds time_out) {
  transport->open();
  const bool answered = transport->run_until([&] { return transport->state() != Transport::State::opening; },
                                             Clock::now() + time_out);
  if (answered && transport->state() == Transport::State::open) {
    return std::make_unique<TransportClient>(std::move(transport));
  }
  std::string reason = transport->reason();
  if (!answered) {
    reason = "no answer within " + std::to_string(time_out.count()) + " ms";
    if (!transport->silence().empty()) reason += "; " + std::string(transport->silence());
  }
  transport->close();
  return std::unexpected(reason);
}

}  // namespace canopus::link
