#include "canopus/sim/bus/bitwise/wire_levels.hpp"

#include <algorithm>
#include <span>

namespace canopus::sim {
namespace {

std::span<const FrameFaults::Corruption> corruptions(const FrameFaults& faults) noexcept {
  return {faults.corruption, faults.corruptions};
}

}  // namespace

void WireLevels::update_members() noexcept {
  has_stuck_dominant_ = std::ranges::any_of(wire_.core.ports, [this](const auto& port) {
    return wire_.has(*port) && port->on_wire && port->stuck_dominant;
  });
  update_differ();
}

void WireLevels::begin_frame(can::Time now, can::Duration bit) noexcept {
  frame_start_ = now;
  bit_ = bit;
  update_differ();
}

void WireLevels::update_differ() noexcept {
  differ_ =
      std::ranges::any_of(corruptions(wire_.faults), [](const auto& one) { return one.at != nullptr; }) ||
      std::ranges::any_of(wire_.members, [](const BusPort* port) { return port->inverted; }) ||
      wire_.core.clocks != nullptr;
}

bool WireLevels::level(bool is_driven, can::Time now) noexcept {
  bool dominant = is_terminated_wrongly() ? terminated(is_driven, now) : is_driven;
  dominant = dominant != is_inverted(nullptr, now);
  return driven_.level == DrivenLevel::released ? dominant : driven_.level == DrivenLevel::dominant;
}

bool WireLevels::terminated(bool is_driven, can::Time now) noexcept {
  if (termination_.is_weak) return false;
  if (was_driven_ && !is_driven) released_ = now + termination_.release;
  was_driven_ = is_driven;
  if (is_driven) released_ = can::never;
  if (released_ <= now) released_ = can::never;
  return is_driven || is_held();
}

bool WireLevels::seen_on_line(const BusPort& port, bool is_driven, can::Time now) const noexcept {
  bool dominant = is_driven || (is_terminated_wrongly() && is_held());
  if (termination_.is_weak) dominant = false;
  dominant = dominant != is_inverted(nullptr, now);
  if (driven_.level != DrivenLevel::released) dominant = driven_.level == DrivenLevel::dominant;
  return dominant != is_inverted(&port, now);
}

bool WireLevels::is_inverted(const BusPort* at, can::Time now) const noexcept {
  bool inverts = at == nullptr ? is_inverted_ && !wire_.members.empty() : at->inverted;
  for (const FrameFaults::Corruption& corruption : corruptions(wire_.faults)) {
    if (corruption.at == at && is_at_work(corruption, now)) inverts = !inverts;
  }
  return inverts;
}

bool WireLevels::is_corrupted(can::Time now) const noexcept {
  return std::ranges::any_of(corruptions(wire_.faults),
                             [&](const auto& corruption) { return is_at_work(corruption, now); });
}

can::Time WireLevels::undisturbed_until(can::Time from) const noexcept {
  can::Time until = can::never;
  for (const FrameFaults::Corruption& corruption : corruptions(wire_.faults)) {
    const can::Time begin = frame_start_ + bit_ * corruption.bit;
    if (begin + bit_ > from) until = std::min(until, std::max(begin, from));
  }
  return until;
}

can::Time WireLevels::next_change(can::Time now) const noexcept {
  can::Time next = can::never;
  for (const FrameFaults::Corruption& corruption : corruptions(wire_.faults)) {
    const can::Time begin = frame_start_ + bit_ * corruption.bit;
    if (begin > now) {
      next = std::min(next, begin);
    } else if (begin + bit_ > now) {
      next = std::min(next, begin + bit_);
    }
  }
  return released_ > now ? std::min(next, released_) : next;
}

}  // namespace canopus::sim
