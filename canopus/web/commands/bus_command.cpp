#include "canopus/web/commands/bus_command.hpp"

#include <string>

#include <boost/asio/post.hpp>

#include "canopus/link/controller_status.hpp"

namespace canopus::web {

BusCommand::BusCommand(boost::asio::io_context& io, link::LoopClock& clock,
                       std::chrono::milliseconds standstill, Use use)
    : io_(io), clock_(clock), standstill_(standstill), standstill_timer_(io), use_(std::move(use)) {
  alarm().add_part(leave_at_);
}

void BusCommand::start(serve::ClientPorts& ports) {
  last_time_ = clock_.now();
  attachment_ = ports.attach(*this);
  self_ = shared_from_this();
  begin(last_time_);
  clock_.touched();
  watch_standstill();
}

void BusCommand::interrupt() {
  const can::Time now = clock_.now();
  if (!is_over_) give_up("interrupted", now);
  clock_.touched();
}

void BusCommand::kill() {
  leave_soon();
  answer(failed);
}

void BusCommand::stop() noexcept {
  use_ = {};
  standstill_timer_.cancel();
  attachment_.reset();
  self_.reset();
}

void BusCommand::receive(const can::Frame& frame, can::Time now) {
  if (!is_over_) received(frame, now);
}

void BusCommand::transmitted(const can::Frame&, can::Time now) {
  if (on_the_way_ > 0) --on_the_way_;
  if (!is_over_) return frame_sent(now);
  if (on_the_way_ == 0) leave_soon();
}

void BusCommand::tick(can::Time now) {
  if (now >= leave_at_) return leave_soon();
  if (!is_over_) ticked(now);
}

void BusCommand::unacknowledged(can::Time now) { controller_error(link::error_class_acknowledgement, now); }

void BusCommand::controller_error(std::uint32_t error_class, can::Time) {
  const std::string_view sentence = link::describe_error_frame(error_class, {});
  if (!sentence.empty()) complain(text::Line("the bus: {}", sentence));
}

bool BusCommand::send(const can::Frame& frame) {
  if (!attachment_ || !attachment_->send(frame)) return false;
  ++on_the_way_;
  return true;
}

void BusCommand::complain(const text::Line& sentence) {
  text::TextOutput line;
  line.line("canopus: {}", sentence);
  if (!errors_.text().contains(line.text())) errors_.content(line.text());
}

void BusCommand::conclude(int code, can::Time now) {
  leave_at_ = can::later(now, linger);
  if (on_the_way_ == 0) leave_soon();
  answer(code);
}

/// In the loop: the receiver of the answer may start the next command.
void BusCommand::answer(int code) {
  if (std::exchange(is_over_, true)) return;
  boost::asio::post(io_, [code, self = shared_from_this()] {
    self->standstill_timer_.cancel();
    const Use use = std::exchange(self->use_, {});
    std::string row = self->out_.text();
    if (row.ends_with('\n')) row.pop_back();
    if (use.line && !row.empty()) use.line(std::move(row));
    if (use.ended) use.ended(code, self->errors_.text());
  });
}

/// In the loop: nothing leaves a bus from inside of it.
void BusCommand::leave_soon() {
  leave_at_ = can::never;
  if (std::exchange(is_leaving_, true)) return;
  boost::asio::post(io_, [self = shared_from_this()] {
    if (!self->attachment_) return;
    (void)self->clock_.now();
    self->attachment_.reset();
    self->clock_.touched();
    self->self_.reset();
  });
}

void BusCommand::watch_standstill() {
  standstill_timer_.expires_after(standstill_);
  standstill_timer_.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
    if (const auto self = weak.lock(); self && !error) self->check_standstill();
  });
}

void BusCommand::check_standstill() {
  const can::Time now = clock_.now();
  clock_.touched();
  if (is_over_) return;
  if (std::exchange(last_time_, now) != now) return watch_standstill();
  give_up("plant time stands still", now);
  leave_soon();  // what was not sent is not sent later
}

}  // namespace canopus::web
