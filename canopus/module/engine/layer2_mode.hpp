#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "canopus/module/engine/controller_monitor.hpp"
#include "canopus/module/layer2/layer2.hpp"

namespace canopus::module {

/// The Layer 2 modes of a module: plain CAN frames, and when the module is on the wire. What of this a model does are its Layer2Rules.
class Layer2Mode {
 public:
  Layer2Mode(ModuleContext& context, can::Controller& controller, ControllerMonitor& monitor);
  Layer2Mode(const Layer2Mode&) = delete;
  Layer2Mode& operator=(const Layer2Mode&) = delete;

  /// A start of the module: offline. `extended`: 29-bit identifiers.
  void start(bool extended) { layer2_.start(extended); }
  /// The module does not run from now on.
  void stop() noexcept {
    off_wire_at_.cancel();
    layer2_.go_offline();
  }
  /// The settings are in force: on the wire where offline does not mean off it.
  void initialized();
  /// Goes online with the settings of the words, if they make sense; else an error shows which does not.
  void go_online(can::Time now);
  void go_offline(can::Time now);
  /// Offline without the program's request.
  void end() { layer2_.go_offline(); }
  /// Offline: off the wire, once the frame on it is over. After every event.
  void leave_when_silent(can::Time now);
  /// The CPU went from RUN to STOP.
  void cpu_stopped() { layer2_.cpu_stopped(); }
  void request_trigger(bool on) { layer2_.request_trigger(on); }
  /// A frame of the command interface: see Layer2::send().
  PlainFrameResult send(std::span<const std::uint16_t> parameters, std::span<std::uint16_t> faults) {
    return layer2_.send(parameters, faults);
  }

  void receive(const can::Frame& frame, can::Time now) { layer2_.receive(frame, now); }
  /// True: it was the frame of send().
  [[nodiscard]] bool transmitted(const can::Frame& frame) {
    layer2_.transmitted(frame);
    return layer2_.takes_command_frame(frame);
  }
  void tick(can::Time now) {
    if (now >= layer2_.deadline()) layer2_.tick(now);
  }
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

  /// For a data exchange.
  [[nodiscard]] Layer2& slots() noexcept { return layer2_; }
  [[nodiscard]] const Layer2& slots() const noexcept { return layer2_; }
  [[nodiscard]] bool online() const noexcept { return layer2_.online(); }

 private:
  void join(can::Time now);
  [[nodiscard]] std::optional<BufferAddress> bad_setting() const;

  ModuleContext& context_;
  ControllerMonitor& monitor_;
  Layer2 layer2_;
  bool wire_left_ = true;
  can::Alarm off_wire_at_;  // the last frame is over for certain
  can::Alarm alarm_;
};

}  // namespace canopus::module
