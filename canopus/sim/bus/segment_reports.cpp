// What a segment tells those who watch it.

#include "canopus/sim/bus/segment.hpp"

namespace canopus::sim {

void Segment::report_error(const BusPort& port, can::BusErrorReport report) {
  if (core_.observers.empty()) return;
  report.port = &port;
  report.state = port.faults.state();
  report.transmit_errors = port.faults.transmit_errors();
  report.receive_errors = port.faults.receive_errors();
  core_.error_reports.push_back(report);
}

void Segment::fall_silent(BusPort& port) {
  const can::Time now = core_.timeline.now();
  const bool still_dominant = port.on_wire && port.stuck;
  const bool was_dominant = port.shown_dominant && !still_dominant;
  if (was_dominant) port.shown_dominant = false;
  for (WireObserver* observer : core_.wire_observers) {
    if (was_dominant) observer->transmit_changed(port, false, now);
    if (port.tap.flagging || port.tap.arbitrating) observer->activity_changed(port, false, false, now);
    observer->field_changed(port, can::FrameField::idle, now);
  }
  port.tap.reach(false);
  port.tap.driving = port.tap.flagging = port.tap.arbitrating = false;
}

void Segment::tell_place(const BusPort& port, can::Time now) {
  for (WireObserver* observer : core_.wire_observers) observer->field_changed(port, port.bits.field(), now);
}

void Segment::tell_counters(const BusPort& port, can::Time now) {
  for (WireObserver* observer : core_.wire_observers) observer->bit_sampled(port, now);
}

}  // namespace canopus::sim
