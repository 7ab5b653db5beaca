#include "canopus/sim/bus/wire/bus_core.hpp"

#include <algorithm>

#include "canopus/sim/bus/line/line_clocks.hpp"
#include "canopus/sim/bus/wire/bus_port.hpp"

namespace canopus::sim {

BusCore::BusCore(std::string bus_name, std::uint32_t bus_bit_rate, can::Timeline& bus_timeline,
                 BusSchedule& bus_schedule)
    : name(std::move(bus_name)),
      bit_rate(bus_bit_rate),
      created(bus_timeline.now()),
      timeline(bus_timeline),
      schedule(bus_schedule) {}
BusCore::~BusCore() = default;

bool BusCore::needs_bits() const noexcept {
  return std::ranges::any_of(wire_observers, [](const WireObserver* one) { return one->needs_bits(); });
}

void BusCore::report_all(can::Time now) {
  if (!error_reports.empty()) {
    for (can::BusObserver* observer : observers) observer->errors_reported(error_reports, now);
    error_reports.clear();
  }
  for (const can::ControllerReport& one : controller_reports) {
    for (can::BusObserver* observer : observers) observer->controller_changed(one, now);
  }
  controller_reports.clear();
}

}  // namespace canopus::sim
