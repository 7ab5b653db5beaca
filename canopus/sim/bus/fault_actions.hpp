#pragma once
// The faults of a bus at work: carries out what its FaultPlan holds at the time of each fault, on the ports and segments of the
// bus. Only the sources of the bus include this.

#include <cstdint>

#include "canopus/sim/bus/segment.hpp"
#include "canopus/sim/bus/wire/bus_core.hpp"

namespace canopus::sim {

class FaultActions {
 public:
  FaultActions(BusCore& core, Segment& near, Segment& far) noexcept : core_(core), near_(near), far_(far) {}

  /// What is due now.
  void run(can::Time now);
  [[nodiscard]] can::Time next() const noexcept;
  /// Ends all faults that are active, before the bus gets other ones.
  void end_all(can::Time now);
  /// Bus::end_fault()
  bool end(std::size_t number, can::Time now);

 private:
  using TimedFault = FaultPlan::TimedFault;
  void release_delayed(can::Time now);
  void run_driver(can::Time now);
  void run_timed(can::Time now);
  void begin(TimedFault& timed, can::Time now);
  void end(TimedFault& timed, can::Time now);
  void end_at(BusPort& port, FaultKind kind, can::Time now);
  [[nodiscard]] const TimedFault* other_active(FaultKind kind, const BusPort& port);
  void babble(TimedFault& timed, can::Time now);
  void make_noise(TimedFault& timed, can::Time now);
  void invert(TimedFault& timed);
  void set_termination(const Termination& termination);
  [[nodiscard]] can::Time after_bits(can::Time now, std::uint64_t bits) const;
  [[nodiscard]] Segment& segment_of(const BusPort& port) noexcept { return near_.has(port) ? near_ : far_; }

  BusCore& core_;
  Segment& near_;
  Segment& far_;
};

}  // namespace canopus::sim
