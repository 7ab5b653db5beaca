#pragma once
// How busy a bus is: frames and bits in all, per identifier, and the share of each second that was busy.

#include <array>
#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::can {

struct BusLoad;

class BusStatistics {
 public:
  BusStatistics();
  /// A frame was completed. No allocation.
  void frame(const Frame& frame) noexcept {
    ++frames_;
    if (!frame.extended) {
      ++base_[frame.identifier & max_base_identifier];
    } else {
      count_extended(frame.identifier);
    }
  }
  void error_frame() noexcept { ++error_frames_; }
  /// The wire was not idle from `start` to `end`, which may be some bits ahead of the present.
  void busy(Time start, Time end, std::uint64_t bits) noexcept {
    bits_ += bits;
    if (end > seconds_.end) before_ = seconds_;
    seconds_.add(start, end);
  }
  /// `under_way`: when activities began that busy() is still to count; never: there is none. What of them is over by now counts, too:
  /// how a bus divides its time must not depend on when it is reported.
  [[nodiscard]] BusLoad load(Time now, std::initializer_list<Time> under_way = {}) const noexcept;
  [[nodiscard]] std::uint64_t frames_of(std::uint32_t identifier, bool extended) const noexcept;

 private:
  struct Extended {
    std::uint32_t identifier = 0;
    std::uint64_t frames = 0;  // 0: free
  };
  /// Of the second that is counted, and of those before it, how long the wire was busy.
  struct Seconds {
    Time end = Time{} + std::chrono::seconds(1);  // of the one that is counted
    Duration busy{};
    Duration last{};
    Duration peak{};

    [[nodiscard]] Time begin() const noexcept { return end - std::chrono::seconds(1); }
    void add(Time from, Time until) noexcept {
      if (until > end || from < begin()) {
        add_across(from, until);
      } else {
        busy += until - from;
      }
    }
    void add_across(Time from, Time until) noexcept;
    void close() noexcept;
  };
  void count_extended(std::uint32_t identifier) noexcept;
  [[nodiscard]] std::size_t slot_of(std::uint32_t identifier) const noexcept;

  std::uint64_t frames_ = 0;
  std::uint64_t error_frames_ = 0;
  std::uint64_t bits_ = 0;
  Seconds seconds_;
  Seconds before_;  // what it was when it came to another second
  std::array<std::uint64_t, 2048> base_{};
  std::vector<Extended> extended_;  // open addressing
  std::size_t extended_used_ = 0;
};

}  // namespace canopus::can
