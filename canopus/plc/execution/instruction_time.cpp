#include "canopus/plc/execution/instruction_time.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>

#include "canopus/plc/rack/scan.hpp"

namespace canopus::plc {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

struct Pace {
  microseconds end_processing;  ///< and refresh, of a CPU without anything else to do
  nanoseconds instruction;      ///< between a contact and MOV
};
constexpr Pace pace_of(CpuFamily family) {
  switch (family) {
    case CpuFamily::q: return {microseconds(500), nanoseconds(40)};
    case CpuFamily::iqr: return {microseconds(300), nanoseconds(10)};
    case CpuFamily::fx3: return {microseconds(1000), nanoseconds(500)};
    case CpuFamily::fx5: return {microseconds(500), nanoseconds(100)};
    case CpuFamily::as300: break;
  }
  return {microseconds(1000), nanoseconds(100)};
}

}  // namespace

can::Duration execution_time(CpuFamily family, std::int64_t instructions) noexcept {
  return pace_of(family).instruction * instructions;
}

std::int64_t instructions_within(CpuFamily family, can::Duration time) noexcept {
  return std::max<std::int64_t>(1, time / pace_of(family).instruction);
}

can::Duration estimated_scan(const program::Program& program, CpuFamily family) {
  const can::Duration whole =
      pace_of(family).end_processing + execution_time(family, static_cast<std::int64_t>(program.code.size()));
  constexpr can::Duration step = microseconds(100);
  return std::clamp<can::Duration>((whole + step - nanoseconds(1)) / step * step, Scan::shortest_period,
                                   Scan::longest_period);
}

can::Duration default_watchdog(CpuFamily /*family*/) noexcept { return milliseconds(200); }

}  // namespace canopus::plc
