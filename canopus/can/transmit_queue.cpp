#include "canopus/can/transmit_queue.hpp"

#include <algorithm>
#include <limits>

namespace canopus::can {

namespace {
constexpr std::uint32_t first_frames = 8;
}

void TransmitQueue::configure(bool sorted, std::size_t capacity) {
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
  capacity_ = static_cast<std::uint32_t>(std::clamp<std::size_t>(capacity, 1, most));
  sorted_ = sorted;
  clear();
}

void TransmitQueue::make_room() {
  const std::uint32_t wanted = std::max(first_frames, 2 * room_);
  auto larger = std::make_unique<Frame[]>(wanted);
  std::copy(frames_ + begin_, frames_ + end_, larger.get());
  end_ -= begin_;
  begin_ = 0;
  more_ = std::move(larger);
  frames_ = more_.get();
  room_ = wanted;
}

bool TransmitQueue::push_behind(const Frame& frame, std::size_t reserved) {
  if (size() + reserved >= capacity_) return false;
  // One frame that is on the wire may come back any time: there is always room for it.
  if (size() + 1 + std::min<std::size_t>(reserved, 1) > room_) make_room();
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
  Frame* const end = frames_ + end_;
  Frame* const found = std::find(frames_ + begin_, end, frame);
  if (found == end) return;
  std::copy(found + 1, end, found);
  --end_;
}

void TransmitQueue::insert(std::size_t position, const Frame& frame) noexcept {
  if (begin_ > 0 && position == begin_) {
    frames_[--begin_] = frame;
    return;
  }
  if (end_ == room_) {  // once per room, not per frame
    std::copy(frames_ + begin_, frames_ + end_, frames_);
    position -= begin_;
    end_ -= begin_;
    begin_ = 0;
  }
  std::copy_backward(frames_ + position, frames_ + end_, frames_ + end_ + 1);
  ++end_;
  frames_[position] = frame;
}

}  // namespace canopus::can
