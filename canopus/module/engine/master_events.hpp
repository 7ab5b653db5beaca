#pragma once

#include <cstdint>

#include "canopus/module/engine/controller_monitor.hpp"

namespace canopus::module {

/// What the NMT master reports, brought to the areas; and the bit rates that its LSS search asks for.
class MasterEvents final : public manager::MasterListener {
 public:
  /// `module` hears when the controller has changed.
  MasterEvents(ModuleContext& parts, ControllerMonitor& controller, can::Participant& module);
  MasterEvents(const MasterEvents&) = delete;
  MasterEvents& operator=(const MasterEvents&) = delete;

 private:
  // MasterListener
  void active_changed(bool /*active*/, can::Time) override { ++parts_.change_count; }
  void starting_changed(bool /*starting*/, can::Time) override { ++parts_.change_count; }
  void start_up_finished(can::Time) override { ++parts_.change_count; }
  void slave_booted(std::uint8_t /*node_id*/, can::Time) override { ++parts_.change_count; }
  void error_control_resolved(std::uint8_t /*node_id*/, can::Time) override { ++parts_.change_count; }
  void boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) override;
  void slave_failed(std::uint8_t node_id, manager::BootError error, can::Time now) override;
  void start_up_halted(std::uint8_t node_id, manager::BootError error, can::Time now) override;
  void error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event, can::Time now) override;
  void lss_active_changed(bool active, can::Time now) override;
  void change_bit_rate(std::uint32_t bit_rate, can::Time now) override;
  void lss_search_ended(std::uint8_t node_id, bool found, can::Time now) override;
  void node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time now) override;
  void error_control_changed(std::uint8_t node_id, std::uint16_t bits, can::Time now) override;
  bool sdo_channel_free(std::uint8_t node_id) override { return parts_.command.remote_node() != node_id; }

  ModuleContext& parts_;
  ControllerMonitor& controller_;
  can::Participant& module_;
};

}  // namespace canopus::module
