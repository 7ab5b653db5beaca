#pragma once
// The order in which participants get their ticks: a queue of deadlines. It knows no clock; the simulated
// bus, a test or the event loop asks it what comes next and runs it up to a moment. Equal deadlines tick by
// rank, then in the order of add(), so one seed gives one trace.
//
// A participant whose deadline does not pass, however often it gets its tick, would stop time for all others.
// It is taken out after `most_ticks` of them at one moment, and reported by its name.
//
// What shares nothing may live in parts (add_part()): timelines of their own within one whole. The whole runs them
// together, in the very order in which one timeline would tick everybody; or each part runs by itself for a while
// (run_apart()), before or after the others or on another thread. What is said meanwhile is put into the one order
// afterwards by the moment() at which it was said.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/controller.hpp"

namespace canopus::can {

/// A place in the order of all ticks of a timeline and its parts: what one part does comes in this order, and no two
/// parts ever have the same.
struct Moment {
  Time time{};
  std::uint64_t order =
      0;  ///< of the participants that had their tick at this time so far: the last one in order

  friend constexpr auto operator<=>(const Moment&, const Moment&) = default;
};

class Timeline {
 public:
  using Handle = std::size_t;

  Timeline() = default;
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  /// Who goes first at one and the same moment: nodes say what they want to send, then the bus arbitrates.
  enum class Rank : std::uint8_t { node, bus };

  /// Adds a participant, which must outlive the timeline or be removed. Returns its handle. `name` is for
  /// people, in errors; empty: its number. Throws std::length_error when there have been a million.
  Handle add(Ticker& participant, std::string name = {}, Rank rank = Rank::node);
  /// Takes a participant out for good; its handle is not used again.
  void remove(Handle handle);

  /// A participant that asked for one moment without end and has been taken out.
  struct Stall {
    std::string name;
    Time now;
    /// "NAME asks for the moment 1.5 s without end: it gets no ticks any more"
    [[nodiscard]] std::string text() const;
  };
  /// So many ticks of one participant at one moment are an error. The busiest ones need a few hundred.
  static constexpr std::uint32_t most_ticks = 10'000;
  /// Called at a stall, inside run_until(), which then goes on. Without a handler run_until() throws
  /// std::logic_error with the text.
  void set_stall_handler(std::function<void(const Stall&)> handler) { stall_handler_ = std::move(handler); }
  /// Reads the participant's deadline again. To be called after anything but its tick() happened to it.
  void refresh(Handle handle) {
    if (const Ticker* participant = seats_[handle].participant; participant != nullptr)
      retime(handle, participant->deadline());
  }
  /// Earliest deadline of all.
  [[nodiscard]] Time next() const noexcept;
  /// What now is: the time of the last tick, or what run_until() was given.
  [[nodiscard]] Time now() const noexcept { return now_; }
  /// Where in the order of all ticks the present one is.
  [[nodiscard]] Moment moment() const noexcept { return {now_, latest_}; }
  /// Inside run_until(); outside, whatever was due up to now() has had its tick.
  [[nodiscard]] bool is_running() const noexcept { return running_; }
  /// Ticks everything whose deadline is <= end, in order of time; then now() == end.
  void run_until(Time end);

  /// A timeline whose participants never have to do with those of another part; it lives as long as this one. What belongs
  /// to no part, such as clients that wait, is on this one itself. Equal deadlines tick in the order of add() over all.
  Timeline& add_part();
  /// 0: everybody is on this one.
  [[nodiscard]] std::size_t part_count() const noexcept { return parts_.size(); }
  [[nodiscard]] Timeline& part(std::size_t number) noexcept { return *parts_[number]; }
  /// Of a part: ticks its participants up to `end`, without those of other parts. Threads may do this for one part each. All
  /// parts must have come as far before anything else happens to them or to the whole: meet().
  void run_apart(Time end);
  /// Inside run_apart(): others may be before or behind.
  [[nodiscard]] bool is_apart() const noexcept { return apart_; }
  /// Of the whole: all parts have run apart up to `end`, which is before outside_next().
  void meet(Time end) noexcept { now_ = end; }
  /// Of the whole: earliest deadline of who belongs to no part.
  [[nodiscard]] Time outside_next() const noexcept { return first().deadline; }

