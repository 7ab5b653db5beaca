#pragma once
// The order in which participants get their ticks: a queue of deadlines. It knows no clock; the simulated
// bus, a test or the event loop asks it what comes next and runs it up to a moment. Equal deadlines tick by
// rank, then in the order of add(), so one seed gives one trace.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "canopus/can/controller.hpp"

namespace canopus::can {

class Timeline {
 public:
  using Handle = std::size_t;

  /// Who goes first at one and the same moment: nodes say what they want to send, then the bus arbitrates.
  enum class Rank : std::uint8_t { node, bus };

  /// Adds a participant, which must outlive the timeline or be removed. Returns its handle.
  Handle add(Participant& participant, Rank rank = Rank::node);
  /// Takes a participant out for good; its handle is not used again.
  void remove(Handle handle);
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
  /// Ticks everything whose deadline is <= end, in order of time; then now() == end.
  void run_until(Time end);

 private:
  struct Slot {
    Participant* participant = nullptr;
    Time deadline = never;
    std::uint32_t position = 0;  // in heap_
    Rank rank = Rank::node;
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

  std::vector<Slot> slots_;
  std::vector<Place> heap_;  // binary heap, earliest first
  Time now_{};
};

}  // namespace canopus::can
