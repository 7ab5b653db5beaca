#pragma once
// Requests by signals: Yn goes ON, the module answers with Xn [ME3CAN1-Q 3.3; RJ71CN91 App. 1]. Which pair is
// for what is the model's signal table.

#include <array>
#include <memory>
#include <span>

#include "canopus/module/engine/request_port.hpp"
#include "canopus/module/engine/signals.hpp"

namespace canopus::module {

class ModuleEngine;

class SignalPort final : public RequestPort, public SignalAccess {
 public:
  SignalPort(ModuleEngine& engine, std::span<const SignalRow> table);

  [[nodiscard]] std::uint32_t inputs() const noexcept override { return signals_.inputs(); }
  [[nodiscard]] std::uint32_t outputs() const noexcept override { return signals_.outputs(); }
  void set_output(unsigned signal, bool on, can::Time now) override;

  [[nodiscard]] SignalAccess* signals() noexcept override { return this; }
  void set_observer(ModuleObserver* observer) override { signals_.set_observer(observer); }
  void done(Request request, can::Time now) override;
  void power_on(can::Time now) override;
  void power_off(can::Time now) override;
  void initialization_begins(can::Time now) override;
  void initialized(bool by_restart, can::Time now) override;
  void fault_found(can::Time now) override;
  void show(can::Time now) override;
  void tick(can::Time now) override;

 private:
  void rising(const SignalRow& row, can::Time now);
  void falling(const SignalRow& row, can::Time now);
  [[nodiscard]] bool wanted(RequestUse use) const;
  void set_input(RequestUse use, bool on, can::Time now);

  ModuleEngine& engine_;
  Signals signals_;
  std::array<const SignalRow*, 32> row_of_{};             // by number
  std::array<const SignalRow*, request_uses> row_for_{};  // by use
  std::array<std::uint32_t, request_uses> bit_of_{};      // of the signals; 0: the model has none
};

/// For a model's table: a port by its signals.
[[nodiscard]] std::unique_ptr<RequestPort> requests_by_signals(ModuleEngine& engine);

}  // namespace canopus::module
