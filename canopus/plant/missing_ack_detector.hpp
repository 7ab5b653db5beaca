#pragma once

#include "canopus/can/bus.hpp"

namespace canopus::plant {

/// Notices on a bus that nobody acknowledges a controller's frames: it is alone there.
class MissingAckDetector {
 public:
  /// As BusObserver::error_detected(). True once, when the frames of one port stayed without acknowledgement
  /// for so many attempts in a row; then again only after somebody completed a frame.
  bool error_detected(const can::Port& port, can::BusError error) noexcept {
    const bool unacknowledged = error == can::BusError::acknowledgement;
    // What a listener makes of it says nothing of the sender.
    if (reported_ || (!unacknowledged && &port != port_)) return false;
    attempts_ = !unacknowledged ? 0 : &port == port_ ? attempts_ + 1 : 1;
    port_ = &port;
    reported_ = attempts_ == attempts_that_count;
    return reported_;
  }
  /// As BusObserver::frame_completed().
  void frame_completed() noexcept {
    attempts_ = 0;
    reported_ = false;
  }

 private:
  /// One may be a disturbed acknowledgement slot.
  static constexpr unsigned attempts_that_count = 8;
  const can::Port* port_ = nullptr;
  unsigned attempts_ = 0;
  bool reported_ = false;
};

}  // namespace canopus::plant
