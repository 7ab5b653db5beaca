#include "canopus/can/timeline.hpp"

#include <utility>

namespace canopus::can {

bool Timeline::before(Handle left, Handle right) const noexcept {
  const Slot& a = slots_[left];
  const Slot& b = slots_[right];
  if (a.deadline != b.deadline) return a.deadline < b.deadline;
  return a.rank != b.rank ? a.rank < b.rank : left < right;
}

void Timeline::sift_up(std::size_t position) noexcept {
  const Handle moving = heap_[position];
  while (position > 0) {
    const std::size_t parent = (position - 1) / 2;
    if (!before(moving, heap_[parent])) break;
    heap_[position] = heap_[parent];
    slots_[heap_[position]].position = position;
    position = parent;
  }
  heap_[position] = moving;
  slots_[moving].position = position;
}

void Timeline::sift_down(std::size_t position) noexcept {
  const Handle moving = heap_[position];
  while (true) {
    std::size_t child = 2 * position + 1;
    if (child >= heap_.size()) break;
    if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
    if (!before(heap_[child], moving)) break;
    heap_[position] = heap_[child];
    slots_[heap_[position]].position = position;
    position = child;
  }
  heap_[position] = moving;
  slots_[moving].position = position;
}

Timeline::Handle Timeline::add(Participant& participant, Rank rank) {
  const Handle handle = slots_.size();
  slots_.push_back({&participant, rank, participant.deadline(), heap_.size()});
  heap_.push_back(handle);
  sift_up(heap_.size() - 1);
  return handle;
}

void Timeline::remove(Handle handle) {
  const std::size_t position = slots_[handle].position;
  if (slots_[handle].participant == nullptr) return;
  slots_[handle].participant = nullptr;
  const Handle last = heap_.back();
  heap_.pop_back();
  if (last == handle) return;
  heap_[position] = last;
  slots_[last].position = position;
  sift_up(position);
  sift_down(slots_[last].position);
}

void Timeline::move(Handle handle, Time deadline) noexcept {
  Slot& slot = slots_[handle];
  const bool earlier = deadline < slot.deadline;
  slot.deadline = deadline;
  if (earlier) {
    sift_up(slot.position);
  } else {
    sift_down(slot.position);
  }
}

Time Timeline::next() const noexcept { return heap_.empty() ? never : slots_[heap_.front()].deadline; }

void Timeline::run_until(Time end) {
  while (!heap_.empty()) {
    const Handle handle = heap_.front();
    const Time deadline = slots_[handle].deadline;
    if (deadline > end) break;
    if (deadline > now_) now_ = deadline;
    slots_[handle].participant->tick(now_);
    refresh(handle);
  }
  if (end > now_) now_ = end;
}

}  // namespace canopus::can
