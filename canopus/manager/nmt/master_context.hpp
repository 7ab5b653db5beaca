#pragma once
// What the parts of one NMT master share: its node, whose dictionary configures them, its options, what is
// known of each slave, the alarms; and what they ask of the master as a whole.
//
// Whatever waits has an alarm: those of a node's boot and guarding belong to the node's (`alarms`), all others to
// number 0.

#include <array>
#include <cstdint>
#include <span>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/manager/boot/boot_host.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/manager/nmt/slave.hpp"
#include "canopus/manager/sdo/node_alarms.hpp"

namespace canopus::manager {

class NmtCommandQueue;

/// Node-ID of a command to all.
inline constexpr std::uint8_t all_nodes = 0;

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
