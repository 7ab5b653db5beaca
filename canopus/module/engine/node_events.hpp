#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/module/engine/cpu_state_handler.hpp"

namespace canopus::module {

/// What the CANopen node reports, brought to the areas.
class NodeEvents final : public canopen::NodeListener, public canopen::ObjectHandler {
 public:
  NodeEvents(ModuleContext& parts, CpuStateHandler& cpu);
  NodeEvents(const NodeEvents&) = delete;
  NodeEvents& operator=(const NodeEvents&) = delete;

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

  ModuleContext& parts_;
  CpuStateHandler& cpu_;
  bool clear_concise_dcfs_ = false;
};

}  // namespace canopus::module
