#include "canopus/can/timeline.hpp"

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace canopus::can {

Alarm::~Alarm() {
  if (owner_ == Owner::whole) whole_->remove_part(*this);
  if (owner_ == Owner::timeline) timeline_->remove(handle_);
  while (first_part_ != nullptr) {
    first_part_->owner_ = Owner::none;
    first_part_ = first_part_->next_part_;
  }
}

void Alarm::add_part(Alarm& part) noexcept {
  assert(part.owner_ == Owner::none);
  part.owner_ = Owner::whole;
  part.whole_ = this;
  part.next_part_ = std::exchange(first_part_, &part);
  part_changed(never, part.deadline_);
}

void Alarm::remove_part(Alarm& part) noexcept {
  Alarm** link = &first_part_;
  while (*link != nullptr && *link != &part) link = &(*link)->next_part_;
  if (*link == nullptr) return;
  *link = part.next_part_;
  part.owner_ = Owner::none;
  part_changed(part.deadline_, never);
}

void Alarm::change(Time deadline) noexcept {
  const Time before = std::exchange(deadline_, deadline);
  if (owner_ == Owner::whole) {
    whole_->part_changed(before, deadline);
  } else if (owner_ == Owner::timeline) {
    timeline_->alarm_changed(handle_, deadline);
  }
}

inline void Alarm::part_changed(Time before, Time deadline) noexcept {
  if (is_held_) return;
  if (deadline < deadline_) {
    change(deadline);
  } else if (before == deadline_) {
    settle();
  }
}

Timeline::~Timeline() {
  for (Queue* queue : {&nodes_, &buses_}) {
    for (const Entry& entry : queue->entries)
      if (entry.participant != nullptr) entry.participant->alarm().owner_ = Alarm::Owner::none;
  }
}

Timeline::Handle Timeline::add(Ticker& participant, std::string name, Rank rank) {
  Queue& queue = rank == Rank::bus ? buses_ : nodes_;
  if (nodes_.entries.size() + buses_.entries.size() >= WinnerTree::most_players)
    throw std::length_error("a timeline has no room for more participants");
  const std::uint64_t number = (whole_ != nullptr ? whole_ : this)->numbers_++;
  const WinnerTree::Index index = queue.tree.add();
  queue.entries.push_back({&participant, static_cast<std::uint64_t>(rank) << 63 | number});
  const Handle handle = handle_of(index, rank);
  if (!name.empty()) names_.emplace_back(handle, std::move(name));
  Alarm& alarm = participant.alarm();
  assert(alarm.owner_ == Alarm::Owner::none);
  alarm.owner_ = Alarm::Owner::timeline;
  alarm.timeline_ = this;
  alarm.handle_ = static_cast<std::uint32_t>(handle);
  queue.tree.set(index, alarm.deadline());
  return handle;
}

void Timeline::remove(Handle handle) {
  Queue& queue = queue_of(handle);
  Entry& entry = queue.entries[index_of(handle)];
  if (entry.participant == nullptr) return;
  queue.tree.set(index_of(handle), never);
  std::exchange(entry.participant, nullptr)->alarm().owner_ = Alarm::Owner::none;
  std::erase_if(names_, [&](const auto& name) { return name.first == handle; });
}

Time Timeline::next() const noexcept {
  Time earliest = outside_next();
  for (const auto& partition : partitions_) earliest = std::min(earliest, partition->next());
  return earliest;
}

Timeline& Timeline::add_partition() {
  Timeline& partition = *partitions_.emplace_back(std::make_unique<Timeline>());
  partition.whole_ = this;
  partition.now_ = now_;
  return partition;
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
  if (!partitions_.empty()) return run_together(end);
  run(end, nothing_due);
  if (end > now_) now_ = end;
}

void Timeline::run_partition(Time end) {
  const Flag alone(runs_alone_);
  run_until(end);
}

[[gnu::always_inline]] inline void Timeline::tick(Queue& queue, WinnerTree::Index index, Handle handle) {
  // Its alarm is read once, however often it was set, and when its tick throws, too.
  const struct Ticking {
    Ticking(Timeline& ticked, Queue& its_queue, WinnerTree::Index its_index, Handle its_handle)
        : timeline(ticked), queue(its_queue), index(its_index) {
      timeline.ticking_ = its_handle;
    }
    ~Ticking() {
      timeline.ticking_ = no_handle;
      Ticker* const participant = queue.entries[index].participant;
      if (participant == nullptr) return;  // it has gone inside its tick
      queue.tree.set_inline(index, participant->deadline());
      // The next tick is not far.
      __builtin_prefetch(queue.entries[queue.tree.winner()].participant);
    }
    Timeline& timeline;
    Queue& queue;
    WinnerTree::Index index;
  } ticking(*this, queue, index, handle);
  queue.entries[index].participant->tick(now_);
}

void Timeline::run(Time end, const Place& until) {
  const bool meets_partitions =
      whole_ != nullptr && !runs_alone_;  // of which one may be made earlier by this one
  const bool meets_others = meets_partitions || until.deadline != never;
  const bool is_whole = !partitions_.empty();
  const Time last = std::min(end, never - Duration{1});
  while (true) {
    const Rank rank = buses_.tree.earliest() < nodes_.tree.earliest() ? Rank::bus : Rank::node;
    Queue& queue = rank == Rank::bus ? buses_ : nodes_;
    if (queue.tree.earliest() > last) break;
    const WinnerTree::Index index = queue.tree.winner();
    const Place place{queue.tree.earliest(), queue.entries[index].order};
    if (meets_others && (!place.before(until) || (meets_partitions && whole_->has_before(place)))) break;
    const Handle handle = handle_of(index, rank);
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
    if (rank == Rank::bus) {
      tick(buses_, index, handle);
    } else {
      tick(nodes_, index, handle);
    }
    if (is_whole) return;  // one that belongs to no partition may have made one of a partition earlier
  }
}

// The first of all goes on until one of another partition is: nothing that a partition does makes another one earlier.
void Timeline::run_together(Time end) {
  const struct Running {
    explicit Running(Timeline& timeline) : whole(timeline) { set(true); }
    ~Running() { set(false); }
    void set(bool running) const {
      for (const auto& partition : whole.partitions_) {
        partition->running_ = running;
        partition->ticks_ = 0;
        partition->latest_ = 0;
      }
    }
    Timeline& whole;
  } running(*this);
  while (true) {
    Timeline* first = nullptr;
    Place earliest = nothing_due;
    Place second = nothing_due;
    const auto compare = [&](Timeline& timeline) {
      const Place place = timeline.first();
      if (place.before(earliest)) {
        second = std::exchange(earliest, place);
        first = &timeline;
      } else if (place.before(second)) {
        second = place;
      }
    };
    compare(*this);
    for (const auto& partition : partitions_) compare(*partition);
    if (first == nullptr || earliest.deadline > end) break;
    now_ = std::max(now_, earliest.deadline);  // for readers of the clock of the whole meanwhile
    first->run(now_, second);
  }
  now_ = std::max(now_, end);
  for (const auto& partition : partitions_) partition->now_ = now_;
}

bool Timeline::is_stalled(Handle handle) {
  const std::size_t handles = 2 * std::max(nodes_.entries.size(), buses_.entries.size());
  if (ticks_by_one_.size() < handles) ticks_by_one_.resize(handles);
  if (++ticks_by_one_[handle] < most_ticks) return false;
  const auto name = std::ranges::find(names_, handle, &std::pair<Handle, std::string>::first);
  const std::uint64_t number = queue_of(handle).entries[index_of(handle)].order << 1 >> 1;
  const Stall stall{name == names_.end() ? "participant " + std::to_string(number) : name->second, now_};
  remove(handle);
  if (!stall_handler_) throw std::logic_error(stall.text());
  stall_handler_(stall);
  return true;
}

std::string Timeline::Stall::text() const {
  char moment[32];
  std::snprintf(moment, sizeof moment, "%.9f", seconds(now));
  return name + " sets its deadline to " + moment + " s without end: it gets no ticks any more";
}

}  // namespace canopus::can
