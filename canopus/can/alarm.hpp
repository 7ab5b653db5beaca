#pragma once
// When an object is to be called next. An object with a deadline has an alarm and sets it; the timeline, or the alarm of the whole that it
// is a part of, is notified when that changes the earliest deadline. Deadlines are pushed, never polled.

#include <compare>
#include <cstdint>

#include "canopus/can/time.hpp"

namespace canopus::can {

class Timeline;

/// A deadline. It reads, and is assigned, as the Time that it holds. It stays as it is until it is set again: an alarm that is not
/// is due without end. One that has parts stands at the earliest of what it was set to itself and of its parts.
class Alarm {
 public:
  Alarm() = default;
  /// Leaves the whole or the timeline that it belongs to.
  ~Alarm();
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  /// can::never: as cancel().
  void set(Time deadline) noexcept {
    if (deadline == own_) return;
    own_ = deadline;
    if (first_part_ == nullptr) return change(deadline);
    if (!is_held_) settle();
  }
  void cancel() noexcept { set(never); }
  /// Sets it, if it would be later otherwise.
  void bring_forward(Time deadline) noexcept {
    if (deadline < own_) set(deadline);
  }
  Alarm& operator=(Time deadline) noexcept {
    set(deadline);
    return *this;
  }
  [[nodiscard]] Time deadline() const noexcept { return deadline_; }
  [[nodiscard]] operator Time() const noexcept { return deadline_; }
  friend bool operator==(const Alarm& alarm, Time time) noexcept { return alarm.deadline_ == time; }
  friend auto operator<=>(const Alarm& alarm, Time time) noexcept { return alarm.deadline_ <=> time; }

  /// `part` belongs to one whole or timeline at most.
  void add_part(Alarm& part) noexcept;
  /// Nothing where it is no part of this.
  void remove_part(Alarm& part) noexcept;

  /// As long as it lives, what becomes of an alarm that has parts is not passed on: for a call that changes several.
  class Hold {
   public:
    explicit Hold(Alarm& whole) noexcept : whole_(whole) { whole_.is_held_ = true; }
    ~Hold() {
      whole_.is_held_ = false;
      whole_.settle();
    }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    Alarm& whole_;
  };

 private:
  friend class Timeline;
  enum class Owner : std::uint8_t { none, whole, timeline };

  void change(Time deadline) noexcept;
  void part_changed(Time before, Time deadline) noexcept;
  void settle() noexcept {
    Time earliest = own_;
    for (const Alarm* part = first_part_; part != nullptr; part = part->next_part_)
      earliest = part->deadline_ < earliest ? part->deadline_ : earliest;
    if (earliest != deadline_) change(earliest);
  }

  Time deadline_ = never;
  Time own_ = never;
  union {
    Alarm* whole_ = nullptr;
    Timeline* timeline_;
  };
  Alarm* next_part_ = nullptr;   // of the same whole
  Alarm* first_part_ = nullptr;  // of this one
  std::uint32_t handle_ = 0;     // at the timeline
  Owner owner_ = Owner::none;
  bool is_held_ = false;
};

}  // namespace canopus::can
