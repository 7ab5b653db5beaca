#include <algorithm>
#include <bit>

#include "canopus/sim/bus_core.hpp"

namespace canopus::sim {
namespace {

// Bits of a frame after its ACK slot: ACK delimiter and EOF.
constexpr unsigned after_ack_slot = 1 + 7;
constexpr unsigned error_flag_bits = 6;
constexpr unsigned error_delimiter_bits = 8;
constexpr unsigned suspend_bits = 8;

}  // namespace

void Segment::add(BusPort& port) {
  arbiter_.resize(port.index + 1);
  hearing_.resize(core_.acceptance.words());
  port_changed(port);
}

void Segment::port_changed(BusPort& port) {
  std::uint64_t& word = hearing_[port.index / 64];
  const std::uint64_t bit = std::uint64_t{1} << (port.index % 64);
  const bool hears = port.may_transmit();
  if (((word & bit) != 0) != hears) {
    word ^= bit;
    hearing_count_ = hears ? hearing_count_ + 1 : hearing_count_ - 1;
  }
  arbiter_.set(port.index, port.offer());
  if (state_ == State::idle && deadline_ == can::never && arbiter_.lowest() != Arbiter::none) {
    deadline_ = std::max(core_.timeline.now(), free_from_);
    core_.refresh();
  }
}

void Segment::tick(can::Time now) {
  if (now < deadline_) return;
  switch (state_) {
    case State::idle: start(now); break;
    case State::frame: finish(now); break;
    case State::lone_frame: fail_lone(now); break;
  }
}

bool Segment::somebody_acknowledges(const BusPort& transmitter) const {
  return hearing_count_ > (transmitter.may_transmit() ? 1U : 0U);
}

void Segment::start(can::Time now) {
  const std::uint64_t winner = arbiter_.lowest();
  if (winner == Arbiter::none) {
    deadline_ = can::never;
    return;
  }
  BusPort& port = *core_.ports[Arbiter::port_of(winner)];
  port.current = port.queue.pop();
  port.sending = true;
  arbiter_.set(port.index, port.offer());
  transmitter_ = &port;
  start_ = now;
  bits_ = can::frame_bits(port.current);
  if (somebody_acknowledges(port)) {
    state_ = State::frame;
    deadline_ = now + can::bit_time(bits_, port.rate);
  } else {
    state_ = State::lone_frame;
    deadline_ = now + can::bit_time(bits_ - after_ack_slot, port.rate);
  }
}

void Segment::become_idle(can::Time from) {
  state_ = State::idle;
  free_from_ = from;
  transmitter_ = nullptr;
  deadline_ = arbiter_.lowest() == Arbiter::none ? can::never : from;
}

void Segment::finish(can::Time now) {
  BusPort& port = *transmitter_;
  const can::Frame frame = port.current;
  port.sending = false;
  port.faults.transmitted();
  ++port.counted.transmitted;
  const can::Time next = now + can::bit_time(can::intermission_bits, port.rate);
  core_.statistics.frame(frame);
  core_.statistics.busy(start_, next, bits_ + can::intermission_bits);
  become_idle(next);
  for (BusObserver* observer : core_.observers) observer->frame_completed(frame, start_, now);
  deliver(frame, port, now);
  port.tell([&](can::Participant& participant) { participant.transmitted(frame, now); });
}

void Segment::deliver(const can::Frame& frame, const BusPort& from, can::Time now) {
  const std::uint64_t* wanted = core_.acceptance.ports_for(frame);
  for (std::size_t word = 0; word < hearing_.size(); ++word) {
    std::uint64_t ports = wanted[word] & hearing_[word];
    while (ports != 0) {
      BusPort& port = *core_.ports[64 * word + static_cast<std::size_t>(std::countr_zero(ports))];
      ports &= ports - 1;
      if (&port == &from) continue;
      ++port.counted.received;
      port.tell([&](can::Participant& participant) { participant.receive(frame, now); });
    }
  }
}

void Segment::fail_lone(can::Time now) {
  BusPort& port = *transmitter_;
  // A passive transmitter that sees no dominant bit in its error flag counts no acknowledgement error: alone
  // on the bus it stays passive for ever and is never bus-off.
  const bool was_passive = port.faults.state() == can::ErrorState::error_passive;
  const bool was_warned = port.faults.warning();
  if (!was_passive) port.faults.transmitter_error();
  const bool passive = port.faults.state() == can::ErrorState::error_passive;
  unsigned bits = error_flag_bits + error_delimiter_bits + can::intermission_bits;
  if (passive) bits += suspend_bits;
  const can::Time next = now + can::bit_time(bits, port.rate);
  port.sending = false;
  port.queue.push_back_again(port.current);
  arbiter_.set(port.index, port.offer());
  core_.statistics.busy(start_, next, bits_ - after_ack_slot + bits);
  become_idle(next);
  if (passive != was_passive || port.faults.warning() != was_warned) {
    port.tell([&](can::Participant& participant) { participant.controller_changed(now); });
  }
}

}  // namespace canopus::sim
