#include "canopus/link/linked_bus.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/can/frame_bits.hpp"

namespace canopus::link {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t default_queue_capacity = 128;
constexpr std::size_t max_queue_capacity = 65'535;
/// No frame waits longer in the kernel than this.
constexpr can::Duration oldest_stamp = 10s;
/// Retry interval while the transport's queue is full.
constexpr can::Duration again_after = 1ms;
/// Recessive bits that a controller waits for after bus-off [ISO 11898-1 12.1.4].
constexpr unsigned recovery_bits = 128 * 11;

}  // namespace

LinkedPort::LinkedPort(LinkedBus& bus, std::string name)
    : bus_(bus), name_(std::move(name)), bit_rate_(bus.bit_rate()) {
  queue_.configure(true, default_queue_capacity);
}

bool LinkedPort::send(const can::Frame& frame) {
  if (!powered_ || listen_only_ || !queue_.push(frame, under_way_)) {
    ++refused_;
    return false;
  }
  bus_.offer_changed();
  return true;
}

void LinkedPort::plug(bool plugged) {
  plugged_ = plugged;
  bus_.offer_changed();
}

void LinkedPort::set_power(bool on) {
  if (powered_ == on) return;
  powered_ = on;
  if (on) return bus_.want_bit_rate(*this, bit_rate_);
  abort_transmissions();
  refused_ = 0;
}

void LinkedPort::set_transmit_queue(can::TransmitOrder order, std::size_t capacity) {
  bus_.forget(*this);
  queue_.configure(order == can::TransmitOrder::identifier, std::min(capacity, max_queue_capacity));
}

void LinkedPort::set_listen_only(bool listen_only) {
  listen_only_ = listen_only;
  if (listen_only) abort_transmissions();
}

void LinkedPort::set_automatic_recovery(bool automatic) {
  automatic_recovery_ = automatic;
  if (automatic && error_state() == can::ErrorState::bus_off) recover();
}

void LinkedPort::recover() { bus_.want_recovery(); }

std::uint16_t LinkedPort::transmit_error_counter() const {
  return is_on() ? bus_.status().transmit_errors : std::uint16_t{0};
}
std::uint16_t LinkedPort::receive_error_counter() const {
  return is_on() ? bus_.status().receive_errors : std::uint16_t{0};
}
can::ErrorState LinkedPort::error_state() const {
  return is_on() ? bus_.status().state : can::ErrorState::error_active;
}

void LinkedPort::restart(std::uint32_t bit_rate) {
  abort_transmissions();
  refused_ = 0;
  bus_.want_bit_rate(*this, bit_rate);
}

bool LinkedPort::has_room() const { return powered_ && queue_.size() + under_way_ < queue_.capacity(); }

void LinkedPort::abort_transmissions() {
  queue_.clear();
  bus_.forget(*this);
}

LinkedBus::LinkedBus(std::string name, std::uint32_t bit_rate, can::Timeline& timeline,
                     std::unique_ptr<BusClient> client)
    : name_(std::move(name)),
      bit_rate_(bit_rate),
      timeline_(timeline),
      client_(std::move(client)),
      status_(client_->status()) {
  alarm().add_part(hand_over_at_);
  alarm().add_part(recover_at_);
  timeline.add(*this, name_, can::Timeline::Rank::bus);
}

LinkedBus::~LinkedBus() { client_->set_user(nullptr); }

void LinkedBus::start(LoopClock* clock, Report report) {
  clock_ = clock;
  report_ = std::move(report);
  is_started_ = true;
  client_->set_user(this);
  status_ = client_->status();
  offer_changed();
}

bool LinkedBus::close(std::chrono::milliseconds time_out) {
  is_started_ = false;
  client_->set_user(nullptr);
  return is_lost_ || client_->close(time_out);
}

can::Port& LinkedBus::add_port(std::string name) {
  return *ports_.emplace_back(std::make_unique<LinkedPort>(*this, std::move(name)));
}

std::vector<const can::Port*> LinkedBus::ports() const {
  std::vector<const can::Port*> all;
  for (const auto& port : ports_) all.push_back(port.get());
  return all;
}

