#pragma once
// Heartbeat producer [CiA 301 7.2.8.3.2.2]: the frame 700H + node-ID with one byte, the NMT state, every
// 1017H milliseconds (0 = off) in every state but Initialisation. The boot-up message counts as the first
// one; a new value takes effect at once: the next heartbeat follows one new period after the write.

#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class HeartbeatProducer final : public ObjectHandler {
 public:
  explicit HeartbeatProducer(NodeContext& node);

  /// Reads 1017H and starts anew: the boot-up message has just been sent.
  void start(can::Time now);
  void stop();
  /// No heartbeats while paused, whatever 1017H says.
  void pause(bool paused, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] bool is_active() const noexcept { return period_ != can::Duration{}; }
  [[nodiscard]] TimerQueue::Number timer() const noexcept { return timer_; }

  void after_write(ObjectDictionary&, const Entry&, can::Time now) override { start(now); }

 private:
  NodeContext& node_;
  TimerQueue::Number timer_;
  can::Duration period_{};
  can::Time next_{};
  bool paused_ = false;
};

}  // namespace canopus::canopen
