#include "canopus/sim/bus/faults/termination.hpp"

#include <algorithm>
#include <cmath>

namespace canopus::sim {
namespace {

constexpr double farad_per_metre = 50e-12;
constexpr double farad_per_node = 100e-12;
constexpr double siemens_per_resistor = 1 / 120.0;
constexpr double siemens_per_node = 1 / 30e3;
constexpr double driver_volts = 3.67;
constexpr double driver_ohms = 50;
constexpr double dominant_volts = 0.9;
constexpr double recessive_volts = 0.5;

struct LineCapacity {
  double ohms;
  [[nodiscard]] double volts() const { return driver_volts * ohms / (ohms + driver_ohms); }
  /// In seconds.
  [[nodiscard]] double release(double farad) const {
    return ohms * farad * std::log(volts() / recessive_volts);
  }
};

LineCapacity line(unsigned resistors, std::size_t nodes) {
  return {1 / (siemens_per_resistor * resistors + siemens_per_node * static_cast<double>(nodes))};
}

}  // namespace

Termination termination(unsigned resistors, double length, std::size_t nodes) noexcept {
  const LineCapacity present = line(resistors, std::max<std::size_t>(nodes, 1));
  if (present.volts() < dominant_volts) return {.is_weak = true};
  const LineCapacity proper = line(2, std::max<std::size_t>(nodes, 1));
  const double farad = farad_per_metre * length + farad_per_node * static_cast<double>(nodes);
  const double seconds = present.release(farad) - proper.release(farad);
  return {.release = can::Duration(static_cast<std::int64_t>(std::max(seconds, 0.0) * 1e9))};
}

}  // namespace canopus::sim
