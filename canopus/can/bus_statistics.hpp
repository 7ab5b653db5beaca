#pragma once
// How busy a bus is: frames and bits in all, per identifier, and the share of each second that was busy.

#include <array>
#include <cstdint>
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
  /// The wire was not idle from `start` to `end`, which is not before the end of the last call.
  void busy(Time start, Time end, std::uint64_t bits) noexcept {
    bits_ += bits;
    if (end > second_end_) {
      roll(start, end);
    } else {
      busy_ += end - start;
    }
  }
  [[nodiscard]] BusLoad load(Time now) const noexcept;
  [[nodiscard]] std::uint64_t frames_of(std::uint32_t identifier, bool extended) const noexcept;

 private:
  struct Extended {
    std::uint32_t identifier = 0;
    std::uint64_t frames = 0;  // 0: free
  };
  void count_extended(std::uint32_t identifier) noexcept;
  [[nodiscard]] std::size_t slot_of(std::uint32_t identifier) const noexcept;
  void roll(Time start, Time end) noexcept;
  void close_second() noexcept;

  std::uint64_t frames_ = 0;
  std::uint64_t error_frames_ = 0;
  std::uint64_t bits_ = 0;
  Time second_end_;  // of the second that busy_ counts
  Duration busy_{};
  double last_ = 0;  // of the second before
  double peak_ = 0;
  std::array<std::uint64_t, 2048> base_{};
  std::vector<Extended> extended_;  // open addressing
  std::size_t extended_used_ = 0;
};

}  // namespace canopus::can
