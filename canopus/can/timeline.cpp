#include "canopus/can/timeline.hpp"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace canopus::can {

namespace {

/// A quarter more where it has to grow: a plant of many buses has a timeline for each.
template <typename Element>
void make_room(std::vector<Element>& elements, std::size_t count) {
  if (elements.capacity() < count) elements.reserve(count + count / 4);
}

}  // namespace

// add() has made room for everybody.
[[gnu::always_inline]] inline void Timeline::put_in(Queue& queue, const Place& place) noexcept {
  queue.push_back(place);
  Place* position = &queue.back();
  for (; position[-1].before(place); --position) *position = position[-1];
  *position = place;
}

[[gnu::always_inline]] inline void Timeline::take_out(Queue& queue, std::uint64_t order) noexcept {
  std::size_t position = queue.size() - 1;
  while (queue[position].order != order) --position;
  for (; position + 1 < queue.size(); ++position) queue[position] = queue[position + 1];
  queue.pop_back();
}

[[gnu::always_inline]] inline void Timeline::put_node(Slot& slot) noexcept {
  if (slot.deadline == never) return;
  const std::int64_t slice = slice_of(slot.deadline);
  if (is_soon(slice)) return put_in(nodes_, {slot.deadline, slot.order});
  const auto handle = static_cast<std::uint32_t>(slot.order);
  std::uint32_t& list = lists_[list_of(slice)];
  slot.previous = nobody_else;
  slot.next = std::exchange(list, handle);
  if (slot.next != nobody_else) slots_[slot.next].previous = handle;
  has_list_[list_of(slice) / 64] |= std::uint64_t{1} << list_of(slice) % 64;
  ++listed_;
}

[[gnu::always_inline]] inline void Timeline::take_off_list(Slot& slot, std::int64_t slice) noexcept {
  --listed_;
  if (slot.next != nobody_else) slots_[slot.next].previous = slot.previous;
  if (slot.previous != nobody_else) {
    slots_[slot.previous].next = slot.next;
    return;
  }
  lists_[list_of(slice)] = slot.next;
  if (slot.next == nobody_else) has_list_[list_of(slice) / 64] &= ~(std::uint64_t{1} << list_of(slice) % 64);
}

[[gnu::always_inline]] inline void Timeline::take_from_queue(Slot& slot, Time deadline) noexcept {
  if (slot.is_bus()) return take_out(buses_, slot.order);
  if (deadline == never) return;
  const std::int64_t slice = slice_of(deadline);
  if (is_soon(slice)) {
    take_out(nodes_, slot.order);
  } else {
    take_off_list(slot, slice);
  }
}

/// 1 to slice_count: how far the next list behind that of the present slice is in which somebody waits.
std::size_t Timeline::lists_to_next() const noexcept {
  const std::size_t begin = list_of(present_slice_ + 1);
  const std::size_t word = begin / 64;
  if (const std::uint64_t behind = has_list_[word] >> begin % 64; behind != 0)
    return 1 + static_cast<std::size_t>(std::countr_zero(behind));
  for (std::size_t i = 1; i <= has_list_.size(); ++i) {
    const std::uint64_t lists = has_list_[(word + i) % has_list_.size()];
    if (lists != 0) return 1 + i * 64 - begin % 64 + static_cast<std::size_t>(std::countr_zero(lists));
  }
  return slice_count;
}

std::int64_t Timeline::earliest_slice() const noexcept {
  Time earliest = never;
  for (const Slot& slot : slots_) {
    if (slot.participant != nullptr && !slot.is_bus()) earliest = std::min(earliest, slot.deadline);
  }
  return slice_of(earliest);
}

