#pragma once
// Special relays and registers that the CPU itself sets: its state, its clock, its scans, how many devices it
// has. What a program or a client writes to them is not seen.

#include <chrono>
#include <cstdint>
#include <optional>

#include "canopus/can/time.hpp"
#include "canopus/module/interface/module_types.hpp"
#include "canopus/plc/cpu/device.hpp"
#include "canopus/plc/rack/scan.hpp"

namespace canopus::plc {

/// The cause of the CPU's STOP, coded as in SD203.
enum class StopCause : std::uint8_t { by_switch = 0, remote = 2, error = 4 };

/// An error that has stopped the CPU.
struct CpuError {
  std::uint16_t code = 0;    ///< as SD0 has it, of an FX3 D8067 or D8061; 0: the family has none
  bool is_watchdog = false;  ///< a scan that took too long
  can::Time time{};
};

/// The CPU state in the special devices.
struct CpuCondition {
  module::CpuState state = module::CpuState::run;
  StopCause stop_cause = StopCause::by_switch;
  bool is_paused = false;
  std::optional<CpuError> error{};  ///< the latest one, until RUN
  Scan scan{Scan::default_period};
  std::chrono::local_seconds clock{};  ///< at clock_set
  can::Time clock_set{};
};

/// 16 special relays, from number 16 * block on; `memory` is what was written to them. They are points of
/// model.special_relay(), and the registers of model.special_register().
[[nodiscard]] std::uint16_t special_relays(const CpuModel& model, const CpuCondition& condition,
                                           std::uint32_t block, std::uint16_t memory, can::Time now) noexcept;

/// A special register; none: it is memory.
[[nodiscard]] std::optional<std::uint16_t> special_register(const CpuModel& model,
                                                            const CpuCondition& condition,
                                                            std::uint32_t number, can::Time now) noexcept;

}  // namespace canopus::plc
