#pragma once

#include <optional>

#include "canopus/module/engine/controller_monitor.hpp"

namespace canopus::module {

/// On the wire and off it, in the Layer 2 modes. What of this a model does are its Layer2Rules.
class Layer2OnlineState {
 public:
  Layer2OnlineState(ModuleContext& parts, ControllerMonitor& controller)
      : parts_(parts), controller_(controller) {}

  /// Goes online with the settings of the words, if they make sense; else an error says which does not.
  void go_online(can::Time now);
  void go_offline(can::Time now);
  /// Offline: off the wire, once the frame on it is over.
  void leave_when_silent(can::Time now);
  /// The module does not run from now on.
  void stop() noexcept { off_wire_at_.cancel(); }
  /// The settings are in force: on the wire where offline does not mean off it.
  void initialized();
  /// When leave_when_silent() is to be called again.
  [[nodiscard]] can::Alarm& alarm() noexcept { return off_wire_at_; }

 private:
  void join(can::Time now);
  [[nodiscard]] std::optional<BufferAddress> bad_setting() const;

  ModuleContext& parts_;
  ControllerMonitor& controller_;
  bool wire_left_ = true;
  can::Alarm off_wire_at_;  // the last frame is over for certain
};

}  // namespace canopus::module
