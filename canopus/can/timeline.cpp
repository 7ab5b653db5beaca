#include "canopus/can/timeline.hpp"

#include <algorithm>
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

void Timeline::put_node(Handle handle, Time deadline) noexcept {
  Time* const earliest = earliest_.data();
  std::size_t match = players_ + handle;
  earliest[match] = deadline;
  Time lowest = deadline;
  while (match > 1) {
    const Time other = earliest[match ^ 1];
    match /= 2;
    lowest = lowest < other ? lowest : other;
    earliest[match] = lowest;
  }
  if (lowest == never) {
    first_node_ = nobody;
    return;
  }
  // Of two that are equal the one that was added first.
  while (match < players_) {
    match *= 2;
    match += static_cast<std::size_t>(earliest[match] != lowest);
  }
  const Slot& first = slots_[match - players_];
  first_node_ = {lowest, first.order};
  __builtin_prefetch(first.participant);  // its tick is not far
}

void Timeline::grow() {
  const std::size_t before = players_;
  players_ *= 2;
  earliest_.resize(2 * players_, never);
  std::copy_n(earliest_.begin() + static_cast<std::ptrdiff_t>(before), before,
              earliest_.begin() + static_cast<std::ptrdiff_t>(players_));
  for (std::size_t match = players_ - 1; match > 0; --match)
    earliest_[match] = std::min(earliest_[2 * match], earliest_[2 * match + 1]);
}

Timeline::Handle Timeline::add(Ticker& participant, std::string name, Rank rank) {
  const Handle handle = slots_.size();
  const std::uint64_t number = (whole_ != nullptr ? whole_ : this)->numbers_++;
  make_room(slots_, handle + 1);
  slots_.push_back({.participant = &participant,
                    .deadline = participant.deadline(),
                    .order = static_cast<std::uint64_t>(rank) << 63 | number << 32 | handle});
  if (!name.empty()) names_.emplace_back(handle, std::move(name));
  if (players_ < slots_.size()) grow();
  const Slot& slot = slots_.back();
  if (rank == Rank::bus) {
    make_room(buses_, buses_.size() + 1);
    put_in(buses_, {slot.deadline, slot.order});
  } else {
    put_node(handle, slot.deadline);
  }
  return handle;
}

void Timeline::remove(Handle handle) {
  Slot& slot = slots_[handle];
  if (slot.participant == nullptr) return;
  if (slot.is_bus()) {
    take_out(buses_, slot.order);
  } else {
    put_node(handle, never);
  }
  slot.participant = nullptr;
  std::erase_if(names_, [&](const auto& name) { return name.first == handle; });
}

void Timeline::move(Handle handle, Time deadline) noexcept {
  Slot& slot = slots_[handle];
  slot.deadline = deadline;
  if (!slot.is_bus()) return put_node(handle, deadline);
  take_out(buses_, slot.order);
  put_in(buses_, {deadline, slot.order});
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
  while (deadline > now_ && deadline <= last && deadline < first_node_.deadline && is_still_alone()) {
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