void LinkedBus::add_observer(can::BusObserver& observer) { observers_.push_back(&observer); }
void LinkedBus::remove_observer(can::BusObserver& observer) { std::erase(observers_, &observer); }

void LinkedBus::report(std::string_view text) {
  if (report_) report_(text, timeline_.now());
}

can::Time LinkedBus::arrive() {
  if (timeline_.is_running() || clock_ == nullptr) return timeline_.now();
  return clock_->now();
}

void LinkedBus::leave() {
  if (!timeline_.is_running() && clock_ != nullptr) clock_->touched();
}

void LinkedBus::offer_changed() {
  if (hand_over_at_ != can::never || under_way_count_ == window) return;
  hand_over_at_ = timeline_.now();
}

void LinkedBus::tick(can::Time now) {
  if (now >= hand_over_at_) {
    hand_over_at_ = can::never;
    hand_over();
  }
  if (now >= recover_at_) {
    recover_at_ = can::never;
    if (status_.state == can::ErrorState::bus_off) want_recovery();
  }
}

LinkedPort* LinkedBus::first_in_arbitration() noexcept {
  LinkedPort* first = nullptr;
  for (const auto& port : ports_) {
    if (!port->offers()) continue;
    if (first == nullptr || arbitration(port->queue_.front()) < arbitration(first->queue_.front())) {
      first = port.get();
    }
  }
  return first;
}

/// Gives the transport the frames that would win arbitration among the nodes of the plant.
void LinkedBus::hand_over() {
  if (!is_started_ || is_lost_) return;
  while (under_way_count_ < window) {
    LinkedPort* port = first_in_arbitration();
    if (port == nullptr) return;
    const can::Frame frame = port->queue_.pop();
    under_way_[under_way_count_++] = {port, frame};
    ++port->under_way_;
    if (client_->send(frame)) continue;  // it may be on the bus already: frame_sent() came
    --under_way_count_;
    --port->under_way_;
    port->queue_.push_back_again(frame);
    hand_over_at_ = can::later(timeline_.now(), again_after);
    return;
  }
}

void LinkedBus::frame_sent_at(const can::Frame& frame, Stamp sent_at) {
  const can::Time now = arrive();
  const auto end = under_way_.begin() + static_cast<std::ptrdiff_t>(under_way_count_);
  const auto found =
      std::find_if(under_way_.begin(), end, [&](const UnderWay& entry) { return entry.frame == frame; });
  if (found == end) return;  // of before a restart
  LinkedPort* port = found->port;
  std::move(found + 1, end, found);
  --under_way_count_;
  if (port != nullptr) --port->under_way_;
  completed(frame, port, now, sent_at);
  offer_changed();
  leave();
}

void LinkedBus::frame_received_at(const can::Frame& frame, Stamp received_at) {
  const can::Time now = arrive();
  completed(frame, nullptr, now, received_at);
  leave();
}

/// Converts a stamp by its age against the wall clock. An age that is negative or too large means that the
/// controller's clock is not synchronized or that the machine's clock was set.
can::Time LinkedBus::time_of(Stamp stamp, can::Time now) const {
  if (!stamp) return now;
  const auto wall = wall_clock_ ? wall_clock_() : std::chrono::system_clock::now().time_since_epoch();
  const can::Duration age = wall - *stamp;
  if (age < can::Duration::zero() || age > oldest_stamp) return now;
  return std::clamp(now - age, std::min(stamp_, now), now);
}

/// The bus transmitted a frame: all active ports of the plant receive it.
void LinkedBus::completed(const can::Frame& frame, LinkedPort* sender, can::Time now, Stamp stamp) {
  stamp_ = time_of(stamp, now);
  const unsigned bits = can::frame_bits(frame) + can::intermission_bits;
  const std::uint32_t rate = status_.bit_rate != 0 ? status_.bit_rate : bit_rate_;
  const can::Time start = std::max(now - can::bit_time(bits, rate), std::min(busy_until_, now));
  statistics_.frame(frame);
  statistics_.busy(start, now, bits);
  busy_until_ = now;
  for (can::BusObserver* observer : observers_) observer->frame_completed(frame, start, now);
  for (const auto& port : ports_) {
    if (!port->is_on() || port->participant_ == nullptr) continue;
    if (port.get() == sender) {
      ++port->counters_.transmitted;
      port->participant_->transmitted(frame, now);
    } else if (frame.extended ? port->acceptance_.extended
                              : port->acceptance_.base[frame.identifier & can::max_base_identifier]) {
      ++port->counters_.received;
      port->participant_->receive(frame, now);
    }
  }
}

