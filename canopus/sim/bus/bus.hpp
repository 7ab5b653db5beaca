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
#include "canopus/sim/bus/wire/wire_observer.hpp"

namespace canopus::sim {

struct Line;

// The simulated bus is one of several kinds; what all of them have is named here, too, for users of this one.
using can::Acceptance;
using can::BusError;
using can::BusLoad;
using can::BusObserver;
using can::Port;
using can::PortCounters;
using can::TransmitOrder;

/// One side of a cut wire.
struct BusSide {
  std::vector<std::string> ports{};  ///< that are plugged there
  double now = 0;                    ///< as in BusLoad
  std::uint64_t frames = 0;          ///< near: of the bus without those that were ever on the far side
  std::uint64_t error_frames = 0;
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
  /// Reports at once to wire observers all that has been on the wire: the frame that is on it now bit by bit.
  void report_wire();
  /// Replaces all faults by these, numbered in error messages from 1; what the old ones did ends now. Ports
  /// are named as in add_port() and have to exist; the first of a name counts. On error nothing changes.
  std::expected<void, std::string> set_faults(const std::vector<Fault>& faults, std::uint64_t seed);
  /// Of each fault, in the order of set_faults().
  [[nodiscard]] std::vector<FaultState> fault_states() const;
  /// Ends the fault of this number in the list of set_faults(), counted from 0; the others go on, and fault_states() keeps
  /// its place. False: there is no such fault, or it is one of raw levels that no frame begins (FaultKind::drive).
  bool end_fault(std::size_t number);
  /// Whether one of the faults cuts the wire, now or later.
  [[nodiscard]] bool can_be_cut() const noexcept;
  /// Of which the times of all that the bus does are multiples, if its participants act at multiples of it: bits, sample
  /// points and synchronisation at the ports' bit rates, and the faults that are set. 1 ns with a line.
  [[nodiscard]] can::Duration time_grid() const noexcept;
  /// A port of this bus that receives nothing from the wire: it is unplugged, or on the far side of a cut.
  [[nodiscard]] bool is_cut_off(const Port& port) const noexcept;
  /// From here on the bus is this line: levels need time, each controller has its own clock and monitors the wire once
  /// a quantum, and all goes bit by bit. Ports are named as in add_port() and may come later; those that are there start
  /// anew. `line.timing` must have no problem().
  void set_line(const Line& line);
  [[nodiscard]] BusLoad load(can::Time now) const override;
  /// While the wire is cut the near side, then the far side; else nothing.
  [[nodiscard]] std::vector<BusSide> sides(can::Time now) const;
  [[nodiscard]] std::uint64_t frames_of(std::uint32_t identifier, bool extended = false) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace canopus::sim
