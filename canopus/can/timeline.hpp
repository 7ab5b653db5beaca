#pragma once
// The order in which participants get their ticks: a queue of deadlines. It has no clock; the simulated
// bus, a test or the event loop reads the next deadline and runs it up to a moment. Equal deadlines tick by
// rank, then in the order of add(), so one seed gives one trace.
//
// A participant whose deadline does not pass, however often it gets its tick, would stop time for all others.
// It is taken out after `most_ticks` of them at one moment, and reported by its name.
//
// What shares nothing may live in partitions (add_partition()): timelines of their own within one whole. The whole runs them
// together, in the very order in which one timeline would tick all; or each partition runs by itself for a while
// (run_partition()), before or after the others or on another thread. What is reported meanwhile is put into the one order
// afterwards by the stamp() at which it was reported.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/can/winner_tree.hpp"

namespace canopus::can {

/// A place in the order of all ticks of a timeline and its partitions: what one partition does comes in this order, and no two
/// partitions ever have the same.
struct TickStamp {
  Time time{};
  std::uint64_t order =
      0;  ///< of the participants that had their tick at this time so far: the last one in order

  friend constexpr auto operator<=>(const TickStamp&, const TickStamp&) = default;
};

class Timeline {
 public:
  using Handle = std::size_t;

  Timeline() = default;
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  /// What goes first at one and the same moment: nodes offer what they want to send, then the bus arbitrates.
  enum class Rank : std::uint8_t { node, bus };

  /// Ticks a participant from now on whenever its alarm is due, until it is removed or destroyed. Returns its handle. `name` is
  /// for people, in errors; empty: its number. Throws std::length_error when there have been a million.
  Handle add(Ticker& participant, std::string name = {}, Rank rank = Rank::node);
  /// Takes a participant out for good; its handle is not used again.
  void remove(Handle handle);

  /// A participant that set its deadline to one moment without end, and was removed.
  struct Stall {
    std::string name;
    Time now;
    /// "NAME sets its deadline to 1.5 s without end: it gets no ticks any more"
    [[nodiscard]] std::string text() const;
  };
  /// So many ticks of one participant at one moment are an error. The busiest ones need a few hundred.
  static constexpr std::uint32_t most_ticks = 10'000;
  /// Called at a stall, inside run_until(), which then goes on. Without a handler run_until() throws
  /// std::logic_error with the text.
  void set_stall_handler(std::function<void(const Stall&)> handler) { stall_handler_ = std::move(handler); }
  /// Earliest deadline of all.
  [[nodiscard]] Time next() const noexcept;
  /// What now is: the time of the last tick, or what run_until() was given.
  [[nodiscard]] Time now() const noexcept { return now_; }
  /// Where in the order of all ticks the present one is.
  [[nodiscard]] TickStamp stamp() const noexcept { return {now_, latest_}; }
  /// Inside run_until(); outside, whatever was due up to now() has had its tick.
  [[nodiscard]] bool is_running() const noexcept { return running_; }
  /// Ticks everything whose deadline is <= end, in order of time; then now() == end.
  void run_until(Time end);

  /// A timeline whose participants have no effect on those of another partition; it lives as long as this one. What belongs
  /// to none, such as clients that wait, is on this one itself. Equal deadlines tick in the order of add() over all.
  Timeline& add_partition();
  /// 0: all participants are on this one.
  [[nodiscard]] std::size_t partition_count() const noexcept { return partitions_.size(); }
  [[nodiscard]] Timeline& partition(std::size_t number) noexcept { return *partitions_[number]; }
  /// Of a partition: ticks its participants up to `end`, without those of others. Threads may do this for one partition each.
  /// All must have come as far before anything else happens to them or to the whole: join_partitions().
  void run_partition(Time end);
  /// Inside run_partition(): others may be before or behind.
  [[nodiscard]] bool runs_alone() const noexcept { return runs_alone_; }
  /// Of the whole: all partitions have run up to `end`, which is before outside_next().
  void join_partitions(Time end) noexcept { now_ = end; }
  /// Of the whole: earliest deadline of the participants that belong to no partition.
  [[nodiscard]] Time outside_next() const noexcept { return first().deadline; }

 private:
  friend class Alarm;
  /// What decides which is first.
  struct Place {
    Time deadline;
    std::uint64_t order;  // rank (1 bit), number over all partitions

    [[nodiscard]] bool before(const Place& other) const noexcept {
      return deadline != other.deadline ? deadline < other.deadline : order < other.order;
    }
  };
  static constexpr Place nothing_due{never, ~std::uint64_t{0}};
  static constexpr Handle no_handle = ~Handle{0};
  struct Entry {
    Ticker* participant;  // null: it has gone
    std::uint64_t order;
  };
  /// The participants of one rank, in the order of add(), and the tree of their deadlines. A handle is a place in it, and the rank.
  struct Queue {
    std::vector<Entry> entries;
    WinnerTree tree;

    [[nodiscard]] Place first() const noexcept {
      return tree.earliest() == never ? nothing_due : Place{tree.earliest(), entries[tree.winner()].order};
    }
  };
  [[nodiscard]] static Handle handle_of(WinnerTree::Index index, Rank rank) noexcept {
    return Handle{index} << 1 | static_cast<Handle>(rank);
  }
  [[nodiscard]] Queue& queue_of(Handle handle) noexcept { return (handle & 1) != 0 ? buses_ : nodes_; }
  [[nodiscard]] static WinnerTree::Index index_of(Handle handle) noexcept {
    return static_cast<WinnerTree::Index>(handle >> 1);
  }

  /// The first of all; with deadline never where there is none. At one moment nodes go first.
  [[nodiscard]] Place first() const noexcept {
    return buses_.tree.earliest() < nodes_.tree.earliest() ? buses_.first() : nodes_.first();
  }
  /// A participant that belongs to no partition is due before this.
  [[nodiscard]] bool has_before(const Place& place) const noexcept { return first().before(place); }
  /// Ticks whatever is due until `end` and before `until`. The whole ticks one participant.
  void run(Time end, const Place& until);
  void run_together(Time end);
  void tick(Queue& queue, WinnerTree::Index index, Handle handle);
  /// A participant's alarm was set. That of the one that has its tick is read after it.
  void alarm_changed(Handle handle, Time deadline) noexcept {
    if (handle != ticking_) queue_of(handle).tree.set(index_of(handle), deadline);
  }
  /// Counts a tick that comes after too many at one moment. True: the participant has been taken out.
  bool is_stalled(Handle handle);

  Queue nodes_;
  Queue buses_;
  Handle ticking_ = no_handle;
  std::vector<std::pair<Handle, std::string>> names_;  // of those that have one
  std::function<void(const Stall&)> stall_handler_;
  Time now_{};
  std::uint64_t latest_ = 0;  // of the orders of those that had their tick at now_
  bool running_ = false;
  bool runs_alone_ = false;
  // Ticks at now_, so that a participant without end is found.
  std::uint32_t ticks_ = 0;                  // of all
  std::vector<std::uint32_t> ticks_by_one_;  // of each, by handle, once there are too many of all
  Timeline* whole_ = nullptr;                // of a partition
  std::vector<std::unique_ptr<Timeline>> partitions_;
  std::uint32_t numbers_ = 0;  // given to participants, of the whole
};

}  // namespace canopus::can
