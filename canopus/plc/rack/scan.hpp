#pragma once
// The scans of a CPU. They have one length and follow each other from the moment the supply comes, so that their
// number is a matter of time alone.

#include <chrono>
#include <cstdint>

#include "canopus/can/time.hpp"

namespace canopus::plc {

class Scan {
 public:
  /// The default scan time.
  static constexpr can::Duration default_period = std::chrono::milliseconds(10);
  static constexpr can::Duration shortest_period = std::chrono::microseconds(100);
  /// The longest one that the watchdog timer setting of a Q CPU permits.
  static constexpr can::Duration longest_period = std::chrono::milliseconds(2000);

  explicit Scan(can::Duration period) noexcept : period_(period) {}

  [[nodiscard]] can::Duration period() const noexcept { return period_; }

  /// The supply came: the first scan begins.
  void start(can::Time now) noexcept {
    start_ = now;
    counted_ = 0;
    is_counting_ = false;
  }
  /// From STOP to RUN: the count restarts, and the next scan to end is the first one.
  void run(can::Time now) noexcept {
    counted_ = 0;
    is_counting_ = false;
    resume(now);
  }
  /// Back from PAUSE: they are counted on.
  void resume(can::Time now) noexcept {
    counting_since_ = ended(now);
    is_counting_ = true;
  }
  /// To STOP or PAUSE: what was counted stays.
  void stop(can::Time now) noexcept {
    counted_ = count(now);
    is_counting_ = false;
  }

  /// Scans that have ended since the supply came, in STOP too.
  [[nodiscard]] std::uint64_t ended(can::Time now) const noexcept {
    return static_cast<std::uint64_t>((now - start_) / period_);
  }
  /// The time at which this number of further scans has ended; never on overflow.
  [[nodiscard]] can::Time end_of(std::uint64_t scans, can::Time now) const noexcept {
    const can::Time last = start_ + static_cast<std::int64_t>(ended(now)) * period_;
    if (scans > static_cast<std::uint64_t>((can::never - last) / period_)) return can::never;
    return last + static_cast<std::int64_t>(scans) * period_;
  }
  /// Scans that have ended since RUN.
  [[nodiscard]] std::uint64_t count(can::Time now) const noexcept {
    return counted_ + (is_counting_ ? ended(now) - counting_since_ : 0);
  }
  /// In RUN, and no scan has ended since.
  [[nodiscard]] bool is_first(can::Time now) const noexcept { return is_counting_ && count(now) == 0; }

 private:
  can::Duration period_;
  can::Time start_{};
  std::uint64_t counted_ = 0;         // up to the last STOP or PAUSE
  std::uint64_t counting_since_ = 0;  // scan number
  bool is_counting_ = false;
};

}  // namespace canopus::plc
