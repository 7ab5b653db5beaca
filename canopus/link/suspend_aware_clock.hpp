#pragma once
// A clock for response timeouts. A suspended machine (a virtual one without a processor, a sleeping laptop)
// may have stopped the responders as well: such time must not count as silence.

#include <algorithm>

#include "canopus/can/time.hpp"

namespace canopus::link {

class SuspendAwareClock {
 public:
  /// The most that is counted between two calls.
  static constexpr can::Duration most = std::chrono::milliseconds(50);
  /// The longest interval between two calls.
  static constexpr can::Duration often = std::chrono::milliseconds(10);

  /// The counted time when the real clock is at `real` since the start. Monotonic.
  [[nodiscard]] can::Duration at(can::Duration real) const noexcept {
    return counted_ + std::clamp(real - seen_, can::Duration{0}, most);
  }
  /// Counts on from here as if all before had been seen.
  void start(can::Duration real) noexcept { counted_ = seen_ = real; }
  void advance(can::Duration real) noexcept {
    counted_ = at(real);
    seen_ = std::max(seen_, real);
  }

 private:
  can::Duration seen_{0};
  can::Duration counted_{0};
};

}  // namespace canopus::link
