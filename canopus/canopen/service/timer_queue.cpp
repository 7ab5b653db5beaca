#include "canopus/canopen/service/timer_queue.hpp"

namespace canopus::canopen {

TimerQueue::Number TimerQueue::add(std::size_t count) {
  const auto first = static_cast<Number>(timers_.size());
  timers_.resize(timers_.size() + count);
  heap_.reserve(timers_.size());
  return first;
}

bool TimerQueue::before(Number left, Number right) const noexcept {
  if (timers_[left].deadline != timers_[right].deadline) {
    return timers_[left].deadline < timers_[right].deadline;
  }
  return left < right;
}

void TimerQueue::place(std::size_t position, Number number) noexcept {
  heap_[position] = number;
  timers_[number].position = static_cast<std::uint16_t>(position);
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

void TimerQueue::set(Number number, can::Time deadline) noexcept {
  Timer& timer = timers_[number];
  if (timer.position == stopped) {
    if (deadline == can::never) return;
    timer.deadline = deadline;
    heap_.push_back(number);
    sift_up(heap_.size() - 1);
    return;
  }
  const std::size_t position = timer.position;
  if (deadline != can::never) {
    const bool earlier = deadline < timer.deadline;
    timer.deadline = deadline;
    earlier ? sift_up(position) : sift_down(position);
    return;
  }
  timer.deadline = can::never;
  timer.position = stopped;
  const Number last = heap_.back();
  heap_.pop_back();
  if (last == number) return;
  place(position, last);
  sift_up(position);
  sift_down(timers_[last].position);
}

void TimerQueue::stop_all() noexcept {
  for (const Number number : heap_) timers_[number] = {};
  heap_.clear();
}

TimerQueue::Number TimerQueue::pop() noexcept {
  const Number number = heap_.front();
  stop(number);
  return number;
}

}  // namespace canopus::canopen
