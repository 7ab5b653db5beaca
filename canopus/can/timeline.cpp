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
void Timeline::put_in(Queue& queue, const Place& place) noexcept {
  queue.push_back(place);
  Place* position = &queue.back();
  for (; position[-1].before(place); --position) *position = position[-1];
  *position = place;
}

void Timeline::take_out(Queue& queue, std::uint64_t order) noexcept {
  std::size_t position = queue.size() - 1;
  while (queue[position].order != order) --position;
  for (; position + 1 < queue.size(); ++position) queue[position] = queue[position + 1];
  queue.pop_back();
}

Timeline::Key Timeline::key_of(Handle handle, Time deadline) const noexcept {
  if (deadline == never) return waits_for_nothing;
  const auto after_base = static_cast<std::uint64_t>(deadline.time_since_epoch().count()) -
                          static_cast<std::uint64_t>(base_.time_since_epoch().count());
  return std::min(after_base, far) << handle_bits | handle;
}

[[gnu::always_inline]] inline void Timeline::put_node(Handle handle, Time deadline) noexcept {
  seats_[handle].place.deadline = deadline;
  if (deadline < base_) [[unlikely]]
    return play_anew(deadline);
  Key* const first_of = first_of_.data();
  std::size_t match = player(handle);
  Key first = key_of(handle, deadline);
  first_of[match] = first;
  while (match > 1) {
    const Key other = first_of[match ^ 1];
    match /= 2;
    first = first < other ? first : other;
    first_of[match] = first;
  }
  take_first(first);
}

/// Who has won the last match.
inline void Timeline::take_first(Key key) noexcept {
  if (key >> handle_bits == far) [[unlikely]]
    return look_for_first(key);
  const Seat& seat = seats_[key & ((Key{1} << handle_bits) - 1)];
  first_node_ = seat.place;
  __builtin_prefetch(seat.participant);  // its tick is not far
}

void Timeline::look_for_first(Key key) noexcept {
  first_node_ = nobody;
  if (key == waits_for_nothing) return;
  Time earliest = never;
  for (const Seat& seat : seats_) earliest = std::min(earliest, seat.place.deadline);
  play_anew(earliest);
}

/// `base`: not after any deadline.
void Timeline::play_anew(Time base) noexcept {
  base_ = base;
  for (Handle handle = 0; handle < seats_.size(); ++handle)
    first_of_[player(handle)] = key_of(handle, seats_[handle].place.deadline);
  for (std::size_t match = players_ - 1; match > 0; --match)
    first_of_[match] = std::min(first_of_[2 * match], first_of_[2 * match + 1]);
  take_first(first_of_[1]);
}

/// move(), as a part of its caller.
[[gnu::always_inline]] inline void Timeline::move_inline(const Place& place, Time deadline) noexcept {
  if (seats_[place.handle()].participant == nullptr) return;  // it has gone inside its tick
  if (!place.is_bus()) {
    put_node(place.handle(), deadline);
  } else if (buses_.size() == 2) {  // alone, as a plant's part mostly has it
    buses_.back().deadline = deadline;
  } else {
    take_out(buses_, place.order);
    put_in(buses_, {deadline, place.order});
  }
}

void Timeline::move(const Place& place, Time deadline) noexcept { move_inline(place, deadline); }

/// As many as there is room for participants.
void Timeline::make_players() {
  players_ = seats_.capacity();
  first_of_.assign(2 * players_, waits_for_nothing);
  play_anew(base_);
}

Timeline::Handle Timeline::add(Ticker& participant, std::string name, Rank rank) {
  const Handle handle = seats_.size();
  if (handle >= most_participants) throw std::length_error("a timeline has no room for more participants");
  const std::uint64_t number = (whole_ != nullptr ? whole_ : this)->numbers_++;
  const Place place{participant.deadline(), static_cast<std::uint64_t>(rank) << 63 | number << 32 | handle};
  make_room(seats_, handle + 1);
  seats_.push_back({&participant, {never, place.order}});
  if (!name.empty()) names_.emplace_back(handle, std::move(name));
  if (players_ < seats_.capacity()) make_players();
  if (rank == Rank::bus) {
    make_room(buses_, buses_.size() + 1);
    put_in(buses_, place);
  } else {
    put_node(handle, place.deadline);
  }
  return handle;
}

void Timeline::remove(Handle handle) {
  Seat& seat = seats_[handle];
  if (seat.participant == nullptr) return;
  if (seat.place.is_bus()) {
    take_out(buses_, seat.place.order);
  } else {
    put_node(handle, never);
  }
  seat.participant = nullptr;
  std::erase_if(names_, [&](const auto& name) { return name.first == handle; });
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

/// Ticks the only bus, which is due, and goes on with it as long as no node is. Its deadline then.
[[gnu::always_inline]] inline Time Timeline::run_bus(const Place& bus, Time last) {
  Ticker& participant = *seats_[bus.handle()].participant;
  while (true) {
    const Time deadline = participant.tick_and_tell(now_);
    const bool is_first = deadline > now_ && deadline <= last && deadline < first_node_.deadline;
    const bool is_alone = buses_.size() == 2 && buses_.back().order == bus.order;
    if (!is_first || !is_alone) return deadline;
    buses_.back().deadline = now_ = deadline;
    latest_ = bus.order;
    ticks_ = 0;
  }
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
    // Each of the two calls mostly leads to participants of one kind, which a processor foretells.
    const Time deadline = goes_on_alone && place.is_bus() ? run_bus(place, last)
                                                          : seats_[handle].participant->tick_and_tell(now_);
    if (deadline == Ticker::not_told) {
      refresh(handle);
    } else if (const Place& before = seats_[handle].place; deadline != before.deadline || before.is_bus()) {
      move_inline(before, deadline);
    }
    if (is_whole) return;  // who belongs to no part may have made somebody of one earlier
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
  if (ticks_by_one_.size() < seats_.size()) ticks_by_one_.resize(seats_.size());
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
