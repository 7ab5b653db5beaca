#pragma once
// The variables of TON, TOF and TP, and the step of a TON: the native function, and an instruction of linked code of its own.

#include <algorithm>
#include <cstdint>

#include "canopus/program/program.hpp"

namespace canopus::program {

/// IN PT Q ET, since when, IN before, whether it runs.
struct Timer {
  Slot in, preset, q, elapsed, since, before, is_running;

  /// Returns the time that is left, ns.
  std::int64_t run(std::int64_t now) noexcept {
    const std::int64_t most = std::max(static_cast<std::int64_t>(preset), std::int64_t{0});
    const std::int64_t time = std::clamp(now - static_cast<std::int64_t>(since), std::int64_t{0}, most);
    elapsed = static_cast<Slot>(time);
    return most - time;
  }
  void start(std::int64_t now) noexcept {
    since = static_cast<Slot>(now);
    is_running = 1;
  }
  /// Q is TRUE once IN has been TRUE for PT [IEC 61131-3 table 46].
  void run_on_delay(std::int64_t now) noexcept {
    if (in == 0) {
      q = elapsed = before = 0;
      return;
    }
    if (before == 0) start(now);
    before = 1;
    if (q == 0) q = run(now) == 0 ? 1 : 0;
  }
};

bool on_delay(NativeCall& call);

}  // namespace canopus::program
