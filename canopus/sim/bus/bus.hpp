#pragma once
// The simulated CAN bus: frames occupy it for their exact number of bits, the lowest identifier wins
// arbitration, and every controller on it has its own bit rate, queues and error counters. Time is virtual:
// the bus is on the timeline that its nodes live on, so the same code runs as fast as possible
// or in step with a clock.
//
// Frames of one moment are arbitrated together: a node that queues a frame in its tick at a moment takes part
// in what starts at that moment. A frame is delivered at the end of its EOF; the next one starts three bits
// (intermission) later at the earliest.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/sim/bus/faults/fault.hpp"

namespace canopus::sim {

struct BusCore;
struct Line;
struct WireArbitration;
struct WireFrame;

// The simulated bus is one of several kinds; what all of them have is named here, too, for whoever works with this one.
using can::Acceptance;
using can::BusError;
using can::BusLoad;
using can::BusObserver;
using can::Port;
using can::PortCounters;
using can::TransmitOrder;

/// Looks at the wire itself. While there is one that needs_bits(), the bus works bit by bit.
class WireObserver {
 public:
  /// Has to hear of everything at its time. If none has, a frame on a healthy wire is told as a whole, by frame_passed(),
  /// when it is complete: of its bits and of the intermission behind it nothing else is told, and nothing before them is
  /// told later.
  [[nodiscard]] virtual bool needs_bits() const noexcept { return true; }
  virtual void frame_passed(const WireFrame& /*frame*/) {}
  /// A frame that went bit by bit is complete; who did not lose to it, but failed before, is not in it.
  virtual void arbitration_passed(const WireArbitration& /*arbitration*/) {}
  /// The level of the wire; under a cut that of its near side.
  virtual void level_changed(bool dominant, can::Time now) = 0;
  /// The level of the far side of a cut; recessive while there is none.
  virtual void far_level_changed(bool /*dominant*/, can::Time /*now*/) {}
  /// What a controller drives; not reported for a port that hangs on no wire.
  virtual void transmit_changed(const Port& port, bool dominant, can::Time now) = 0;
  /// A controller sends its error or overload flag, or its frame takes part in arbitration.
  virtual void activity_changed(const Port& port, bool flagging, bool arbitrating, can::Time now) = 0;
  /// Which field the bit belongs to that begins for a controller; the same field may be said again.
  virtual void field_changed(const Port& /*port*/, can::FrameField /*field*/, can::Time /*now*/) {}
  /// A controller sampled a bit or started anew: its counters may have changed.
  virtual void counters_changed(const Port& /*port*/, can::Time /*now*/) {}

 protected:
  ~WireObserver() = default;
};

class Bus final : public can::Bus {
 public:
  /// bit_rate in bit/s. Adds itself to the timeline, which must outlive the bus.
  Bus(std::string name, std::uint32_t bit_rate, can::Timeline& timeline);
  ~Bus() override;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  [[nodiscard]] const std::string& name() const noexcept override;
  [[nodiscard]] std::uint32_t bit_rate() const noexcept override;
  Port& add_port(std::string name) override;
  [[nodiscard]] std::vector<const Port*> ports() const override;
  /// Replaces all observers by this one; null: by none.
  void set_observer(BusObserver* observer);
  void add_observer(BusObserver& observer) override;
  void remove_observer(BusObserver& observer) override;
  /// While there is a wire observer that needs bits the bus works bit by bit: slower, with the same result.
  void add_observer(WireObserver& observer);
  void remove_observer(WireObserver& observer);
  /// Wire observers hear at once of all that has been on the wire: of the frame that is on it now bit by bit.
  void report_wire();
  /// Replaces all faults by these, numbered in error messages from 1; what the old ones did ends now. Ports
  /// are named as in add_port() and have to exist; the first of a name counts. On error nothing changes.
  std::expected<void, std::string> set_faults(const std::vector<Fault>& faults, std::uint64_t seed);
  /// Of each fault, in the order of set_faults().
  [[nodiscard]] std::vector<FaultState> fault_states() const;
  /// Whether one of the faults cuts the wire, now or later.
  [[nodiscard]] bool can_be_cut() const noexcept;
  /// Of which the times of all that the bus does are multiples, if its participants act at multiples of it: bits, sample
  /// points and synchronisation at the ports' bit rates, and the faults that are set. 1 ns with a line.
  [[nodiscard]] can::Duration time_grid() const noexcept;
  /// A port of this bus that hears nothing of the wire: it is unplugged, or on the far side of a cut.
  [[nodiscard]] bool is_cut_off(const Port& port) const noexcept;
  /// From here on the bus is this line: levels need time, each controller has its own clock and monitors the wire once
  /// a quantum, and all goes bit by bit. Ports are named as in add_port() and may come later; those that are there start
  /// anew. `line.timing` must have no problem().
  void set_line(const Line& line);
  [[nodiscard]] BusLoad load(can::Time now) const override;
  [[nodiscard]] std::uint64_t frames_of(std::uint32_t identifier, bool extended = false) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace canopus::sim
