#include "canopus/can/bus_statistics.hpp"

#include <algorithm>

#include "canopus/can/bus.hpp"

namespace canopus::can {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t extended_slots = 2048;
constexpr std::size_t extended_limit = 1024;  // half full: a search stays short
constexpr Duration second = 1s;

double share(Duration busy) { return std::chrono::duration<double>(busy).count(); }

}  // namespace

BusStatistics::BusStatistics() : extended_(extended_slots) {}

std::size_t BusStatistics::slot_of(std::uint32_t identifier) const noexcept {
  std::size_t slot = (identifier * 2'654'435'761U >> 16) % extended_slots;
  for (std::size_t tries = 0; tries < extended_slots; ++tries) {
    if (extended_[slot].frames == 0 || extended_[slot].identifier == identifier) return slot;
    slot = (slot + 1) % extended_slots;
  }
  return extended_slots;
}

void BusStatistics::count_extended(std::uint32_t identifier) noexcept {
  const std::size_t slot = slot_of(identifier);
  if (slot == extended_slots) return;
  if (extended_[slot].frames == 0) {
    if (extended_used_ == extended_limit) return;
    ++extended_used_;
    extended_[slot].identifier = identifier;
  }
  ++extended_[slot].frames;
}

std::uint64_t BusStatistics::frames_of(std::uint32_t identifier, bool extended) const noexcept {
  if (!extended) return identifier < base_.size() ? base_[identifier] : 0;
  const std::size_t slot = slot_of(identifier);
  return slot == extended_slots || extended_[slot].identifier != identifier ? 0 : extended_[slot].frames;
}

void BusStatistics::Seconds::close() noexcept {
  last = busy;
  peak = std::max(peak, last);
  busy = {};
  end += second;
}

void BusStatistics::Seconds::add_across(Time from, Time until) noexcept {
  // Another piece of the wire may have come to this second first.
  const Duration late = std::min(until, begin()) - std::max(from, begin() - second);
  if (late > Duration{}) {
    last += late;
    peak = std::max(peak, last);
  }
  from = std::max(from, begin());
  if (from > end) {
    close();
    if (from > end) {  // whole seconds without a bit
      last = {};
      end += second * ((from - end + second - Duration(1)) / second);
    }
  }
  while (until > end) {
    busy += end - from;
    from = end;
    close();
  }
  if (until > from) busy += until - from;
}

BusLoad BusStatistics::load(Time now, std::initializer_list<Time> under_way) const noexcept {
  Seconds seconds = now < seconds_.begin() ? before_ : seconds_;
  for (const Time from : under_way) {
    if (from < now) seconds.add(from, now);
  }
  if (now >= seconds.end) {
    const bool has_just_ended = now < seconds.end + second;
    seconds.close();
    if (!has_just_ended) seconds.last = {};
  }
  return {.frames = frames_,
          .error_frames = error_frames_,
          .bits = bits_,
          .now = share(seconds.last),
          .peak = share(seconds.peak)};
}

}  // namespace canopus::can
