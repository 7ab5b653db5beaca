#include "canopus/web/state/arbitration_probe.hpp"

#include <algorithm>

namespace canopus::web {

const ArbitrationProbe::Arbitration& ArbitrationProbe::arbitration_of(std::uint32_t identifier,
                                                                      bool extended) {
  const auto known = std::ranges::find_if(frames_, [&](const Arbitration& one) {
    return one.identifier == identifier && one.extended == extended;
  });
  if (known != frames_.end()) return *known;
  if (frames_.size() < most_frames) return frames_.emplace_back(Arbitration{identifier, extended});
  Arbitration& oldest = frames_[next_frame_++ % most_frames];
  oldest = {identifier, extended};
  return oldest;
}

std::optional<bool> ArbitrationProbe::is_dominant(can::Time at) const noexcept {
  // The newest change before that moment; before the oldest one of the ring the level is not known.
  for (std::size_t i = 1; i <= most_changes && i <= next_change_; ++i) {
    const Change& change = changes_[(next_change_ - i) % most_changes];
    if (change.at <= at) return change.dominant;
  }
  return std::nullopt;
}

void ArbitrationProbe::note(const can::Frame& frame, can::Time start,
                            std::span<const sim::WireFrame::Sender> senders) {
  for (Arbitration& one : frames_) {
    if (one.identifier != frame.identifier || one.extended != frame.extended) continue;
    one.start = start;
    one.senders.assign(senders.begin(), senders.end());
  }
}

void ArbitrationProbe::frame_passed(const sim::WireFrame& frame) {
  note(frame.frame, frame.start, frame.senders);
}

void ArbitrationProbe::arbitration_passed(const sim::WireArbitration& arbitration) {
  note(arbitration.frame, arbitration.start, arbitration.senders);
}

void ArbitrationProbe::level_changed(bool dominant, can::Time now) {
  changes_[next_change_++ % most_changes] = {now, dominant};
}

}  // namespace canopus::web
