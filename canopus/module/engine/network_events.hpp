#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/module/engine/controller_monitor.hpp"
#include "canopus/module/engine/cpu_state_handler.hpp"

namespace canopus::module {

/// What the CANopen node and the NMT master report, brought to the areas; and the bit rates that the master's LSS search asks for.
class NetworkEvents final : public canopen::NodeListener,
                            public canopen::ObjectHandler,
                            public manager::MasterListener {
 public:
  /// `module` is notified when its controller has changed.
  NetworkEvents(ModuleContext& parts, CpuStateHandler& cpu, ControllerMonitor& controller,
                can::Participant& module);
  NetworkEvents(const NetworkEvents&) = delete;
  NetworkEvents& operator=(const NetworkEvents&) = delete;

  /// 1011H has taken "load" since this was asked last: the concise DCFs go with the next restart [ME3CAN1-Q 4.6.11].
  [[nodiscard]] bool take_clear_request() noexcept { return std::exchange(clear_concise_dcfs_, false); }

 private:
  // NodeListener
  void nmt_state_changed(canopen::NmtState state, can::Time now) override;
  void reset_requested(canopen::NmtCommand which, can::Time now) override;
  void defaults_loaded(canopen::NmtCommand which, can::Time now) override;
  void reset_done(canopen::NmtCommand which, can::Time now) override;
  bool may_become_operational() override { return cpu_.allows_operational(); }
  void emergency_received(const canopen::Emergency& message, can::Time now) override;
  void emergency_raised(const canopen::Emergency& message, can::Time now) override;
  void rpdo_received(std::uint16_t number, can::Time now) override;
  void rpdo_length_wrong(std::uint16_t number, std::uint16_t code, can::Time now) override;
  void time_received(const canopen::TimeOfDay& time, can::Time now) override;
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) override;
  void heartbeat_lost(std::uint8_t node_id, can::Time now) override;
  void life_guarding_event(bool occurred, can::Time now) override;
  void life_guarding_running(bool running, can::Time now) override;
  void life_guarding_missed(can::Time now) override;
  void object_written(const canopen::Entry& entry, can::Time now) override;

  // ObjectHandler: 0002H-0008H
  canopen::AbortCode before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                 can::Time now) override;
  canopen::AbortCode before_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                  std::span<const std::uint8_t> value, can::Time now) override;

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
  CpuStateHandler& cpu_;
  ControllerMonitor& controller_;
  can::Participant& module_;
  bool clear_concise_dcfs_ = false;
};

}  // namespace canopus::module
