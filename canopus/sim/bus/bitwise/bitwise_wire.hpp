#pragma once
// A wire bit by bit, with a BitController per port: while anything could go another way than in a whole frame, e.g. after an
// error, with an integrating or passive controller, two equal identifiers, another bit rate, or an observer that needs bits.
// Only the sources of the bus include this.
//
// Whenever the wire is quiet, whole frames may go on; when they stop, the frame that is on the wire is replayed here up to the
// present. So both ways of working can follow each other at any moment and give the same times.

#include <cstdint>
#include <vector>

#include "canopus/sim/bus/bitwise/exact_line.hpp"
#include "canopus/sim/bus/bitwise/frame_completion.hpp"
#include "canopus/sim/bus/bitwise/lockstep.hpp"
#include "canopus/sim/bus/bitwise/wire_levels.hpp"
#include "canopus/sim/bus/wire/wire.hpp"

namespace canopus::sim {

class BitwiseWire {
 public:
  explicit BitwiseWire(WireState& wire) noexcept
      : wire_(wire), levels_(wire), lockstep_(wire), line_(wire, levels_, *this), completion_(wire) {}
  BitwiseWire(const BitwiseWire&) = delete;
  BitwiseWire& operator=(const BitwiseWire&) = delete;

  /// WireState::members are others. Returns whether whole frames may go on as far as levels and single ports are concerned.
  [[nodiscard]] bool update_members();
  /// Every port's controller comes to where its bits have it now.
  void before_change();
  /// Something about a port or the wire has changed; the members are updated.
  void after_change(can::Time now) noexcept;
  /// Between before_change() and after_change(): a port has come from another wire.
  void move_in(BusPort& port, const WireState& from);
  [[nodiscard]] WireLevels& levels() noexcept { return levels_; }

  /// Whole frames have stopped: the controllers are brought to where they would be, had the wire worked bit by bit all along.
  void enter(const WireHandover& handover);
  /// On a quiet wire: the members may be others, e.g. without a port that is bus-off for good, or all of them ready for whole frames.
  [[nodiscard]] bool has_new_members() const noexcept;
  /// Whole frames go on.
  void leave(can::Time now);

  // A tick, in two steps:
  /// Ends the bits that end now, and delivers frames that are complete. True: nothing is on the wire, not even the corruption of a
  /// SOF whose sender has left it, and no controller is within a frame or a bit.
  bool end_bits(can::Time now);
  /// Begins and samples the bits that begin or are sampled now, frames among them, and sets WireState::deadline.
  void run_bits(can::Time now);

  /// From the first dominant bit to idle.
  [[nodiscard]] bool is_active() const noexcept { return active_; }
  /// Since when it is active with what the statistics have not counted yet.
  [[nodiscard]] can::Time active_since() const noexcept { return activity_start_; }
  /// The port may begin its frame: the bus is idle for it, and it is not within a bit.
  [[nodiscard]] bool may_begin(const BusPort& port, can::Time now) const noexcept;

  // For ExactLine:
  [[nodiscard]] const std::vector<BusPort*>& sampling() const noexcept { return lockstep_.sampling(); }
  /// Some port's level comes to the wire later.
  [[nodiscard]] bool has_late_drivers() const noexcept { return has_late_drivers_; }
  /// The port samples its bit.
  void sample_port(BusPort& port, can::Time now);
  /// What the port drives from now on comes to the wire, if it does, at once or later.
  static void put_on_wire(BusPort& port, can::Time now);
  /// Reports the outputs of all ports, where others than those whose bits begin may have changed.
  void report_outputs(bool has_changed, can::Time now);
  /// False: it was there already.
  bool set_level(bool dominant, can::Time now);

