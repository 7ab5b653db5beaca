#pragma once
// A communication module in its slot: forwards events to it, reports its changes to the plant's observer, and
// connects the built-in PLC program as the plant file defines.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/interface/download.hpp"
#include "canopus/module/interface/non_volatile_memory.hpp"
#include "canopus/module/interface/observer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/node_registry.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plc/program/built_in_program.hpp"
#include "canopus/plc/program/exchange_monitor.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plant {

class ModuleInRack final : public can::Participant, public module::ModuleObserver, public plc::RackListener {
 public:
  /// `memory` is the module's. The rack's listener is this seat from now on; into its slot the module is put
  /// afterwards.
  ModuleInRack(const ModuleSection& section, std::string_view plc, plc::Rack& rack,
               std::unique_ptr<module::NonVolatileMemory> memory,
               std::unique_ptr<module::CommunicationModule> module, const NodeRegistry& watch,
               PlantObserver& observer);

  module::CommunicationModule& module() noexcept { return *module_; }
  [[nodiscard]] const ModuleSection& section() const noexcept { return section_; }
  NodeStatus& status() noexcept { return status_; }
  const NodeStatus& status() const noexcept { return status_; }

  /// The module's tool downloads this so long after the supply has come for the first time.
  void download_again(module::Download download, can::Duration after) {
    download_again_ = {std::move(download), after};
  }

  /// Adds the slaves that this module boots as the active NMT master.
  void collect_boots(std::vector<SlaveBoot>& all) const;

  /// The status that a PLC program can read.
  [[nodiscard]] ModuleStatus module_status(can::Time now) const;

  /// The reason why the module does not exchange process data, if any.
  [[nodiscard]] std::optional<ModuleTrouble> trouble(can::Time now) const;

  void supply_changed(bool on, can::Time now) override;
  void cpu_changed(module::CpuState state, can::Time now) override;
  void cpu_paused(bool paused, can::Time now) override;

  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& frame, can::Time now) override;
  void controller_changed(can::Time now) override;
  void tick(can::Time now) override;

  void signal_changed(module::SignalKind kind, unsigned number, bool on, can::Time now) override;
  void buffer_written(std::uint32_t address, std::uint16_t value, can::Time now) override;
  void slave_boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) override;
  void error_raised(std::string_view what, can::Time now) override;
  void event_logged(const module::ModuleEventRecord& record) override;
  void module_error(const module::ModuleErrorRecord& record) override;

 private:
  /// The record with a node of another bit rate on the bus, if there is one.
  [[nodiscard]] manager::BootRecord with_bit_rate(std::uint8_t node_id, manager::BootRecord record) const;
  void update(can::Time now);
  void update_state(can::Time now);
  void check_after_stop(can::Time now);
  [[nodiscard]] std::string not_started() const;

  /// The effect of the CPU's STOP on the module's NMT state.
  enum class AfterStop : std::uint8_t {
    nothing,
    stopped,      ///< the CPU is in STOP, and took the module out of Operational
    not_started,  ///< it is in RUN again, and the module was not started
    reported,     ///< likewise, and it was reported to the observer
  };

  struct BootSeen {
    manager::BootStep step = manager::BootStep::idle;
    std::uint32_t attempts = 0;
  };

  ModuleSection section_;
  std::string_view plc_;
  const NodeRegistry& watch_;
  std::string name_;
  std::unique_ptr<module::NonVolatileMemory> memory_;
  std::unique_ptr<module::CommunicationModule> module_;
  plc::Rack& rack_;
  plc::BuiltInProgram program_;
  plc::ExchangeMonitor exchange_watch_;
  PlantObserver& observer_;
  NodeStatus status_;
  std::uint64_t changes_seen_ = 0;  // of the module
  std::vector<std::uint16_t> watched_;
  // Signals that are ON for the built-in program's data exchange.
  std::uint32_t own_inputs_ = 0;
  std::uint32_t own_outputs_ = 0;
  std::array<BootSeen, 128> boots_seen_{};
  can::Alarm next_fault_;
  std::optional<std::pair<module::Download, can::Duration>> download_again_;
  can::Alarm next_download_;
  AfterStop after_stop_ = AfterStop::nothing;
  can::Alarm after_stop_due_;
  can::Time out_of_operation_since_{};
};

}  // namespace canopus::plant
