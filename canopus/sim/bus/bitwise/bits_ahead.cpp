// Bits of a wire that pass ahead of time, all at once: nothing comes of them but that the controllers go on.

#include <algorithm>

#include "canopus/sim/bus/bitwise/bitwise_wire.hpp"

namespace canopus::sim {
namespace {

/// It only counts recessive bits, and drives none.
bool is_waiting(const BusPort& port) noexcept {
  using enum BitController::State;
  return port.bits.state() == bus_off || port.bits.state() == integrating;
}

bool is_asleep(const BusPort& port) noexcept { return port.bits.idle() && port.phase.next == can::never; }

}  // namespace

/// The moment of each single bit is kept by rewind(), should anything happen before they are over.
void BitwiseWire::run_ahead() {
  const can::Time from = wire_.deadline;
  const std::uint64_t most = most_bits_ahead(from);
  if (most == 0 || changed_) return;
  const std::vector<BusPort*>& sampling = lockstep_.sampling();
  ahead_.before.clear();
  for (const BusPort* port : sampling) ahead_.before.push_back({port->bits.progress(), port->phase});
  ahead_.dominant = dominant_;
  const can::Duration bit = sampling.front()->bit();
  std::uint64_t bits = pass_frame_bits(most);
  while (bits < most && run_bit_ahead()) {
    ++bits;
    const auto is_new_quiet = [](const BusPort* port) {
      return port->bits.quiet() && !is_waiting(*port) && !is_asleep(*port);
    };
    if (std::ranges::any_of(sampling, is_new_quiet)) break;  // it may begin, or whole frames go on
  }
  if (bits == 0) return;
  ahead_.from = from;
  ahead_.until = from + bit * static_cast<std::int64_t>(bits);
  ahead_.is_active = true;
  for (BusPort* port : sampling) {
    if (is_asleep(*port)) continue;
    port->phase.bit_start = ahead_.until - bit;
    port->phase.next = ahead_.until;
    port->phase.sampled = dominant_;
    port->phase.synchronised = false;
  }
  wire_.deadline = ahead_.until;
}

/// From the start of the next bit on, with which all go on together. 0: it is not so.
std::uint64_t BitwiseWire::most_bits_ahead(can::Time from) const noexcept {
  constexpr std::uint64_t most_at_once = 2'000;
  if (from == can::never || completion_.is_due()) return 0;
  std::uint64_t most = most_at_once;
  bool is_some_awake = false;
  bool is_waited_for = active_;  // to be quiet
  for (const BusPort* port : lockstep_.sampling()) {
    if (is_asleep(*port)) {
      if (wire_.arbiter.lowest() != Arbiter::none) return 0;
      continue;
    }
    if (port->phase.next != from || port->phase.sampling || port->bits.idle() ||
        port->bits.state() == BitController::State::suspend)
      return 0;
    is_some_awake = true;
    if (!port->bits.quiet()) is_waited_for = false;
    if (const unsigned bits = Lockstep::bits_to_return(*port); bits != BitController::no_return) {
      if (bits <= 1) return 0;
      most = std::min<std::uint64_t>(most, bits - 1);
    }
  }
  if (is_waited_for || !is_some_awake) return 0;
  const can::Time until = levels_.undisturbed_until(from);
  if (until == can::never) return most;
  return std::min(most, static_cast<std::uint64_t>((until - from) / lockstep_.sampling().front()->bit()));
}

/// Bits of a frame that all see as its transmitter sends them. Returns how many they were.
std::uint64_t BitwiseWire::pass_frame_bits(std::uint64_t most) {
  const std::vector<BusPort*>& sampling = lockstep_.sampling();
  const auto found =
      std::ranges::find_if(sampling, [](const BusPort* port) { return port->bits.transmitting(); });
  if (found == sampling.end()) return 0;
  BitController& transmitter = (*found)->bits;
  const auto bits =
      static_cast<unsigned>(std::min<std::uint64_t>(most, transmitter.bits_to_acknowledgement()));
  const auto sees_it = [&](const BusPort* port) {
    return port == *found || is_waiting(*port) || port->bits.receives_from(transmitter);
  };
  if (bits == 0 || !std::ranges::all_of(sampling, sees_it)) return 0;
  const BitController::RecessiveRuns runs = transmitter.pass_bits(bits);
  dominant_ = runs.after == 0;
  for (BusPort* port : sampling) {
    if (is_waiting(*port)) {
      port->bits.wait(bits, runs);
    } else if (port != *found) {
      port->bits.follow(transmitter);
    }
  }
  return bits;
}

/// False: something comes of the bit, which is yet to come.
bool BitwiseWire::run_bit_ahead() {
  const std::vector<BusPort*>& sampling = lockstep_.sampling();
  const bool dominant =
      std::ranges::any_of(sampling, [](const BusPort* port) { return port->bits.drives_dominant(); });
  if (dominant && !active_) return false;
  for (const BusPort* port : sampling) {
    if (dominant && is_asleep(*port)) return false;
    if (!is_waiting(*port) && port->bits.may_report(dominant)) return false;
  }
  for (BusPort* port : sampling) {
    if (!is_asleep(*port)) port->bits.sample(dominant);
  }
  dominant_ = dominant;
  return true;
}

/// The ports are where they were before the bits, and go through those until `until` one by one.
void BitwiseWire::rewind(can::Time until) {
  ahead_.is_active = false;
  dominant_ = ahead_.dominant;
  auto before = ahead_.before.begin();
  for (BusPort* port : lockstep_.sampling()) {
    port->bits.resume(before->progress);
    port->phase = before->phase;
    ++before;
  }
  replay(ahead_.from, until);
}

}  // namespace canopus::sim
