#include "canopus/manager/sdo_line.hpp"

namespace canopus::manager {

bool SdoLine::send(const can::Frame& request, can::Sink& sink, can::Time now) {
  if (!is_told_) return sink.send(request);
  if (count_ == 0 && in_flight_ < at_once) return hand_over(request, sink, now);
  if (count_ == places) return false;
  waiting_[(first_ + count_++) % places] = request;
  if (now - last_ > stall) {
    in_flight_ = 0;
    release(sink, now);
  }
  return true;
}

void SdoLine::transmitted(can::Sink& sink, can::Time now) {
  is_told_ = true;
  last_ = now;
  if (in_flight_ > 0) --in_flight_;
  release(sink, now);
}

bool SdoLine::waits(std::uint32_t identifier, can::Time now) const noexcept {
  if (now - last_ > stall) return false;
  for (std::size_t i = 0; i < count_; ++i) {
    if (waiting_[(first_ + i) % places].identifier == identifier) return true;
  }
  return false;
}

bool SdoLine::hand_over(const can::Frame& request, can::Sink& sink, can::Time now) {
  // Counted first: on a bus that is a function call, the transmission is told from inside.
  ++in_flight_;
  last_ = now;
  if (sink.send(request)) return true;
  --in_flight_;
  return false;
}

void SdoLine::release(can::Sink& sink, can::Time now) {
  while (count_ > 0 && in_flight_ < at_once) {
    const can::Frame request = waiting_[first_];
    first_ = (first_ + 1) % places;
    --count_;
    if (hand_over(request, sink, now)) continue;
    first_ = (first_ + places - 1) % places;  // no room: it stays the first one
    ++count_;
    return;
  }
}

}  // namespace canopus::manager
