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

BusStatistics::BusStatistics() : second_end_(second), extended_(extended_slots) {}

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

void BusStatistics::close_second() noexcept {
  last_ = share(busy_);
  peak_ = std::max(peak_, last_);
  busy_ = {};
  second_end_ += second;
}

void BusStatistics::roll(Time start, Time end) noexcept {
  if (start > second_end_) {
    close_second();
    if (start > second_end_) {  // whole seconds without a bit
      last_ = 0;
      second_end_ += second * ((start - second_end_ + second - Duration(1)) / second);
    }
  }
  while (end > second_end_) {
    busy_ += second_end_ - start;
    start = second_end_;
    close_second();
  }
  busy_ += end - start;
}

BusLoad BusStatistics::load(Time now) const noexcept {
  BusLoad load{.frames = frames_, .error_frames = error_frames_, .bits = bits_, .now = last_, .peak = peak_};
  if (now >= second_end_) {
    const bool just_ended = now < second_end_ + second;
    load.now = just_ended ? share(busy_) : 0;
    load.peak = std::max(load.peak, share(busy_));
  }
  return load;
}

}  // namespace canopus::can
