#pragma once
// What an NMT master knows of one node of its network.

#include <cstdint>
#include <memory>

#include "canopus/can/time.hpp"
#include "canopus/manager/boot/boot_slave.hpp"
#include "canopus/manager/boot/master_options.hpp"
#include "canopus/manager/nmt/node_guarding.hpp"

namespace canopus::manager {

struct Slave {
  /// Its heartbeats or answers to node guarding come.
  [[nodiscard]] bool is_alive() const noexcept { return heartbeat_alive || guarding.alive(); }
  [[nodiscard]] bool is_booting() const noexcept { return boot && boot->running(); }
  [[nodiscard]] bool is_booted() const noexcept { return boot && boot->booted(); }
  /// The start-up has an SDO transfer with it.
  [[nodiscard]] bool boot_uses_channel() const noexcept { return boot && boot->sdo_busy(); }

  std::unique_ptr<BootSlave> boot;  ///< from its first boot on
  NodeGuarding guarding;
  can::Time expected_since{};                ///< of expected_state
  can::Time reset_since{};                   ///< of boot_up_due
  std::uint16_t error_bits = 0;              ///< error_control::..., as they are shown
  std::uint8_t state = node_state::unknown;  ///< node_state::..., as 1F82H shows it
  std::uint8_t expected_state = 0;           ///< what guarding should see; 0 = no opinion
  bool heartbeat_alive = false;
  bool commanded = false;         ///< expected_state was commanded since its boot-up
  bool heartbeat_lost = false;    ///< to be dealt with in the next tick
  bool in_error = false;          ///< had an error control event, not alive since
  bool wrong_state = false;       ///< guarding does not see expected_state, and that is reported
  bool held = false;              ///< stopped by request: not started again by itself [ME3CAN1-Q 4.8.8]
  bool boot_counted = false;      ///< among the boots that run
  bool boot_up_due = false;       ///< reset, its boot-up message has not come yet
  bool boot_had_channel = false;  ///< the last SDO transfer with it was the start-up's
  bool is_wanted = false;         ///< is to be looked for by LSS
};

}  // namespace canopus::manager
