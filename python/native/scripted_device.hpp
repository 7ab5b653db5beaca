#pragma once
// The behaviour of a simulated device that a program outside gives it, in Python: called when a value that it watches has
// changed, and at multiples of a period.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "canopus/sim/device/application.hpp"
#include "canopus/sim/device/device.hpp"

namespace canopus::python {

class ScriptedDevice final : public sim::DeviceApplication {
 public:
  /// What has happened. `token` is what watch() and every() gave; 0: the device has started, or was reset.
  using Hook = std::function<void(std::size_t token, std::uint64_t value, can::Time now)>;
  explicit ScriptedDevice(Hook hook) : hook_(std::move(hook)) {}

  /// Calls the hook whenever the effective value is another one than before.
  std::size_t watch(const canopen::Entry& entry);
  /// Calls the hook so often, from the device's start on. `period` > 0.
  std::size_t every(can::Duration period);
  /// A value was put from outside: what follows from it happens at this moment.
  void value_put(can::Time now) noexcept {
    dirty_since_ = now;
    set_alarm();
  }
  /// A value was put by the hook.
  void changed() noexcept { has_changed_ = true; }

  void start(sim::Device& device, can::Time now) override;
  bool act(sim::Device& device, can::Time now) override;
  [[nodiscard]] can::Alarm& alarm() noexcept override { return alarm_; }

 private:
  struct Watch {
    std::size_t token = 0;
    canopen::Entry entry{};
    std::uint64_t last = 0;
  };
  struct Timer {
    std::size_t token = 0;
    can::Duration period{};
    can::Time next = can::never;
  };
  void set_alarm() noexcept;

  Hook hook_;
  std::vector<Watch> watches_;
  std::vector<Timer> timers_;
  std::size_t last_token_ = 0;
  can::Time dirty_since_ = can::never;
  bool has_changed_ = false;
  can::Alarm alarm_;
};

}  // namespace canopus::python
