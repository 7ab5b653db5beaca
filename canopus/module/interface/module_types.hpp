#pragma once
// Types that a module, its rack and a plant file share: of the CPU, of signals, of buffer memory and of faults.

#include <cstdint>

namespace canopus::module {

/// Buffer memory address, 0..65535, in words.
using BufferAddress = std::uint32_t;

/// CPU operating state as a module sees it.
enum class CpuState : std::uint8_t { stop, run };

/// Direction of a signal, as the CPU names it.
enum class SignalKind : std::uint8_t {
  input,   ///< X: module to CPU
  output,  ///< Y: CPU to module
};

/// A fault that a test or a plant file gives a module.
enum class ModuleFault : std::uint8_t {
  hardware_error,  ///< the module finds its hardware faulty
  watchdog_error,  ///< its firmware hangs: it does nothing any more
  power_error,     ///< its supply was out of range for a moment [FX2N-32CAN 4.2.7]
};

/// What the start-up of the NMT master inside waits for.
enum class StartUp : std::uint8_t {
  none,                 ///< no active NMT master
  booting,              ///< slaves
  waits_for_own_start,  ///< nothing but the own node: 1F80H bit 2, a CPU in STOP, or it left Operational since
  ended,                ///< nothing: the own node is Operational
  halted,  ///< nothing: a mandatory slave was not booted; until the next start-up no slave is booted
};

}  // namespace canopus::module
