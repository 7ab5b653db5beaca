#pragma once
// What the classes of a module's engine share: facts of its model, its state, the words of its buffer memory, and the errors that it
// shows. Each class owns one part of the module, and is the only one that changes it:
//
//   ModuleEngine       the module: life cycle, words, requests, settings  module_engine.hpp
//   ModuleNode         CANopen node, NMT master, their areas and commands module_node.hpp
//   Layer2Mode         plain CAN frames, on the wire and off it           layer2_mode.hpp
//   ControllerMonitor  the CAN controller                                 controller_monitor.hpp
//   CpuStateHandler    RUN, STOP and errors of the CPU                    cpu_state_handler.hpp
//   ChangeLog, LEDs    what the module shows of itself                    module_indication.hpp
//
// Changed by several of them are `errors` and `diagnostics`, as each raises the errors and logs the events of its part, and `port`, by
// which each notifies the program of the end of a request.

#include <memory>
#include <string_view>

#include "canopus/module/engine/module_model.hpp"
#include "canopus/module/engine/module_settings.hpp"
#include "canopus/module/engine/profile.hpp"
#include "canopus/module/engine/request_port.hpp"
#include "canopus/module/memory/access_watchdog.hpp"
#include "canopus/module/memory/diagnostics.hpp"
#include "canopus/module/memory/error_status.hpp"
#include "canopus/module/memory/module_state.hpp"

namespace canopus::module {

struct ModuleContext {
  /// Everything must outlive it. `port` is still to be set.
  ModuleContext(const ModuleModel& the_model, const can::Controller& the_controller,
                NonVolatileMemory& memory, const Profile& the_profile);

  /// For people, at the observer.
  void report(std::string_view what, can::Time now) const {
    if (observer != nullptr) observer->error_raised(what, now);
  }
  /// "G24 = 300", and what there is to say of it.
  void report_word(BufferAddress address, std::uint16_t value, std::string_view what, can::Time now) const;

  const ModuleModel& model;
  const can::Controller& controller;
  const Profile profile;

  // Changed by ModuleEngine alone.
  ModuleObserver* observer = nullptr;
  ModuleState state;
  BufferMemory buffer;
  ModuleSettings settings;
  AccessWatchdog watchdog;

  // Changed by all.
  ErrorStatus errors;
  Diagnostics diagnostics;
  std::unique_ptr<RequestPort> port;
};

}  // namespace canopus::module
