#pragma once
// What the card does on the network with its parameters of one start: as master (master_role.hpp) or as slave
// (slave_role.hpp).

#include <memory>
#include <optional>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/module/engine/profile.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/interface/slave_boot_record.hpp"
#include "canopus/module/models/as_fcopm/codes.hpp"
#include "canopus/module/models/as_fcopm/configuration.hpp"

namespace canopus::module::as_fcopm {

class Role : public can::Participant {
 public:
  /// What a program has written and the network brought is exchanged so long after the first write: the words of one
  /// access, and of one scan, belong together. Not printed.
  static constexpr can::Duration scan = std::chrono::milliseconds(1);

  [[nodiscard]] virtual const canopen::Node& node() const noexcept = 0;
  /// The card is on the network from now on.
  virtual void start(can::Time now) = 0;
  virtual void stop(can::Time now) = 0;
  virtual void bus_off(can::Time /*now*/) {}
  /// An error stopped the CPU, or it runs again.
  virtual void cpu_failed(bool /*failed*/, can::Time /*now*/) {}

  /// Registers of this role, but SR821, SR822 and SR825.
  [[nodiscard]] virtual std::uint16_t read(BufferAddress address) const noexcept = 0;
  virtual void write(BufferAddress address, std::uint16_t value, can::Time now) = 0;
  /// What SR825 shows while nothing of the module itself is wrong.
  [[nodiscard]] virtual OwnCode code() const noexcept = 0;
  /// SR825 while a configuration is downloaded.
  [[nodiscard]] virtual OwnCode download_code() const noexcept = 0;

  [[nodiscard]] virtual StartUp start_up() const noexcept { return StartUp::none; }
  [[nodiscard]] virtual std::vector<SlaveBootRecord> boots() const { return {}; }
  /// As CommunicationModule has it; by node, those of the first node last.
  [[nodiscard]] virtual std::vector<canopen::Emergency> emergency_history() const { return {}; }
};

/// CiA DS-301 as the card has it: no remote frames, no guarding.
[[nodiscard]] inline canopen::NodeOptions node_options(const Profile& profile) {
  return {.reset_time = profile.nmt_reset_time,
          .unsent_values_are_changed = false,
          .send_tpdos_on_start = false,
          .sdo_write_is_event = false,
          .rtr_transmission_types = false};
}

}  // namespace canopus::module::as_fcopm
