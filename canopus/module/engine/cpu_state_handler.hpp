#pragma once

#include "canopus/module/engine/module_context.hpp"

namespace canopus::module {

/// What RUN, STOP and errors of the CPU do to a module: NMT state (1029H:01), emergency messages, Layer 2, and what
/// the model's CpuRules say besides.
class CpuStateHandler {
 public:
  explicit CpuStateHandler(ModuleContext& parts) : parts_(parts) {}

  void changed(CpuState state, can::Time now);
  /// An error: STOP follows when the CPU was in RUN.
  void failed();
  /// The program does not use the data words any more [FX3U-CAN 6.9].
  void watchdog_expired(can::Time now);
  /// The node begins its work, or does so after an NMT reset. A STOP from before may count only now.
  void node_starts(can::Time now);
  /// After every event: the STOP that counts at the start of the node, once it has left Initialisation.
  void enter_due_stop(can::Time now) {
    if (stop_is_due_ && !parts_.state.boot_up_waits) enter_stop(parts_.model.emergencies.cpu_stopped, now);
  }
  void initialization_begins() noexcept { stop_is_due_ = false; }
  /// Neither the CPU nor 1029H:01 forbids the state Operational.
  [[nodiscard]] bool allows_operational() const;

 private:
  void enter_stop(const EmergencyRow& row, can::Time now);
  void enter_run(can::Time now);
  void leave_operational(can::Time now);

  ModuleContext& parts_;
  bool failed_ = false;       // the STOP that comes is an error's
  bool stop_is_due_ = false;  // the node has started with the CPU in STOP
};

}  // namespace canopus::module
