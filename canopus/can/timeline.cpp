#include "canopus/can/timeline.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace canopus::can {

namespace {

/// A heap and the positions of its handles while places move in it: pointers of its own, which no store can change.
template <typename Place>
class Moves {
 public:
  Moves(Place* places, std::uint32_t* positions) noexcept : places_(places), positions_(positions) {}
  const Place& operator[](std::size_t position) const noexcept { return places_[position]; }
  void put(std::size_t position, const Place& place) const noexcept {
    places_[position] = place;
    positions_[place.handle()] = static_cast<std::uint32_t>(position);
  }
  /// From `position` towards the root, not beyond `root`, as long as it is before its parent.
  void up(std::size_t position, std::size_t root, const Place& moving) const noexcept {
    while (position > root) {
      const std::size_t parent = (position - 1) / 2;
      if (!moving.before(places_[parent])) break;
      put(position, places_[parent]);
      position = parent;
    }
    put(position, moving);
  }

 private:
  Place* const places_;
  std::uint32_t* const positions_;
};

}  // namespace

void Timeline::sift_up(Heap& heap, std::size_t position) noexcept {
  const Place moving = heap[position];
  Moves(heap.data(), positions_.data()).up(position, 0, moving);
}

// Who had his tick most often goes far down: the earlier children move up first, all the way, and then the moving one is
// compared on its way back. That is one comparison for each level instead of two.
void Timeline::sift_down(Heap& heap, std::size_t position) noexcept {
  const Moves places(heap.data(), positions_.data());
  const Place moving = places[position];
  const std::size_t size = heap.size();
  std::size_t place = position;
  std::size_t child = 2 * place + 1;
  for (; child + 1 < size; child = 2 * place + 1) {
    child += static_cast<std::size_t>(places[child + 1].before(places[child]));
    places.put(place, places[child]);
    place = child;
  }
  if (child < size) {
    places.put(place, places[child]);
    place = child;
  }
  places.up(place, position, moving);
}

Timeline::Handle Timeline::add(Ticker& participant, std::string name, Rank rank) {
  const Handle handle = slots_.size();
  Heap& heap = heap_of(rank);
  slots_.push_back({&participant, participant.deadline(), rank});
  positions_.push_back(static_cast<std::uint32_t>(heap.size()));
  names_.push_back(std::move(name));
  const std::uint64_t number = (whole_ != nullptr ? whole_ : this)->numbers_++;
  heap.push_back({slots_.back().deadline, static_cast<std::uint64_t>(rank) << 63 | number << 32 | handle});
  sift_up(heap, heap.size() - 1);
  return handle;
}

void Timeline::remove(Handle handle) {
  const std::size_t position = positions_[handle];
  if (slots_[handle].participant == nullptr) return;
  slots_[handle].participant = nullptr;
  names_[handle] = {};
  Heap& heap = heap_of(slots_[handle].rank);
  const Place last = heap.back();
  heap.pop_back();
  if (last.handle() == handle) return;
  put(heap, position, last);
  sift_up(heap, position);
  sift_down(heap, positions_[last.handle()]);
}

void Timeline::move(Handle handle, Time deadline) noexcept {
  Slot& slot = slots_[handle];
  Heap& heap = heap_of(slot.rank);
  const std::size_t position = positions_[handle];
  const bool earlier = deadline < slot.deadline;
  slot.deadline = deadline;
  heap[position].deadline = deadline;
  if (earlier) {
    sift_up(heap, position);
  } else {
    sift_down(heap, position);
  }
}

Time Timeline::next() const noexcept {
  Time earliest = outside_next();
  for (const auto& part : parts_) earliest = std::min(earliest, part->next());
  return earliest;
}

Timeline& Timeline::add_part() {
  Timeline& part = *parts_.emplace_back(std::make_unique<Timeline>());
  part.whole_ = this;
  part.now_ = now_;
  return part;
}

namespace {

/// True as long as it lives.
class Flag {
 public:
  explicit Flag(bool& flag) : flag_(flag) { flag_ = true; }
  ~Flag() { flag_ = false; }
  Flag(const Flag&) = delete;
  Flag& operator=(const Flag&) = delete;

 private:
  bool& flag_;
};

}  // namespace

void Timeline::run_until(Time end) {
  const Flag running(running_);
  ticks_ = 0;
  latest_ = 0;
  if (!parts_.empty()) return run_together(end);
  run(end, nobody);
  if (end > now_) now_ = end;
}

void Timeline::run_apart(Time end) {
  const Flag apart(apart_);
  run_until(end);
}

void Timeline::run(Time end, const Place& until) {
  while (true) {
    const Place place = first();
    if (place.deadline > end || !place.before(until)) break;
    if (whole_ != nullptr && !apart_ && whole_->has_before(place)) break;  // made earlier by this part
    const Handle handle = place.handle();
    if (place.deadline > now_) {
      now_ = place.deadline;
      latest_ = place.order;
      ticks_ = 0;
    } else {
      latest_ = std::max(latest_, place.order);
      if (++ticks_ >= most_ticks) {
        if (ticks_ == most_ticks) ticks_by_one_.clear();
        if (is_stalled(handle)) continue;
      }
    }
    slots_[handle].participant->tick(now_);
    refresh(handle);
    if (!parts_.empty()) return;  // who belongs to no part may have made somebody of one earlier
  }
}

// Who is first of all goes on until somebody of another part is: nothing that a part does makes another one earlier.
void Timeline::run_together(Time end) {
  const struct Running {
    explicit Running(Timeline& timeline) : whole(timeline) { set(true); }
    ~Running() { set(false); }
    void set(bool running) const {
      for (const auto& part : whole.parts_) {
        part->running_ = running;
        part->ticks_ = 0;
        part->latest_ = 0;
      }
    }
    Timeline& whole;
  } running(*this);
  while (true) {
    Timeline* first = nullptr;
    Place earliest = nobody;
    Place second = nobody;
    const auto look = [&](Timeline& timeline) {
      const Place& place = timeline.first();
      if (place.before(earliest)) {
        second = std::exchange(earliest, place);
        first = &timeline;
      } else if (place.before(second)) {
        second = place;
      }
    };
    look(*this);
    for (const auto& part : parts_) look(*part);
    if (first == nullptr || earliest.deadline > end) break;
    now_ = std::max(now_, earliest.deadline);  // for those who look at the clock of the whole meanwhile
    first->run(now_, second);
  }
  now_ = std::max(now_, end);
  for (const auto& part : parts_) part->now_ = now_;
}

bool Timeline::is_stalled(Handle handle) {
  if (ticks_by_one_.size() < slots_.size()) ticks_by_one_.resize(slots_.size());
  if (++ticks_by_one_[handle] < most_ticks) return false;
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
