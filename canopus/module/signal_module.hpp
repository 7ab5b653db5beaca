#pragma once
// A module that the PLC program asks by signals: Yn goes ON, the module answers with Xn [ME3CAN1-Q 3.3;
// RJ71CN91 App. 1]. Which pair is for what is the model's signal table.

#include <array>

#include "canopus/module/module_engine.hpp"
#include "canopus/module/signals.hpp"

namespace canopus::module {

class SignalModule : public ModuleEngine, public SignalAccess {
 public:
  [[nodiscard]] SignalAccess* signals() noexcept override { return this; }
  [[nodiscard]] std::uint32_t inputs() const noexcept override { return signals_.inputs(); }
  [[nodiscard]] std::uint32_t outputs() const noexcept override { return signals_.outputs(); }
  void set_output(unsigned signal, bool on, can::Time now) override;
  void power_on(can::Time now) override;
  void set_observer(ModuleObserver* observer) override;
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override;

 protected:
  /// Off until power_on(). Everything must outlive the module.
  SignalModule(const ModuleModel& model, can::Controller& controller, NonVolatileMemory& memory,
               const Profile& profile);

 private:
  void done(Request request, can::Time now) override;
  void initialization_begins(can::Time now) override;
  void initialized(bool by_restart, can::Time now) override;
  void went_off(can::Time now) override;
  void fault_found(can::Time now) override;
  void show(can::Time now) override;

  void rising(const SignalRow& row, can::Time now);
  void falling(const SignalRow& row, can::Time now);
  [[nodiscard]] bool wanted(SignalUse use) const;
  void set_input(SignalUse use, bool on, can::Time now);

  Signals signals_;
  std::array<const SignalRow*, 32> row_of_{};            // by number
  std::array<const SignalRow*, signal_uses> row_for_{};  // by use
  std::array<std::uint32_t, signal_uses> bit_of_{};      // of the signals; 0: the model has none
  can::Time restart_again_at_ = can::never;
};

}  // namespace canopus::module
