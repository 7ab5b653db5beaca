#pragma once
// The X and Y signals of a module that has them, bit n = X/Y(head+n), up to 32 each.

#include <cstdint>

#include "canopus/module/engine/request_port.hpp"
#include "canopus/module/interface/observer.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

/// One row of a module's signal table.
struct SignalRow {
  std::uint8_t number = 0;  ///< from the head address on
  RequestUse use = RequestUse::none;
  Modes modes = every_mode;  ///< function modes in which a rising edge of Y means something
};

class Signals {
 public:
  void set_observer(ModuleObserver* observer) noexcept { observer_ = observer; }

  [[nodiscard]] std::uint32_t inputs() const noexcept { return inputs_; }
  [[nodiscard]] std::uint32_t outputs() const noexcept { return outputs_; }
  [[nodiscard]] bool input(unsigned number) const noexcept { return (inputs_ >> number & 1U) != 0; }
  [[nodiscard]] bool output(unsigned number) const noexcept { return (outputs_ >> number & 1U) != 0; }

  void set_input(unsigned number, bool on, can::Time now) {
    if (change(inputs_, number, on) && observer_ != nullptr) {
      observer_->signal_changed(SignalKind::input, number, on, now);
    }
  }
  /// True when it changed: an edge.
  bool set_output(unsigned number, bool on, can::Time now) {
    if (!change(outputs_, number, on)) return false;
    if (observer_ != nullptr) observer_->signal_changed(SignalKind::output, number, on, now);
    return true;
  }
  /// All X signals OFF.
  void clear_inputs(can::Time now) {
    for (unsigned number = 0; inputs_ != 0 && number < 32; ++number) set_input(number, false, now);
  }

 private:
  static bool change(std::uint32_t& signals, unsigned number, bool on) noexcept {
    const std::uint32_t bit = 1U << number;
    if (((signals & bit) != 0) == on) return false;
    signals ^= bit;
    return true;
  }

  std::uint32_t inputs_ = 0;
  std::uint32_t outputs_ = 0;
  ModuleObserver* observer_ = nullptr;
};

}  // namespace canopus::module
