#pragma once

#include <cstdint>
#include <span>

#include "canopus/module/commands/command_interface.hpp"

namespace canopus::module {

struct ModuleContext;

/// What the commands of the command interface need of the module, and send.
class ModuleCommandHost final : public CommandHost {
 public:
  /// `parts` may be under construction.
  explicit ModuleCommandHost(ModuleContext& parts) : parts_(parts) {}
  ModuleCommandHost(const ModuleCommandHost&) = delete;
  ModuleCommandHost& operator=(const ModuleCommandHost&) = delete;

 private:
  // CommandHost
  std::uint16_t bus_obstacle() const override;
  std::uint8_t own_node_id() const override;
  canopen::ObjectDictionary& dictionary() override;
  can::Duration sdo_time_out() const override;
  bool sdo_channel_free(std::uint8_t node_id) const override;
  EmergencyAnswer send_emergency(std::uint16_t code, std::uint8_t error_register,
                                 std::span<const std::uint8_t, 5> manufacturer, can::Time now) override;
  PlainFrameResult send_plain_frame(std::span<const std::uint16_t> parameters,
                                    std::span<std::uint16_t> faults) override;
  bool is_nmt_master() const override;
  std::uint16_t pdos() const override;
  void map_pdos(PdoMapping mapping, can::Time now) override;
  bool holds_commands() const override;
  bool send_now(const can::Frame& frame) override;
  EmergencyBuffer& emergencies() override;
  const NmtStatus& nmt_status() const override;
  void clear_error_control(std::uint8_t node_id, can::Time now) override;
  void command_finished(can::Time now) override;

  ModuleContext& parts_;
};

}  // namespace canopus::module
