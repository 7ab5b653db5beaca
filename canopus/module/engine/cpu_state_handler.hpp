#pragma once

#include "canopus/module/engine/module_context.hpp"

namespace canopus::module {

class Layer2Mode;
class ModuleNode;

/// What RUN, STOP and errors of the CPU do to a module: NMT state (1029:01), emergency messages, Layer 2, and the model's CpuRules
/// besides.
class CpuStateHandler {
 public:
  /// `node` and `layer2` may be under construction.
  CpuStateHandler(ModuleContext& context, ModuleNode& node, Layer2Mode& layer2)
      : context_(context), node_(node), layer2_(layer2) {}

  void changed(CpuState state, can::Time now);
  /// An error: STOP follows when the CPU was in RUN.
  void failed();
  /// The program does not use the data words any more [FX3U-CAN 6.9].
  void watchdog_expired(can::Time now);
  /// The node begins its work, or does so after an NMT reset. A STOP from before may count only now.
  void node_starts(can::Time now);
  /// After every event: the STOP that counts at the start of the node, once it has left Initialisation.
  void enter_due_stop(can::Time now);
  void initialization_begins() noexcept { stop_is_due_ = false; }
  /// Neither the CPU nor 1029:01 forbids the state Operational.
  [[nodiscard]] bool allows_operational() const;
  /// An error of the CPU, until its next RUN.
  [[nodiscard]] bool has_fault() const noexcept { return has_fault_; }

 private:
  void enter_stop(const EmergencyRow& row, can::Time now);
  void enter_run(can::Time now);
  /// A master that is none while the CPU is in STOP.
  [[nodiscard]] bool is_master_in_run_alone() const;

  ModuleContext& context_;
  ModuleNode& node_;
  Layer2Mode& layer2_;
  CpuState cpu_ = CpuState::run;
  bool has_fault_ = false;
  bool failed_ = false;       // the STOP that comes is an error's
  bool stop_is_due_ = false;  // the node has started with the CPU in STOP
};

}  // namespace canopus::module
