#pragma once
// What the parts of one NMT master share: its node, whose dictionary configures them, its options, what is
// known of each slave, the alarms; and what they ask of the master as a whole.
//
// Whatever waits has an alarm: those of a node's boot and guarding belong to the node's (`alarms`), all others to
// number 0.

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "canopus/can/controller.hpp"
#include "canopus/can/time.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/manager/boot/boot_host.hpp"
#include "canopus/manager/boot/boot_slave.hpp"
#include "canopus/manager/boot/master_options.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/manager/nmt/node_guarding.hpp"
#include "canopus/manager/sdo/node_alarms.hpp"

namespace canopus::manager {

class NmtCommandQueue;

/// Node-ID of a command to all.
inline constexpr std::uint8_t all_nodes = 0;

/// What an NMT master has of one node of its network.
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

class MasterContext : public BootHost {
 public:
  MasterContext(canopen::Node& the_node, const MasterOptions& the_options);

  /// Sends a frame, as far as this node may.
  virtual bool send(const can::Frame& frame) = 0;
  /// Nothing is sent while it is muted: everything is being given up, or LSS has the own controller at
  /// another bit rate.
  virtual void mute(bool muted) = 0;
  /// The command was sent; node_id 0: to all.
  virtual void command_sent(canopen::NmtCommand command, std::uint8_t node_id, can::Time now) = 0;
  /// The queue of NMT commands.
  virtual NmtCommandQueue& commands() = 0;
  /// A node had an error control event.
  virtual void slave_lost(std::uint8_t node_id, can::Time now) = 0;
  /// This master is one of several that shall agree.
  virtual void begin_flying(can::Time now) = 0;

  /// nullptr: none.
  void set_listener(MasterListener* to) noexcept;
  /// Shows another state or other error control bits, and reports the change.
  void set_state(std::uint8_t node_id, std::uint8_t state, can::Time now);
  void set_error_bits(std::uint8_t node_id, std::uint16_t set, std::uint16_t clear, can::Time now);

  // BootHost
  [[nodiscard]] const canopen::ObjectDictionary& dictionary() const override { return node.dictionary(); }
  [[nodiscard]] const MasterOptions& boot_options() const override { return options; }
  [[nodiscard]] std::uint32_t assignment(std::uint8_t node_id) const override;
  [[nodiscard]] can::Duration heartbeat_time(std::uint8_t node_id) const override;
  std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) override;
  Program open_program(std::uint8_t node_id) override;
  [[nodiscard]] unsigned blocks_running() const override;
  void boot_went_on(std::uint8_t node_id, const BootRecord& record, can::Time now) override {
    listener->boot_went_on(node_id, record, now);
  }

  canopen::Node& node;
  MasterOptions options;
  MasterListener* listener;  ///< never nullptr
  ConfigurationSource* source = nullptr;
  std::array<Slave, 128> slaves;  ///< by node-ID; 0 is not used
  NodeAlarms alarms;

 protected:
  ~MasterContext() = default;
};

}  // namespace canopus::manager
