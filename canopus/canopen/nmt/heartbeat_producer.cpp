#include "canopus/canopen/nmt/heartbeat_producer.hpp"

namespace canopus::canopen {

HeartbeatProducer::HeartbeatProducer(NodeContext& node) : node_(node), timer_(node.timers.add()) {
  node.dictionary.attach(0x1017, 0x1017, *this);
}

void HeartbeatProducer::start(can::Time now) {
  if (node_.state == NmtState::initialising) return;
  const std::uint16_t milliseconds = paused_ ? 0 : node_.dictionary.get<std::uint16_t>(0x1017, 0);
  period_ = std::chrono::milliseconds(milliseconds);
  next_ = is_active() ? can::later(now, period_) : can::never;
  node_.timers.set(timer_, next_);
}

void HeartbeatProducer::pause(bool paused, can::Time now) {
  if (paused_ == paused) return;
  paused_ = paused;
  start(now);
}

void HeartbeatProducer::stop() {
  period_ = {};
  node_.timers.stop(timer_);
}

void HeartbeatProducer::tick(can::Time now) {
  node_.sink.send(
      can::data_frame(cob_id::error_control + node_.node_id, {static_cast<std::uint8_t>(node_.state)}));
  next_ += period_;  // without drift, unless whole periods were slept through
  if (next_ <= now) next_ = now + period_;
  node_.timers.set(timer_, next_);
}

}  // namespace canopus::canopen