 private:
  /// What a controller found at its sample point, and what it was before.
  struct Sampled {
    can::FaultConfinement faults;
    BitController::Position position;
    bool is_transmitter = false;
    bool dominant = false;
    BitController::Events events{};
  };
  struct FoundByLeader {
    BusPort* leader;
    Sampled found;
  };
  /// Bits that passed ahead of time, as nothing comes of them but that the controllers go on. What changes about a port before
  /// their end is preceded by rewind().
  struct Ahead {
    struct Before {
      BitProgress progress;
      BusPort::BitPhase phase;
    };
    bool is_active = false;
    can::Time from{};
    can::Time until{};
    bool dominant = false;       // the level before them
    std::vector<Before> before;  // of the ports that sample
  };
  [[nodiscard]] static bool is_sampling(const BusPort& port, can::Time now) noexcept {
    return port.phase.next == now && port.phase.sampling;
  }
  [[nodiscard]] static bool is_between_bits(const BusPort& port, can::Time now) noexcept;
  [[nodiscard]] bool is_quiet(can::Time now) const noexcept;

  void replay_frame(const WireHandover& handover, can::Time until);
  void replay_intermission(const WireHandover& handover, can::Time until);
  void replay(can::Time from, can::Time until);
  /// What is sampled or begins before this moment belongs to the past.
  [[nodiscard]] can::Time past_end() const noexcept;

  void count_activity(can::Time now);
  void begin_frames(can::Time now);
  BusPort* begin_uncontended(can::Time now);
  BusPort* begin_each(can::Time now);
  void begin_frame(BusPort& port, can::Time now);
  [[nodiscard]] bool is_uniform() const noexcept;
  [[nodiscard]] bool may_lockstep_begin(const BusPort& port, can::Time now) const noexcept;
  void simulate_contenders();
  void begin_bits(can::Time now);
  void report_bit(BusPort& port, can::Time now);
  static void start_sampling(BusPort& port, can::Time now) noexcept;
  void wake(BusPort& port, can::Time now);
  void synchronise(BusPort& port, can::Time now);
  void sample(can::Time now);
  void sample_alone(can::Time now);
  [[nodiscard]] bool sample_leaders(can::Time now);
  void apply_to_lockstep(can::Time now);
  void apply_to_follower(BusPort& port, const Sampled& found, can::Time now);
  void join_early(BusPort& leader, const Sampled& found, can::Time now);
  [[nodiscard]] const Sampled* found_by(const BusPort* leader) const noexcept;
  Sampled sample_bit(BusPort& port, can::Time now);
  void apply(BusPort& port, const Sampled& sampled, can::Time now);
  void report_bit_error(BusPort& port, const Sampled& sampled, can::Time now);
  void report_state(BusPort& port, const can::FaultConfinement& before);
  void cancel_abandoned_corruptions(can::Time now);
  void schedule(can::Time now);

  // bits_ahead.cpp
  void run_ahead();
  [[nodiscard]] std::uint64_t most_bits_ahead(can::Time from) const noexcept;
  [[nodiscard]] std::uint64_t pass_frame_bits(std::uint64_t most);
  [[nodiscard]] bool run_bit_ahead();
  void rewind(can::Time until);

  WireState& wire_;
  WireLevels levels_;
  Lockstep lockstep_;
  ExactLine line_;
  FrameCompletion completion_;
  bool dominant_ = false;          // level of the wire
  bool active_ = false;            // from the first dominant bit to idle
  bool has_error_frame_ = false;   // one is counted since the last frame began
  bool replaying_ = false;         // what is found was counted and reported when it was computed as a whole
  bool abandoned_ = false;         // some port found an error, or left the wire
  bool changed_ = false;           // by after_change(), since the last tick
  bool had_changed_ = false;       // the same before the present tick
  bool outputs_changed_ = false;   // some port may drive something else without a bit of its own that begins
  bool begun_ = false;             // some port has begun to receive a frame
  bool has_early_ports_ = false;   // some port does not wait for the bus to be idle
  bool has_late_drivers_ = false;  // some port's level reaches the wire later
  bool is_regular_ = false;        // all ports have one bit rate and no fault, and only they make the level
  can::Time activity_start_{};
  std::vector<FoundByLeader> found_;  // at the present sample point
  std::vector<BusPort*> waiting_;     // of begin_uncontended() and join_early(), kept for its memory
  Ahead ahead_;
};

}  // namespace canopus::sim