void Timeline::advance() noexcept {
  std::size_t passed = 0;
  while (is_empty(nodes_) && listed_ > 0) {
    const std::size_t way = lists_to_next();
    passed += way;
    // Nobody waits within a round: whoever is first may be years away.
    present_slice_ =
        passed > slice_count ? earliest_slice() : present_slice_ + static_cast<std::int64_t>(way);
    const std::size_t list = list_of(present_slice_);
    has_list_[list / 64] &= ~(std::uint64_t{1} << list % 64);
    for (std::uint32_t handle = std::exchange(lists_[list], nobody_else); handle != nobody_else;) {
      Slot& slot = slots_[handle];
      handle = slot.next;
      --listed_;
      if (slice_of(slot.deadline) > present_slice_) {  // in a later round
        put_node(slot);
        continue;
      }
      put_in(nodes_, {slot.deadline, slot.order});
      __builtin_prefetch(slot.participant);  // its tick is not far
    }
  }
}

Timeline::Handle Timeline::add(Ticker& participant, std::string name, Rank rank) {
  const Handle handle = slots_.size();
  const std::uint64_t number = (whole_ != nullptr ? whole_ : this)->numbers_++;
  make_room(slots_, handle + 1);
  slots_.push_back({.participant = &participant,
                    .deadline = participant.deadline(),
                    .order = static_cast<std::uint64_t>(rank) << 63 | number << 32 | handle});
  if (!name.empty()) names_.emplace_back(handle, std::move(name));
  Slot& slot = slots_.back();
  if (rank == Rank::bus) {
    make_room(buses_, buses_.size() + 1);
    put_in(buses_, {slot.deadline, slot.order});
  } else {
    make_room(nodes_, slots_.size() + 1);
    put_node(slot);
    if (is_empty(nodes_)) advance();
  }
  return handle;
}

void Timeline::remove(Handle handle) {
  Slot& slot = slots_[handle];
  if (slot.participant == nullptr) return;
  take_from_queue(slot, slot.deadline);
  slot.participant = nullptr;
  std::erase_if(names_, [&](const auto& name) { return name.first == handle; });
  if (is_empty(nodes_)) advance();
}

void Timeline::move(Handle handle, Time deadline) noexcept {
  Slot& slot = slots_[handle];
  take_from_queue(slot, std::exchange(slot.deadline, deadline));
  if (slot.is_bus()) return put_in(buses_, {deadline, slot.order});
  put_node(slot);
  if (is_empty(nodes_)) advance();
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
  const bool meets_parts = whole_ != nullptr && !apart_;  // of which one may be made earlier by this part
  const bool meets_others = meets_parts || until.deadline != never;
  const bool is_whole = !parts_.empty();
  const Time last = std::min(end, never - Duration{1});
  const bool goes_on_alone = !meets_others && !is_whole && buses_.size() == 2;
  while (true) {
    const Place place = first();
    if (place.deadline > last) break;
    if (meets_others && (!place.before(until) || (meets_parts && whole_->has_before(place)))) break;
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
    Time deadline = slots_[handle].participant->tick_and_tell(now_);
    if (goes_on_alone && slots_[handle].is_bus()) deadline = go_on(handle, deadline, last);
    if (deadline == Ticker::not_told) {
      refresh(handle);
    } else {
      retime(handle, deadline);
    }
    if (is_whole) return;  // who belongs to no part may have made somebody of one earlier
  }
}

/// The only bus has had its tick: it has those that come before any node is due, too. Its deadline then.
Time Timeline::go_on(Handle bus, Time deadline, Time last) {
  const auto is_still_alone = [this] { return buses_.size() == 2; };
  while (deadline > now_ && deadline <= last && deadline < nodes_.back().deadline && is_still_alone()) {
    Slot& slot = slots_[bus];
    buses_.back().deadline = slot.deadline = deadline;
    now_ = deadline;
    latest_ = slot.order;
    ticks_ = 0;
    deadline = slot.participant->tick_and_tell(now_);
  }
  return deadline;
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
  const auto name = std::ranges::find(names_, handle, &std::pair<Handle, std::string>::first);
  const Stall stall{name == names_.end() ? "participant " + std::to_string(handle) : name->second, now_};
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
