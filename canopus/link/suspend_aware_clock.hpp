#pragma once
// A clock for those who wait for answers. A machine that stands still (a virtual one without a processor, a
// laptop that sleeps) may have stopped those who were to answer as well: such time must not count as silence.

#include <algorithm>

#include "canopus/can/time.hpp"

namespace canopus::link {

class SuspendAwareClock {
 public:
  /// Between two looks no more than this is counted.
  static constexpr can::Duration most = std::chrono::milliseconds(50);
  /// How often it is to be looked at.
  static constexpr can::Duration often = std::chrono::milliseconds(10);

  /// What is counted when the real clock has come to `real` since the start. Looks forward only.
  [[nodiscard]] can::Duration at(can::Duration real) const noexcept {
    return counted_ + std::clamp(real - seen_, can::Duration{0}, most);
  }
  /// Counts on from here as if all before had been seen.
  void start(can::Duration real) noexcept { counted_ = seen_ = real; }
  void look(can::Duration real) noexcept {
    counted_ = at(real);
    seen_ = std::max(seen_, real);
  }

 private:
  can::Duration seen_{0};
  can::Duration counted_{0};
};

}  // namespace canopus::link
