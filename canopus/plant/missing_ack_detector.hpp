#pragma once

#include "canopus/can/bus.hpp"

namespace canopus::plant {

/// Detects on a bus that a controller's frames get no acknowledge: it is the only node there.
class MissingAckDetector {
 public:
  /// As BusObserver::error_detected(). True once, when the frames of one port stayed without acknowledgement
  /// for attempts_that_count attempts in a row; then again only after a frame was transmitted.
  bool error_detected(const can::Port& port, can::BusError error) noexcept {
    const bool unacknowledged = error == can::BusError::acknowledgement;
    // Errors of a receiver do not count for the transmitter.
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
