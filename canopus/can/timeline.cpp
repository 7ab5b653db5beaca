#include "canopus/can/timeline.hpp"

#include <cstdio>
#include <stdexcept>
#include <utility>

namespace canopus::can {

void Timeline::sift_up(std::size_t position) noexcept {
  const Place moving = heap_[position];
  while (position > 0) {
    const std::size_t parent = (position - 1) / 2;
    if (!moving.before(heap_[parent])) break;
    put(position, heap_[parent]);
    position = parent;
  }
  put(position, moving);
}

void Timeline::sift_down(std::size_t position) noexcept {
  const Place moving = heap_[position];
  const std::size_t size = heap_.size();
  while (true) {
    std::size_t child = 2 * position + 1;
    if (child >= size) break;
    if (child + 1 < size && heap_[child + 1].before(heap_[child])) ++child;
    if (!heap_[child].before(moving)) break;
    put(position, heap_[child]);
    position = child;
  }
  put(position, moving);
}

Timeline::Handle Timeline::add(Ticker& participant, std::string name, Rank rank) {
  const Handle handle = slots_.size();
  const auto position = static_cast<std::uint32_t>(heap_.size());
  slots_.push_back({&participant, participant.deadline(), position});
  names_.push_back(std::move(name));
  heap_.push_back({slots_.back().deadline, static_cast<std::uint64_t>(rank) << 32 | handle});
  sift_up(position);
  return handle;
}

void Timeline::remove(Handle handle) {
  const std::size_t position = slots_[handle].position;
  if (slots_[handle].participant == nullptr) return;
  slots_[handle].participant = nullptr;
  names_[handle] = {};
  const Place last = heap_.back();
  heap_.pop_back();
  if (last.handle() == handle) return;
  put(position, last);
  sift_up(position);
  sift_down(slots_[last.handle()].position);
}

void Timeline::move(Handle handle, Time deadline) noexcept {
  Slot& slot = slots_[handle];
  const bool earlier = deadline < slot.deadline;
  slot.deadline = deadline;
  heap_[slot.position].deadline = deadline;
  if (earlier) {
    sift_up(slot.position);
  } else {
    sift_down(slot.position);
  }
}

Time Timeline::next() const noexcept { return heap_.empty() ? never : heap_.front().deadline; }

void Timeline::run_until(Time end) {
  std::uint32_t ticks = 0;                  // of all, at now_
  std::vector<std::uint32_t> ticks_by_one;  // of each, once there are too many of all
  const struct Running {
    explicit Running(bool& flag) : running(flag) { running = true; }
    ~Running() { running = false; }
    bool& running;
  } running(running_);
  while (!heap_.empty()) {
    const Handle handle = heap_.front().handle();
    const Time deadline = heap_.front().deadline;
    if (deadline > end) break;
    if (deadline > now_) {
      now_ = deadline;
      ticks = 0;
    } else if (++ticks >= most_ticks) {
      if (ticks == most_ticks) ticks_by_one.clear();
      if (is_stalled(handle, ticks_by_one)) continue;
    }
    slots_[handle].participant->tick(now_);
    refresh(handle);
  }
  if (end > now_) now_ = end;
}

bool Timeline::is_stalled(Handle handle, std::vector<std::uint32_t>& ticks) {
  if (ticks.size() < slots_.size()) ticks.resize(slots_.size());
  if (++ticks[handle] < most_ticks) return false;
  const Stall stall{names_[handle].empty() ? "participant " + std::to_string(handle) : names_[handle], now_};
  remove(handle);
  if (!stall_handler_) throw std::logic_error(stall.text());
  stall_handler_(stall);
  return true;
}

std::string Timeline::Stall::text() const {
  char moment[32];
  std::snprintf(moment, sizeof moment, "%.9f", seconds(now));
  return name + " asks for the moment " + moment + " s without end: it gets no ticks any more";
}

}  // namespace canopus::can
