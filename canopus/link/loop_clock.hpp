#pragma once
// The interface of a server to the event loop that owns its bus: the time on that bus, and a notification of
// events outside the bus's own schedule.

#include "canopus/can/time.hpp"

namespace canopus::link {

class LoopClock {
 public:
  /// The present moment. The loop brings the bus up to it before it answers, so a frame sent next enters the
  /// bus at this time and not at the time of the bus's last event. Must not be called from a bus callback.
  virtual can::Time now() = 0;
  /// A frame was queued or a deadline changed: the loop reads the next deadline of the timeline again.
  virtual void touched() = 0;
  /// Call it after now() and such an access when the client already has its answer and waits for no
  /// consequence: with many of these a second the loop's timer need not be more exact.
  virtual void accessed() { touched(); }

 protected:
  ~LoopClock() = default;
};

}  // namespace canopus::link