/// Frames that this port gave to the transport have no sender from now on.
void LinkedBus::forget(LinkedPort& port) noexcept {
  for (UnderWay& entry : under_way_) {
    if (entry.port == &port) entry.port = nullptr;
  }
  port.under_way_ = 0;
}

void LinkedBus::lose_what_is_under_way() noexcept {
  for (UnderWay& entry : under_way_) {
    if (entry.port != nullptr) entry.port->under_way_ = 0;
    entry = {};
  }
  under_way_count_ = 0;
  offer_changed();
}

void LinkedBus::want_bit_rate(LinkedPort& port, std::uint32_t bit_rate) {
  port.bit_rate_ = bit_rate;
  const std::uint32_t present = status_.bit_rate;
  const bool had_other_rate = std::exchange(port.has_other_rate_, false);
  if (present == 0 || present == bit_rate) {  // 0: the transport has none, or does not report it
    if (status_.state == can::ErrorState::bus_off) want_recovery();
    return;
  }
  const auto others = std::ranges::count_if(ports_, [&](const auto& other) {
    return other.get() != &port && other->participant_ != nullptr && other->is_on();
  });
  const auto done = others == 0 ? client_->restart(bit_rate)
                                : std::unexpected(std::string("other nodes of the plant use it"));
  if (done) {
    status_ = client_->status();
    if (status_.bit_rate != 0) status_.bit_rate = bit_rate;
    return;
  }
  port.has_other_rate_ = true;
  if (had_other_rate) return;
  report(fmt::format("{} wants {} bit/s, and the bus has {} bit/s: it receives and sends nothing there ({})",
                     port.name_, bit_rate, present, done.error()));
}

void LinkedBus::want_recovery() {
  if (status_.state != can::ErrorState::bus_off || !is_started_) return;
  if (const auto done = client_->restart(0); !done) {
    report(fmt::format("the controller stays bus-off: {}", done.error()));
  }
}

void LinkedBus::report_controllers(can::Time now) {
  for (const auto& port : ports_) {
    if (!port->is_on() || port->participant_ == nullptr) continue;
    if (status_.state == can::ErrorState::bus_off) ++port->counters_.bus_offs;
    port->participant_->controller_changed(now);
  }
}

void LinkedBus::controller_changed(const ControllerStatus& status) {
  const can::Time now = arrive();
  const bool was_off = status_.state == can::ErrorState::bus_off;
  status_ = status;
  const bool is_off = status_.state == can::ErrorState::bus_off;
  if (was_off && !is_off) lose_what_is_under_way();  // the hardware dropped it
  if (is_off && !was_off) {
    report("the controller is bus-off");
    if (std::ranges::any_of(ports_,
                            [](const auto& port) { return port->is_on() && port->automatic_recovery_; })) {
      recover_at_ = can::later(now, can::bit_time(recovery_bits, bit_rate_));
    }
  }
  report_controllers(now);
  leave();
}

void LinkedBus::bus_interrupted(const std::string& reason) {
  (void)arrive();
  is_interrupted_ = true;
  report(fmt::format("{}; it is tried again", reason));
  lose_what_is_under_way();
  leave();
}

void LinkedBus::bus_resumed() {
  const can::Time now = arrive();
  is_interrupted_ = false;
  status_ = client_->status();
  report("the bus is there again");
  offer_changed();
  report_controllers(now);
  leave();
}

void LinkedBus::bus_lost(const std::string& reason) {
  (void)arrive();
  is_lost_ = true;
  report(fmt::format("{}; no frames are received or sent any more", reason));
  leave();
}

void LinkedBus::bus_complains(std::string_view text) {
  (void)arrive();
  report(text);
}

}  // namespace canopus::link
