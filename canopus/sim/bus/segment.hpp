#pragma once
// One electrically connected piece of wire and the controllers on it. Only the sources of the bus include
// this.
//
// While nothing is wrong a frame costs two steps: its start, where arbitration and its length are computed,
// and its end, where it is delivered. As soon as anything could go another way (an error, an integrating or
// passive controller, two equal identifiers, another bit rate, somebody who looks at the wire) the segment
// works bit by bit, with a BitController per port, until the bus is idle and healthy again. A change in the
// middle of a frame replays the frame's bits up to now, so that both ways of working can follow each other at
// any moment and give the same times.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "canopus/sim/bus/bus_core.hpp"
#include "canopus/sim/bus/faults/termination.hpp"
#include "canopus/sim/bus/wire/wire_observer.hpp"

namespace canopus::sim {

/// What of a bit follows its sample point: CiA recommends the sample point at 87.5 % of the bit.
[[nodiscard]] constexpr can::Duration after_sample_point(can::Duration bit) noexcept { return bit / 8; }

/// What the bit driver does to a wire.
struct DrivenWire {
  bool is_busy = false;  ///< the wire is its own, whether it drives a level or not
  DrivenLevel level = DrivenLevel::released;
  friend bool operator==(const DrivenWire&, const DrivenWire&) = default;
};

class Segment {
 public:
  /// `is_near`: the wire, or the near side of a cut.
  Segment(BusCore& core, bool is_near) : core_(core), is_near_(is_near) {}

  /// A port was added to the bus, whether to this segment or not.
  void resize();
  /// Looks at all ports again: who is a member, and whether frames can be computed as a whole.
  void reconsider();
  /// A frame is on the wire, or something of one.
  [[nodiscard]] bool busy() const noexcept {
    return state_ == State::frame || state_ == State::lone_frame || active_ ||
           free_from_ > core_.timeline.now();
  }
  /// Since when the wire is busy with what the statistics have not counted yet; can::never: there is nothing.
  [[nodiscard]] can::Time busy_since() const noexcept {
    if (state_ == State::bits) return active_ ? activity_start_ : can::never;
    return state_ == State::idle ? can::never : start_;
  }
  /// What the port offers is going to change, without before_change(): a frame on the wire that comes to be
  /// replayed has to know what it was.
  void snapshot_pending(BusPort& port) noexcept {
    if (state_ == State::frame && port.kept.frame_number != frame_number_)
      port.snapshot_pending(frame_number_);
  }
  /// It has changed.
  [[gnu::always_inline]] void offer_changed(BusPort& port) {
    if (&port == suspended_) [[unlikely]]
      return suspended_offer_changed();
    arbiter_.set(port.index, port.offer());
    if (state_ != State::frame) look_for_start(port);
  }
  /// Something about the port is going to change now that both ways of working have to know.
  void before_change();
  /// It has changed.
  void after_change();
  /// Between the two: the controller starts anew and has to integrate.
  void restart(BusPort& port);
  /// Between the two: the controller leaves the wire.
  void take_off(BusPort& port);
  void tick(can::Time now) {
    if (now < deadline_) return;
    switch (state_) {
      case State::idle: return start(now);
      case State::frame: return finish(now);
      case State::lone_frame: return fail_lone(now);
      case State::bits: return bits_tick(now);
    }
  }
  void report_wire() {
    if (state_ != State::frame || core_.wire_observers.empty()) return;
    before_change();
    after_change();
  }
  /// Forgets what is to happen to the frame on the wire.
  void clear_faults() noexcept {
    faults_ = {};
    faults_ready_ = false;
  }
  /// What the bit driver does to this wire from now on.
  void drive(const DrivenWire& driven);
  /// Noise: what there is on the wire is inverted from now on, or again as it is.
  void invert();
  void set_termination(const Termination& termination);
  /// Between before_change() and after_change(): a port has come from another segment.
  void arrive(BusPort& port, const Segment& from);
  [[nodiscard]] can::Time deadline() const noexcept { return deadline_; }
  /// The port's error counters now. Within a frame that is computed as a whole they are those of its bits.
  [[nodiscard]] can::FaultConfinement counters_of(const BusPort& port) const noexcept;
  /// Observers of the wire look at the port's counters.
  void tell_counters(const BusPort& port, can::Time now);

 private:
  enum class State : std::uint8_t {
    idle,        // nothing on the wire; deadline_ is the next start, or never
    frame,       // deadline_ is the end of EOF
    lone_frame,  // nobody acknowledges; deadline_ is the sample point of the ACK slot
    bits,        // bit by bit; deadline_ is the next sample point or start of a bit
  };