 private:
  /// What decides who is first.
  struct Place {
    Time deadline;
    std::uint64_t order;  // rank (1 bit), number over all parts (31), handle (32)

    [[nodiscard]] Handle handle() const noexcept { return order & 0xFFFF'FFFF; }
    [[nodiscard]] bool is_bus() const noexcept { return order >> 63 != 0; }
    [[nodiscard]] bool before(const Place& other) const noexcept {
      return deadline != other.deadline ? deadline < other.deadline : order < other.order;
    }
  };
  /// A node in its tournament, the lower one is first: its deadline, counted from base_ on, and its handle.
  using Key = std::uint64_t;
  static constexpr unsigned handle_bits = 20;
  static constexpr Handle most_participants = 1'000'000;
  static constexpr Key waits_for_nothing = ~Key{0};
  /// From here on (4.9 hours) keys do not tell deadlines apart.
  static constexpr std::uint64_t far = waits_for_nothing >> handle_bits;
  /// The last one first: whoever is first of all goes and comes without moving others. Behind all is `nobody`, so that no
  /// look at it, and no search, has to ask for its end.
  using Queue = std::vector<Place>;

  /// Who is first of all; with deadline never where there is nobody.
  [[nodiscard]] const Place& first() const noexcept {
    const Place& bus = buses_.back();
    return first_node_.deadline <= bus.deadline ? first_node_ : bus;  // at one moment nodes go first
  }
  /// Somebody who belongs to no part is due before this.
  [[nodiscard]] bool has_before(const Place& place) const noexcept { return first().before(place); }
  /// Ticks whatever is due until `end` and before `until`. The whole ticks one participant.
  void run(Time end, const Place& until);
  Time run_bus(const Place& bus, Time last);
  void run_together(Time end);
  void retime(Handle handle, Time deadline) noexcept {
    const Seat& seat = seats_[handle];
    if (deadline == seat.place.deadline && !seat.place.is_bus()) return;
    move(seat.place, deadline);
  }
  void move(const Place& place, Time deadline) noexcept;
  void move_inline(const Place& place, Time deadline) noexcept;
  static void put_in(Queue& queue, const Place& place) noexcept;
  static void take_out(Queue& queue, std::uint64_t order) noexcept;
  void put_node(Handle handle, Time deadline) noexcept;
  void take_first(Key key) noexcept;
  void look_for_first(Key key) noexcept;
  void play_anew(Time base) noexcept;
  void make_players();
  [[nodiscard]] std::size_t player(Handle handle) const noexcept { return players_ + handle; }
  [[nodiscard]] Key key_of(Handle handle, Time deadline) const noexcept;
  /// Counts a tick that comes after too many at one moment. True: the participant has been taken out.
  bool is_stalled(Handle handle);

  static constexpr Place nobody{never, ~std::uint64_t{0}};
  struct Seat {
    Ticker* participant;  // null: it has gone
    Place place;          // of a bus: with deadline never
  };
  std::vector<Seat> seats_;  // by handle
  Queue buses_{nobody};      // all: a bus's deadline changes with each frame
  // Nodes play a tournament for who is first: behind the matches stand the players, by handle; match n is between 2 n and
  // 2 n + 1, and match 1 the last one. A new deadline is played up to there, and no branch hangs on who wins. A bus, and who
  // has gone, waits for nothing. When all are far, they play anew from the earliest deadline on.
  std::size_t players_ = 1;                                          // room for so many
  Time base_{};                                                      // no node's deadline is before it
  std::vector<Key> first_of_{waits_for_nothing, waits_for_nothing};  // each match, and each player
  Place first_node_ = nobody;
  std::vector<std::pair<Handle, std::string>> names_;  // of those that have one, in order of handles
  std::function<void(const Stall&)> stall_handler_;
  Time now_{};
  std::uint64_t latest_ = 0;  // of the orders of those who had their tick at now_
  bool running_ = false;
  bool apart_ = false;
  // Ticks at now_, so that a participant without end is found.
  std::uint32_t ticks_ = 0;                  // of all
  std::vector<std::uint32_t> ticks_by_one_;  // of each, once there are too many of all
  Timeline* whole_ = nullptr;                // of a part
  std::vector<std::unique_ptr<Timeline>> parts_;
  std::uint32_t numbers_ = 0;  // given to participants, of the whole
};

}  // namespace canopus::can
