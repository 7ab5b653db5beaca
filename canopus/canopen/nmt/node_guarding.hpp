#pragma once
// Node guarding, the slave's side [CiA 301 7.2.8.3.2.1]: the NMT master asks with a remote frame 700H +
// node-ID; the answer is one byte, bits 0-6 the NMT state, bit 7 a toggle bit that is 0 in the first answer
// after reset communication. While the heartbeat producer is on (1017H not 0) nothing is answered, and no
// remote frame is missed.
//
// Life guarding: 100CH (guard time, ms) times 100DH (life time factor), when not 0, is the time within which
// the next remote frame has to come, counted from the first one on. If it does not, the life guarding event
// has occurred: EMCY 8130H, 1029H, NodeListener::life_guarding_event(true); the next remote frame ends it. Before that, the
// guard time alone is over: NodeListener::life_guarding_missed().

#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class NodeGuarding final : public ObjectHandler {
 public:
  explicit NodeGuarding(NodeContext& node);

  /// Toggle bit 0, no remote frame yet.
  void start();
  void stop();
  /// The master's remote frame came; `heartbeat`: this node produces one.
  void receive(bool heartbeat, can::Time now);
  /// The guard time is over, or the life time.
  void tick(bool heartbeat, can::Time now);
  [[nodiscard]] TimerQueue::Number timer() const noexcept { return timer_; }

  /// A new life time counts from now on, if the master has asked before.
  void after_write(ObjectDictionary&, const Entry&, can::Time now) override;

 private:
  void restart(can::Time now);
  void set_running(bool running, can::Time now);
  void miss(can::Time now);

  NodeContext& node_;
  TimerQueue::Number timer_;
  can::Time life_end_ = can::never;
  bool toggle_ = false;
  bool guarded_ = false;   // a remote frame came since start()
  bool occurred_ = false;  // the life guarding event
  bool running_ = false;   // a life time runs
  bool missed_ = false;    // the guard time was over since the last remote frame
};

}  // namespace canopus::canopen