  // segment.cpp: frame by frame
  void start(can::Time now);
  void finish(can::Time now);
  void fail_lone(can::Time now);
  void count_success(BusPort& transmitter);
  [[nodiscard]] bool success_changes_a_controller(const BusPort& transmitter) const noexcept;
  [[nodiscard]] can::FaultConfinement after_success(const BusPort& port,
                                                    const BusPort& transmitter) const noexcept;
  /// An error that the port found now, with its counters as they are.
  void report_error(const BusPort& port, can::BusErrorReport report);
  void deliver(const can::Frame& frame, const BusPort& from, can::Time now) {
    const AcceptanceTable::Receivers few = core_.acceptance.cached_receivers(frame);
    if (!few.are_known) return deliver_to_all(frame, from, now);
    deliver_if_hearing(few.first, frame, from, now);
    deliver_if_hearing(few.second, frame, from, now);
  }
  void deliver_if_hearing(std::size_t number, const can::Frame& frame, const BusPort& from, can::Time now) {
    if (number != from.index && number != AcceptanceTable::no_port &&
        (hearing_[number / 64] >> number % 64 & 1) != 0)
      deliver_to(number, frame, now);
  }
  /// A member that wants it, and has not sent it.
  void deliver_to(std::size_t number, const can::Frame& frame, can::Time now) {
    BusPort& port = *core_.ports[number];
    if (!dropped(port)) port.hear(frame, now);
  }
  void deliver_to_all(const can::Frame& frame, const BusPort& from, can::Time now);
  [[nodiscard]] bool dropped(const BusPort& port) const noexcept {
    return faults_.drop_everywhere || faults_.drop_at == &port;
  }
  void suspended_offer_changed();
  void look_for_start(const BusPort& port);
  void become_idle(can::Time from);
  void suspend(BusPort& port, can::Time until);
  void end_suspension();
  [[nodiscard]] bool somebody_needs_bits() const noexcept;
  [[nodiscard]] bool shows_bits() const noexcept;
  [[nodiscard]] std::uint64_t offer_at_start(const BusPort& port) const noexcept;
  void tell_frame();
  void tell_arbitration(const can::Frame& frame, can::Time start);
  // segment_bits.cpp: bit by bit
  void enter_bits();
  void replay(can::Time until);
  [[nodiscard]] unsigned suspended_bits() const noexcept;
  void replay_intermission(can::Time until);
  void bits_tick(can::Time now, bool may_leave = true);
  void complete_frames(can::Time now);
  void count_activity(can::Time now);
  void forget_given_up();
  bool leave_bits_if_healthy(can::Time now);
  [[nodiscard]] static bool between_bits(const BusPort& port, can::Time now) noexcept;
  [[nodiscard]] bool ready(const BusPort& port, can::Time now) const noexcept;
  void start_waiting(can::Time now);
  [[nodiscard]] bool inverted(const BusPort* at, can::Time now) const noexcept;
  void begin_bits(can::Time now);
  void look_for_views() noexcept;
  [[nodiscard]] bool seen_at(const BusPort& port, can::Time now) const noexcept;
  void put_on_wire(BusPort& port, can::Time now);
  [[nodiscard]] bool driven_level(bool dominant, can::Time now);
  void settle(can::Time now);
  void wake(BusPort& port, can::Time now);
  void synchronise(BusPort& port, can::Time now);
  /// What a controller found at its sample point, and what it was before.
  struct Sampled {
    can::FaultConfinement faults;
    BitController::Position position;
    bool is_transmitter = false;
    BitController::Events events{};
  };
  [[nodiscard]] static bool is_sampling(const BusPort& port, can::Time now) noexcept {
    return port.tap.next == now && port.tap.sampling;
  }
  void sample(can::Time now);
  void sample_port(BusPort& port, can::Time now);
  Sampled look(BusPort& port, can::Time now);
  void conclude(BusPort& port, const Sampled& sampled, can::Time now);
  // segment_line.cpp
  void settle_line(can::Time now, bool has_changed);
  void begin_bit_on_line(BusPort& port, can::Time now);
  void drive_line(BusPort& port, can::Time now);
  void tell_line_level(can::Time now, bool has_changed);
  [[nodiscard]] bool seen_on_line(const BusPort& port, can::Time now) const noexcept;
  void look_on_line(BusPort& port, can::Time now);
  [[nodiscard]] can::Time next_look_on_line(can::Time now) const noexcept;
  // segment_together.cpp
  [[nodiscard]] bool may_join(const BusPort& port) const noexcept;
  [[nodiscard]] bool is_in_step(const BusPort& port, const BusPort& other) const noexcept;
  void gather();
  static void follow(BusPort& port) noexcept;
  void part();
  void tell_together(can::Time now);
  void keep_in_step() noexcept;
  void sample_together(can::Time now);
  void leave_lockstep(const Sampled& found, can::Time now);
  void tell_changes(can::Time now);
  /// It drives nothing any more, as observers hear.
  void fall_silent(BusPort& port);
  void tell_place(const BusPort& port, can::Time now);
  void tell_driven(BusPort& port, can::Time now);
  void tell_activity(BusPort& port, can::Time now);
  void schedule(can::Time now);
  [[nodiscard]] bool quiet(can::Time now) const noexcept;

