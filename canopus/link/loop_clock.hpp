#pragma once
// What a server needs of the event loop that owns the bus it serves: what time it is on that bus, and a way
// to say that something happened there outside the bus's own schedule.

#include "canopus/can/time.hpp"

namespace canopus::link {

class LoopClock {
 public:
  /// The present moment. The loop brings the bus up to it before it answers, so a frame sent next enters the
  /// bus at this time and not at the time of the bus's last event. Not to be called from a bus callback.
  virtual can::Time now() = 0;
  /// A frame was queued or a deadline changed: the loop asks the timeline anew how long it may sleep.
  virtual void touched() = 0;
  /// After now() and an access that may have done so, by who has got his answer and waits for nothing that comes of it: a
  /// loop that has many of them a second need not become more punctual for them.
  virtual void accessed() { touched(); }

 protected:
  ~LoopClock() = default;
};

}  // namespace canopus::link
