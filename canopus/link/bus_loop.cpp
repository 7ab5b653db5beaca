#include "canopus/link/bus_loop.hpp"

#include <algorithm>
#include <csignal>

#include "canopus/link/bounded_poll.hpp"

namespace canopus::link {

using WallClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

BusLoop::BusLoop(Signals signals) : signals_(io_), started_(WallClock::now()) {
  if (signals == Signals::left_alone) return;
  signals_.add(SIGINT);
  signals_.add(SIGTERM);
  signals_.async_wait([this](const boost::system::error_code& failure, int) {
    if (!failure) interrupted_ = true;
  });
}

BusLoop::~BusLoop() {
  if (bus_ == nullptr) return;
  bus_->set_user(nullptr);
  if (!lost_) (void)bus_->close(1s);
}

std::expected<std::unique_ptr<BusLoop>, std::string> BusLoop::open(const BusAddress& address,
                                                                   can::Duration time_out, Signals signals) {
  std::unique_ptr<BusLoop> loop(new BusLoop(signals));
  auto bus =
      open_bus(loop->io_, address, {.time_out = std::chrono::ceil<std::chrono::milliseconds>(time_out)});
  if (!bus) return std::unexpected(bus.error());
  loop->bus_ = std::move(*bus);
  loop->bus_->set_user(loop.get());
  return loop;
}

can::Duration BusLoop::elapsed() const {
  return std::chrono::duration_cast<can::Duration>(WallClock::now() - started_);
}

can::Time BusLoop::now() const { return can::Time{} + (patient_ ? patient_->at(elapsed()) : elapsed()); }

void BusLoop::extend_timeouts() {
  patient_.emplace();
  patient_->start(elapsed());
}

bool BusLoop::send(const can::Frame& frame) {
  if (lost_ || !bus_->send(frame)) return false;
  ++under_way_;
  return true;
}

void BusLoop::add(can::Participant& participant) {
  entries_.push_back({&participant, timeline_.add(participant)});
}

void BusLoop::remove(can::Participant& participant) { remove_listener(participant); }

void BusLoop::add_listener(can::Listener& listener) { entries_.push_back({&listener, std::nullopt}); }

void BusLoop::remove_listener(can::Listener& listener) {
  const auto entry = std::ranges::find(entries_, &listener, &Entry::listener);
  if (entry == entries_.end()) return;
  if (entry->handle) timeline_.remove(*entry->handle);
  entries_.erase(entry);
}

void BusLoop::frame_received(const can::Frame& frame) {
  const can::Time time = now();
  for (std::size_t i = 0; i < entries_.size(); ++i) entries_[i].listener->receive(frame, time);
}

void BusLoop::bus_lost(const std::string& reason) {
  lost_ = true;
  failure_ = "the bus is lost: " + reason;
}

void BusLoop::bus_complains(std::string_view text) {
  if (complaint_) complaint_(text);
}

BusLoop::End BusLoop::run(const std::function<bool()>& done, can::Time end) {
  while (true) {
    // Received frames are processed before timeouts: this process may have been suspended for long.
    const can::Time time = now();
    if (patient_) patient_->advance(elapsed());
    if (io_.stopped()) io_.restart();
    poll_portion(io_, [this] { return interrupted_ || lost_; });
    timeline_.run_until(time);
    if (done()) return End::done;
    if (lost_) return End::lost;
    if (interrupted_) return End::interrupted;
    if (time >= end) return End::time_over;
    const can::Time next = std::min(timeline_.next(), end);
    if (next <= now()) continue;
    if (io_.stopped()) io_.restart();
    if (patient_) {
      io_.run_one_until(WallClock::now() + std::min<can::Duration>(next - now(), SuspendAwareClock::often));
    } else if (next == can::never) {
      io_.run_one();
    } else {
      io_.run_one_until(started_ + next.time_since_epoch());
    }
  }
}

}  // namespace canopus::link
