#pragma once
// Error control of the slaves, by heartbeat (1016H, consumed by the node itself) and by guarding (1F81H), and
// the states and error bits that are shown of them [CiA 302-2; ME3CAN1-Q 4.6.7, 4.6.8, 4.8.7, notes B9].
//
//   heartbeat      first one: active -- consumer time over: missing, an error control event
//   guarding       every guard time a remote frame -- life time over: lost, an error control event
//   guarded state  not the one it was commanded to: an error control event
//
// What an event means for the network is the start-up's: MasterContext::slave_lost().

#include <cstdint>

#include "canopus/manager/nmt/master_context.hpp"

namespace canopus::manager {

class ErrorControl {
 public:
  explicit ErrorControl(MasterContext& master) : master_(master) {}

  // --- what comes in
  /// From the node's heartbeat consumer; `state` initialising = boot-up.
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now);
  void heartbeat_lost(std::uint8_t node_id, can::Time now);
  void boot_up(std::uint8_t node_id, can::Time now);
  /// A heartbeat or a guarding answer, with bit 7. False: a guarding answer that does not count.
  bool state_message(std::uint8_t node_id, std::uint8_t byte, can::Time now);
  /// The start-up found it, or did not.
  void presence_known(std::uint8_t node_id, bool present, can::Time now);
  /// A command was sent; node_id 0: to all.
  void commanded(canopen::NmtCommand command, std::uint8_t node_id, can::Time now);

  // --- guarding
  /// 1F81H has guarding for the node, and 1016H does not watch it.
  [[nodiscard]] bool guards(std::uint8_t node_id) const;
  /// Sends one remote frame.
  void request_state(std::uint8_t node_id);
  void start_guarding(std::uint8_t node_id, can::Time now);
  void stop_guarding(std::uint8_t node_id, can::Time now);
  void guarding_tick(std::uint8_t node_id, can::Time now);

  // --- lost heartbeats: reported in the next tick, not from inside the node
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }
  void forget_lost_heartbeats() noexcept;

  /// Nothing is known of any node.
  void forget(can::Time now);
  /// Clears the error bits, not the two activity bits, of one node, or of all (0).
  void clear(std::uint8_t node_id, can::Time now);

 private:
  void check_guarded_state(std::uint8_t node_id, std::uint8_t state, can::Time now);
  /// True: it has begun to be in another state than expected.
  bool is_newly_wrong(std::uint8_t node_id, std::uint8_t state, can::Time now);
  void show_commanded(canopen::NmtCommand command, std::uint8_t node_id, can::Time now);
  void resolve(std::uint8_t node_id, can::Time now);
  void event(std::uint8_t node_id, ErrorControlEvent event, can::Time now);

  MasterContext& master_;
  can::Alarm alarm_;  // set while there are slaves with Slave::heartbeat_lost
};

}  // namespace canopus::manager
