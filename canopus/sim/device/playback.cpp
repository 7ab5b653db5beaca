#include "canopus/sim/device/playback.hpp"

#include <algorithm>

namespace canopus::sim {

void Playback::add(can::Duration time, std::span<const Value> values) {
  const std::size_t above = values_.size();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Value value = i < values.size() ? values[i] : std::nullopt;
    if (!value && above != 0) value = values_[above - entries_.size() + i];
    values_.push_back(value);
  }
  times_.push_back(time);
}

can::Duration Playback::cycle() const noexcept {
  if (!repeats_ || times_.size() < 2) return {};
  return times_.back() + (times_.back() - times_[times_.size() - 2]);
}

std::span<const Playback::Value> Playback::at(can::Time now) const noexcept {
  can::Duration elapsed = now.time_since_epoch();
  const can::Duration length = cycle();
  const bool is_again = length != can::Duration{} && elapsed >= length;
  if (is_again) elapsed %= length;
  const auto after = std::ranges::upper_bound(times_, elapsed);
  if (after == times_.begin() && !is_again) return {};
  // Before the first row of a further cycle the last one of the cycle before holds.
  const auto row =
      static_cast<std::size_t>((after == times_.begin() ? times_.end() : after) - times_.begin()) - 1;
  return std::span(values_).subspan(row * entries_.size(), entries_.size());
}

can::Time Playback::next_after(can::Time now) const noexcept {
  const can::Duration elapsed = now.time_since_epoch();
  const can::Duration length = cycle();
  const can::Duration begin = length == can::Duration{} ? can::Duration{} : elapsed - elapsed % length;
  const auto next = std::ranges::upper_bound(times_, elapsed - begin);
  if (next != times_.end()) return can::Time{} + begin + *next;
  return length == can::Duration{} ? can::never : can::Time{} + begin + length + times_.front();
}

}  // namespace canopus::sim
