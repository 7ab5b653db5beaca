#pragma once
// What all controllers and wires of a bus share. Only the sources of the bus include this.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/can/bus_statistics.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/sim/bus/faults/fault_plan.hpp"
#include "canopus/sim/bus/wire/acceptance_table.hpp"
#include "canopus/sim/bus/wire/wire_observer.hpp"

namespace canopus::sim {

class BusPort;
class LineClocks;

/// When the bus acts next.
class BusSchedule {
 public:
  virtual void deadline_changed() noexcept = 0;

 protected:
  ~BusSchedule() = default;
};

/// What all controllers of a bus share.
struct BusCore {
  BusCore(std::string bus_name, std::uint32_t bus_bit_rate, can::Timeline& bus_timeline,
          BusSchedule& bus_schedule);
  ~BusCore();
  BusCore(const BusCore&) = delete;
  BusCore& operator=(const BusCore&) = delete;

  /// Something outside of the bus's own tick changed when the bus has to act.
  void deadline_changed() {
    if (!ticking) schedule.deadline_changed();
  }

  /// Reports the errors of this moment to the observers, and then the new states of controllers.
  void report(can::Time now) {
    if (!error_reports.empty() || !controller_reports.empty()) [[unlikely]]
      report_all(now);
  }
  /// Some observer of the wire needs every bit.
  [[nodiscard]] bool needs_bits() const noexcept;

  /// The bus has done what it does at the timeline's now.
  [[nodiscard]] bool has_ticked() const noexcept {
    return !timeline.is_running() || (!ticking && ticked == timeline.now());
  }

  std::string name;
  std::uint32_t bit_rate;
  can::Time created{};
  can::Timeline& timeline;
  BusSchedule& schedule;
  bool ticking = false;
  can::Time ticked = can::never;  // the last tick's moment
  std::vector<std::unique_ptr<BusPort>> ports;
  std::vector<can::BusObserver*> observers;
  std::vector<WireObserver*> wire_observers;
  std::vector<can::BusErrorReport> error_reports;  // of the present moment
  std::vector<can::ControllerReport> controller_reports;
  can::BusStatistics statistics;
  can::BusStatistics far_statistics;  // of `statistics`, what was on the far side of a cut
  AcceptanceTable acceptance;
  FaultPlan plan;
  bool had_faults = false;  // some were set: what they do to the bus beside its frames is to be checked
  // Of a line with length; null: levels are seen at once, and clocks are perfect.
  std::unique_ptr<LineClocks> clocks;
  std::uint64_t frame_number = 0;  // of frames that were computed as a whole

  /// A frame that a fault keeps in its controller.
  struct Delayed {
    can::Time until;
    BusPort* port;
    can::Frame frame;
  };
  std::vector<Delayed> delayed;  // in the order of send()

 private:
  void report_all(can::Time now);
};

}  // namespace canopus::sim
