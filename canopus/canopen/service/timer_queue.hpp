#pragma once
// The timers of one node in order of their deadlines: a binary heap of timer numbers. All timers are made at
// construction; starting, moving and stopping one costs O(log n) and allocates nothing. Equal deadlines come
// in order of number.

#include <cstdint>
#include <vector>

#include "canopus/can/alarm.hpp"
#include "canopus/can/time.hpp"

namespace canopus::canopen {

class TimerQueue {
 public:
  using Number = std::uint16_t;

  /// `alarm`, which is not set, stands at the earliest deadline from the first set() on; it must outlive the queue.
  explicit TimerQueue(can::Alarm& alarm) noexcept : alarm_(&alarm) {}

  /// Makes `count` timers with consecutive numbers; returns the first number.
  Number add(std::size_t count = 1);
  /// Starts or moves a timer; can::never stops it.
  void set(Number number, can::Time deadline) noexcept {
    if (deadlines_[number] != deadline) change(number, deadline);
  }
  void stop(Number number) noexcept { set(number, can::never); }
  [[nodiscard]] bool runs(Number number) const noexcept { return positions_[number] != stopped; }
  [[nodiscard]] can::Time deadline(Number number) const noexcept { return deadlines_[number]; }
  void stop_all() noexcept;
  [[nodiscard]] std::size_t size() const noexcept { return deadlines_.size(); }

  /// The earliest deadline, or never.
  [[nodiscard]] can::Time next() const noexcept { return alarm_->deadline(); }
  /// Stops the earliest timer, which must exist, and returns its number.
  Number pop() noexcept;

 private:
  static constexpr std::uint16_t stopped = 0xFFFF;
  void change(Number number, can::Time deadline) noexcept;
  void move(Number number, can::Time deadline) noexcept;
  [[nodiscard]] bool before(Number left, Number right) const noexcept;
  void place(std::size_t position, Number number) noexcept;
  void sift_up(std::size_t position) noexcept;
  void sift_down(std::size_t position) noexcept;

  std::vector<std::uint16_t> positions_;  // in heap_
  std::vector<Number> heap_;
  std::vector<can::Time> deadlines_;
  can::Alarm* alarm_;
};

}  // namespace canopus::canopen
