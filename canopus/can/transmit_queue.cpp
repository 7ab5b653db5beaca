#include "canopus/can/transmit_queue.hpp"

#include <algorithm>

namespace canopus::can {

namespace {
constexpr std::size_t first_frames = 8;
}

void TransmitQueue::configure(bool sorted, std::size_t capacity) {
  capacity_ = std::max<std::size_t>(capacity, 1);
  frames_.assign(std::min(capacity_, first_frames), {});
  sorted_ = sorted;
  clear();
}

// One frame that is on the wire may come back any time: there is always room for it.
void TransmitQueue::make_room() { frames_.resize(std::min(capacity_, 2 * frames_.size())); }

bool TransmitQueue::push_behind(const Frame& frame, std::size_t reserved) {
  if (size() + reserved >= capacity_) return false;
  if (size() + 1 >= frames_.size() && frames_.size() < capacity_) make_room();
  std::size_t position = end_;
  if (sorted_) {
    const std::uint32_t priority = arbitration(frame);
    while (position > begin_ && arbitration(frames_[position - 1]) > priority) --position;
  }
  insert(position, frame);
  return true;
}

void TransmitQueue::push_back_again(const Frame& frame) noexcept {
  std::size_t position = begin_;
  if (sorted_) {
    const std::uint32_t priority = arbitration(frame);
    while (position < end_ && arbitration(frames_[position]) < priority) ++position;
  }
  insert(position, frame);
}

void TransmitQueue::remove(const Frame& frame) noexcept {
  const auto begin = frames_.begin() + static_cast<std::ptrdiff_t>(begin_);
  const auto end = frames_.begin() + static_cast<std::ptrdiff_t>(end_);
  const auto found = std::find(begin, end, frame);
  if (found == end) return;
  std::copy(found + 1, end, found);
  --end_;
}

void TransmitQueue::insert(std::size_t position, const Frame& frame) noexcept {
  const auto at = [this](std::size_t slot) { return frames_.begin() + static_cast<std::ptrdiff_t>(slot); };
  if (begin_ > 0 && position == begin_) {
    frames_[--begin_] = frame;
    return;
  }
  if (end_ == frames_.size()) {  // once per capacity, not per frame
    std::copy(at(begin_), at(end_), at(0));
    position -= begin_;
    end_ -= begin_;
    begin_ = 0;
  }
  std::copy_backward(at(position), at(end_), at(end_ + 1));
  ++end_;
  frames_[position] = frame;
}

}  // namespace canopus::can
