#pragma once
// The order in which participants get their ticks: a queue of deadlines. It knows no clock; the simulated
// bus, a test or the event loop asks it what comes next and runs it up to a moment. Equal deadlines tick by
// rank, then in the order of add(), so one seed gives one trace.
//
// A participant whose deadline does not pass, however often it gets its tick, would stop time for all others.
// It is taken out after `most_ticks` of them at one moment, and reported by its name.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/controller.hpp"

namespace canopus::can {

class Timeline {
 public:
  using Handle = std::size_t;

  /// Who goes first at one and the same moment: nodes say what they want to send, then the bus arbitrates.
  enum class Rank : std::uint8_t { node, bus };

  /// Adds a participant, which must outlive the timeline or be removed. Returns its handle. `name` is for
  /// people, in errors; empty: its number.
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
    const Slot& slot = slots_[handle];
    if (slot.participant == nullptr) return;
    const Time deadline = slot.participant->deadline();
    if (deadline != slot.deadline) move(handle, deadline);
  }
  /// Earliest deadline of all.
  [[nodiscard]] Time next() const noexcept;
  /// What now is: the time of the last tick, or what run_until() was given.
  [[nodiscard]] Time now() const noexcept { return now_; }
  /// Inside run_until(); outside, whatever was due up to now() has had its tick.
  [[nodiscard]] bool is_running() const noexcept { return running_; }
  /// Ticks everything whose deadline is <= end, in order of time; then now() == end.
  void run_until(Time end);

 private:
  struct Slot {
    Ticker* participant = nullptr;
    Time deadline = never;
    std::uint32_t position = 0;  // in heap_
  };
  /// What decides who is first lies in the heap itself: a comparison looks nowhere else.
  struct Place {
    Time deadline;
    std::uint64_t order;  // rank, then handle

    [[nodiscard]] Handle handle() const noexcept { return order & 0xFFFF'FFFF; }
    [[nodiscard]] bool before(const Place& other) const noexcept {
      return deadline != other.deadline ? deadline < other.deadline : order < other.order;
    }
  };
  void put(std::size_t position, const Place& place) noexcept {
    heap_[position] = place;
    slots_[place.handle()].position = static_cast<std::uint32_t>(position);
  }
  void move(Handle handle, Time deadline) noexcept;
  void sift_up(std::size_t position) noexcept;
  void sift_down(std::size_t position) noexcept;
  /// Counts a tick that comes after too many at one moment. True: the participant has been taken out.
  bool is_stalled(Handle handle, std::vector<std::uint32_t>& ticks);

  std::vector<Slot> slots_;
  std::vector<Place> heap_;         // binary heap, earliest first
  std::vector<std::string> names_;  // by handle: apart from what every tick needs
  std::function<void(const Stall&)> stall_handler_;
  Time now_{};
  bool running_ = false;
};

}  // namespace canopus::can
