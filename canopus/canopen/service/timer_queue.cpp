#include "canopus/canopen/service/timer_queue.hpp"

#include <utility>

namespace canopus::canopen {

TimerQueue::Number TimerQueue::add(std::size_t count) {
  const auto first = static_cast<Number>(size());
  deadlines_.resize(size() + count, can::never);
  positions_.resize(size(), stopped);
  heap_.reserve(size());
  return first;
}

bool TimerQueue::before(Number left, Number right) const noexcept {
  if (deadlines_[left] != deadlines_[right]) return deadlines_[left] < deadlines_[right];
  return left < right;
}

void TimerQueue::place(std::size_t position, Number number) noexcept {
  heap_[position] = number;
  positions_[number] = static_cast<std::uint16_t>(position);
}

void TimerQueue::sift_up(std::size_t position) noexcept {
  const Number number = heap_[position];
  while (position > 0) {
    const std::size_t parent = (position - 1) / 2;
    if (!before(number, heap_[parent])) break;
    place(position, heap_[parent]);
    position = parent;
  }
  place(position, number);
}

void TimerQueue::sift_down(std::size_t position) noexcept {
  const Number number = heap_[position];
  for (;;) {
    std::size_t child = 2 * position + 1;
    if (child >= heap_.size()) break;
    if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
    if (!before(heap_[child], number)) break;
    place(position, heap_[child]);
    position = child;
  }
  place(position, number);
}

void TimerQueue::change(Number number, can::Time deadline) noexcept {
  move(number, deadline);
  alarm_->set(heap_.empty() ? can::never : deadlines_[heap_.front()]);
}

void TimerQueue::move(Number number, can::Time deadline) noexcept {
  const std::uint16_t position = positions_[number];
  const can::Time before = std::exchange(deadlines_[number], deadline);
  if (position == stopped) {
    if (deadline == can::never) return;
    heap_.push_back(number);
    sift_up(heap_.size() - 1);
    return;
  }
  if (deadline != can::never) {
    deadline < before ? sift_up(position) : sift_down(position);
    return;
  }
  positions_[number] = stopped;
  const Number last = heap_.back();
  heap_.pop_back();
  if (last == number) return;
  place(position, last);
  sift_up(position);
  sift_down(positions_[last]);
}

void TimerQueue::stop_all() noexcept {
  for (const Number number : heap_) {
    deadlines_[number] = can::never;
    positions_[number] = stopped;
  }
  heap_.clear();
  alarm_->cancel();
}

TimerQueue::Number TimerQueue::pop() noexcept {
  const Number number = heap_.front();
  stop(number);
  return number;
}

}  // namespace canopus::canopen
