#include "canopus/sim/bus/waveform/waveform_fields.hpp"

#include <algorithm>
#include <utility>

namespace canopus::sim {

using can::FrameField;

void WaveformFields::set_all(FrameField field) noexcept {
  std::ranges::fill(fields_, field);
  counts_ = {};
  counts_[number(field)] = fields_.size();
  has_changed_ = true;
}

void WaveformFields::replace(FrameField one, FrameField other) noexcept {
  for (FrameField& field : fields_) field = field == one ? other : field;  // no branch: many at once
  counts_[number(other)] += std::exchange(counts_[number(one)], 0);
  has_changed_ = true;
}

/// That of a frame in which most ports are; of two with as many the later one. Idle and suspended ports are in none.
FrameField WaveformFields::most_common() const noexcept {
  FrameField common = FrameField::idle;
  std::size_t most = 0;
  for (std::size_t field = 1; field < counts_.size(); ++field) {
    if (field == number(FrameField::suspend) || counts_[field] == 0 || counts_[field] < most) continue;
    common = static_cast<FrameField>(field);
    most = counts_[field];
  }
  return common;
}

/// A receiver knows of a SOF when that is over. An idle port that was reported as idle stays so: one that is switched off
/// does not change with each frame of the others.
int WaveformFields::value_of(std::size_t port) const noexcept {
  const FrameField field = fields_[port];
  if (reported_[port] == as_bus) {
    const bool will_know = field == FrameField::idle && bus_ == FrameField::start_of_frame;
    return field == bus_ || will_know ? as_bus : static_cast<int>(field);
  }
  return field == bus_ && field != FrameField::idle ? as_bus : static_cast<int>(field);
}

}  // namespace canopus::sim