  BusCore& core_;
  const bool is_near_;
  State state_ = State::idle;
  can::Time deadline_ = can::never;
  can::Time free_from_{};                   // frame by frame: end of the last intermission
  can::Time start_{};                       // of the frame on the wire
  unsigned bits_ = 0;                       // of the frame on the wire
  std::uint64_t frame_number_ = 0;          // of the frame on the wire
  std::vector<WireFrame::Sender> senders_;  // of the frame that was told last
  BusPort* transmitter_ = nullptr;
  Arbiter arbiter_;                     // while a frame is on the wire, its port may still be there with it
  std::uint64_t membership_ = 0;        // how often they were looked for
  std::vector<BusPort*> members_;       // whoever can do anything to the wire or hear it
  std::vector<BusPort*> working_;       // of them, bit by bit: those that have no spokesman
  BusPort* lockstep_leader_ = nullptr;  // of the others
  /// What observers heard last of those that it goes through the bits for; none: they have just joined.
  struct ToldTogether {
    bool dominant;
    bool flagging;
    can::FrameField field;
    friend bool operator==(const ToldTogether&, const ToldTogether&) = default;
  };
  std::optional<ToldTogether> lockstep_reports_;
  bool begun_ = false;                  // somebody has begun to receive a frame
  std::vector<std::uint64_t> hearing_;  // set of members, as in AcceptanceTable
  bool healthy_ = false;                // frames can be computed as a whole
  bool lone_ = false;                   // so can the failures of the only member

  bool failed_ = false;                  // transmitter_ was alone with its last frame
  can::FaultConfinement faults_before_;  // its counters before that
  BusPort* suspended_ = nullptr;         // passive, and the last to send: not offered to the arbiter ...
  can::Time suspended_until_{};          // ... before this
  BusPort* suspended_at_sof_ = nullptr;  // was suspended when the frame on the wire began
  bool counting_ = false;                // some error counter is not 0
  bool changes_ = false;                 // some port has to be notified of its controller

  FrameFaults faults_;         // of the frame on the wire
  bool faults_ready_ = false;  // known before the frame began
  can::Time faults_origin_{};  // its SOF
  can::Duration faults_bit_{};

  // bit by bit
  bool reconsidered_ = false;  // some port may drive something else without a bit of its own that begins
  bool forced_ = false;        // somebody is stuck dominant
  DrivenWire driven_;          // by the bit driver
  bool inverted_ = false;      // by noise
  bool seen_apart_ = false;    // some port sees another level than the wire's
  bool some_early_ = false;    // some port does not wait for the bus to be idle
  bool some_late_ = false;     // some port's level reaches the wire later
  Termination termination_;
  bool is_driven_ = false;           // dominant, by whom the termination concerns
  can::Time released_ = can::never;  // the wire is recessive from here on
  bool line_inverted_ = false;       // by noise or a corruption, on a line with length
  std::vector<BusPort*> looking_;    // now, on a line with length
  bool dominant_ = false;            // level of the wire
  bool active_ = false;              // from the first dominant bit to idle
  bool replaying_ = false;
  bool completing_ = false;   // some frame ends with the present bit
  bool given_up_ = false;     // somebody found an error, or left the wire
  bool changed_ = false;      // by after_change(), since the last tick
  bool error_frame_ = false;  // one is counted since the last frame began
  can::Time activity_start_{};
  can::Frame reported_{};       // as completed ...
  can::Time reported_until_{};  // ... at this moment
};

}  // namespace canopus::sim
