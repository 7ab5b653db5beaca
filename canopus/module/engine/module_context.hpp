#pragma once
// What a module is made of: its state, its settings, the areas of its buffer memory, one CANopen node with its NMT
// master, Layer 2, and the way a program asks. The classes beside it act on these parts, each for one side:
//
//   ModuleEngine       the module: life cycle, words, requests            module_engine.hpp
//   CpuStateHandler    RUN, STOP and errors of the CPU                    cpu_state_handler.hpp
//   ControllerMonitor  error states and queues of the controller          controller_monitor.hpp
//   NetworkEvents      what the CANopen node and the NMT master report    network_events.hpp
//   ModuleCommandHost  what commands need of the module, and send         module_command_host.hpp
//   Layer2OnlineState  on the wire and off it, in the Layer 2 modes       layer2_online_state.hpp
//   ChangeLog, LEDs    what the module shows of itself                    module_indication.hpp

#include <cstdint>
#include <memory>
#include <string_view>

#include "canopus/can/gate.hpp"
#include "canopus/manager/nmt/nmt_master.hpp"
#include "canopus/module/canopen/data_exchange.hpp"
#include "canopus/module/canopen/emergency_buffer.hpp"
#include "canopus/module/canopen/network_settings.hpp"
#include "canopus/module/canopen/nmt_status.hpp"
#include "canopus/module/canopen/time_stamp.hpp"
#include "canopus/module/commands/command_interface.hpp"
#include "canopus/module/engine/emergency_queue.hpp"
#include "canopus/module/engine/exchange_control.hpp"
#include "canopus/module/engine/module_model.hpp"
#include "canopus/module/engine/module_settings.hpp"
#include "canopus/module/engine/profile.hpp"
#include "canopus/module/engine/request_port.hpp"
#include "canopus/module/engine/status_words.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/layer2/layer2.hpp"
#include "canopus/module/lift/lift.hpp"
#include "canopus/module/memory/access_watchdog.hpp"
#include "canopus/module/memory/diagnostics.hpp"
#include "canopus/module/memory/error_status.hpp"
#include "canopus/module/memory/module_state.hpp"
#include "canopus/module/storage/concise_dcf_store.hpp"

namespace canopus::module {

struct ModuleContext {
  /// Everything must outlive it. `port` is still to be set.
  ModuleContext(const ModuleModel& the_model, can::Controller& the_controller, NonVolatileMemory& memory,
                const Profile& the_profile, CommandHost& host);

  /// Of the node in a CANopen mode.
  [[nodiscard]] canopen::NodeOptions node_options(const FunctionModeRow& mode) const;
  /// 1F80H makes the node an NMT master, active or not.
  [[nodiscard]] bool is_master_by_role() const;
  [[nodiscard]] Layer2State layer2_state() const noexcept {
    if (state.canopen_mode()) return Layer2State::inactive;
    return layer2.online() ? Layer2State::online : Layer2State::offline;
  }
  [[nodiscard]] bool any_nmt_error() const noexcept {
    return state.canopen_mode() && nmt_status.any_failure();
  }
  /// For people, at the observer.
  void report(std::string_view what, can::Time now) const {
    if (observer != nullptr) observer->error_raised(what, now);
  }
  /// "G24 = 300", and what there is to say of it.
  void report_word(BufferAddress address, std::uint16_t value, std::string_view what, can::Time now) const;

  const ModuleModel& model;
  can::Controller& controller;
  can::Gate network;  // closed while the LSS search has the controller at another bit rate
  const Profile profile;
  ModuleObserver* observer = nullptr;
  /// Counts what node and master report, but received process data and repeated heartbeats: a callback of theirs that changes a word or a
  /// signal counts here. Without it update(), and what the plant reads of a module, would follow each PDO.
  std::uint64_t change_count = 0;
  ModuleState state;

  BufferMemory buffer;
  ModuleSettings settings;
  ErrorStatus errors;
  Diagnostics diagnostics;
  EmergencyBuffer emergencies;
  NmtStatus nmt_status;
  canopen::Node node;
  manager::NmtMaster master;
  CommandInterface command;
  NetworkSettings network_settings;
  DataExchange process_data;
  LiftData lift;
  Layer2 layer2;
  ProcessDataWindows windows;
  ExchangeControl exchange;
  TimeStamp time_stamp;
  AccessWatchdog watchdog;
  StatusWords status_words;
  ConciseDcfStore concise_dcfs;
  EmergencyQueue own_emergencies;
  std::unique_ptr<RequestPort> port;
};

}  // namespace canopus::module
