#pragma once
// The NMT master of CiA 302-2: starts the network, watches its slaves, brings lost ones back, and sends NMT
// commands on request. Configured by the objects of its own node's dictionary, as far as they exist: 1F80H
// (role and rules), 1F81H (which slaves, how), 1F82H/1F83H (requests), 1F84H-1F88H (expected identities),
// 1F89H (boot time), 1F90H (flying master: flying_master.hpp), 1F26H/1F27H (expected configurations), 1F8AH
// (restore), 1F55H (expected software), 1016H (heartbeats), 102AH (NMT inhibit time).
//
// Start-up (start()): Reset communication, boot every assigned slave (in parallel, one SDO channel each: see
// boot_slave.hpp), own node Operational when all mandatory slaves are booted, slaves started.
//
// Driving it: MasterNode does (master_node.hpp). Otherwise the owner of node and master
//   - calls receive(frame, now) for every frame, *after* Node::receive; tick() and deadline() as of any
//     Participant;
//   - forwards what its NodeListener hears:  nmt_state_changed   -> own_state_changed
//                                            heartbeat_received  -> heartbeat_received
//                                            heartbeat_lost      -> heartbeat_lost
//   - calls start(now) after each power-on, reset node or reset communication of the node (from
//     NodeListener::reset_done or later), and stop(now) when a reset begins or the node goes off.
//
// Frames and commands to the node that these calls cause come in the next tick() (deadline() is then `now`),
// never inside the call, so they may be made from the node's own callbacks; stop() is silent on the bus. Only
// receive(), tick() and the request functions send frames, only tick() commands the node.

#include <cstdint>
#include <memory>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/node.hpp"
#include "canopus/manager/master_options.hpp"
#include "canopus/manager/sdo_requests.hpp"

namespace canopus::manager {

class NmtMaster final : public can::Participant {
 public:
  /// Attaches itself to 1F80H-1F83H and 1F90H of the node's dictionary. `node` and `sink` must outlive it.
  NmtMaster(canopen::Node& node, can::Sink& sink, MasterOptions options = {});
  ~NmtMaster() override;
  NmtMaster(const NmtMaster&) = delete;
  NmtMaster& operator=(const NmtMaster&) = delete;

  void set_listener(MasterListener* listener) noexcept;
  /// nullptr: no configurations.
  void set_configuration_source(ConfigurationSource* source) noexcept;
  /// Options may change at any time (G70, G71) and hold from the next use on.
  [[nodiscard]] MasterOptions& options() noexcept;

  // --- driving
  /// Begins anew as 1F80H says (bit 0 = 0: no master, only the states of heartbeat-watched nodes are shown).
  void start(can::Time now);
  /// Gives everything up: no longer active, all states unknown, no frame is sent.
  void stop(can::Time now);
  void receive(const can::Frame& frame, can::Time now) override;
  /// SDO requests that wait for a full bus do not time out if the owner passes this on.
  void transmitted(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override;
  void own_state_changed(canopen::NmtState state, can::Time now);
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now);
  void heartbeat_lost(std::uint8_t node_id, can::Time now);

  // --- what is going on
  /// The active NMT master.
  [[nodiscard]] bool active() const noexcept;
  /// Node-ID of the network's active master: the own one, or while this flying master stands by the one it
  /// watches; 0 = unknown.
  [[nodiscard]] std::uint8_t active_master() const noexcept;
  /// The start-up, or the boot of a slave that was found, is in progress [ME3CAN1-Q G25.14].
  [[nodiscard]] bool starting() const noexcept;
  /// The start-up ended with a failed mandatory slave, or 1F80H bit 6 stopped the network: no slave is booted
  /// until the next start().
  [[nodiscard]] bool halted() const noexcept;
  /// The active master's own node is not Operational, and nothing else is missing: 1F80H bit 2, a CPU in STOP,
  /// or it has left Operational since. Request NMT to itself (1F82H) goes on from here.
  [[nodiscard]] bool waits_for_own_start() const noexcept;
  /// node_state::... of node 1..127. Nodes without error control: the state last commanded.
  [[nodiscard]] std::uint8_t node_state(std::uint8_t node_id) const noexcept;
  /// error_control::... bits of node 1..127.
  [[nodiscard]] std::uint16_t error_control(std::uint8_t node_id) const noexcept;
  /// Clears the error bits (not the two activity bits) of one node, or of all (0).
  void clear_error_control(std::uint8_t node_id, can::Time now);
  /// How the boot of node 1..127 went or where it is. Turned into words by explain().
  [[nodiscard]] const BootRecord& boot_record(std::uint8_t node_id) const noexcept;
  /// A search for this node by LSS is configured, should it be missing when the boot time is over: 1F89H,
  /// 1F84H-1F88H of the node all set, its 1F81H bits 0, 2 and 3 [ME3CAN1-Q 4.8.11]. See lss_search.hpp.
  [[nodiscard]] bool lss_configured(std::uint8_t node_id) const noexcept;
  /// The LSS master is looking for missing slaves [ME3CAN1-Q G25.10]; the start-up fails when it is done.
  [[nodiscard]] bool lss_active() const noexcept;
  /// The start-up, or a request of read_object() or write_object(), is using the default SDO channel of this
  /// node.
  [[nodiscard]] bool sdo_channel_busy(std::uint8_t node_id) const noexcept;
  /// The concise DCF of this node is being downloaded.
  [[nodiscard]] bool configuring(std::uint8_t node_id) const noexcept;

  // --- requests
  /// Request NMT, as a write to 1F82H: node_id 1..127, or 80H for all nodes; value 04 05 06 07 7F, or 84 85
  /// 86 87 8F (the own node excluded). MasterOptions::not_master, no_sub_index, invalid_value.
  canopen::AbortCode request_nmt(std::uint8_t node_id, std::uint8_t value, can::Time now);
  /// Request node guarding, as a write to 1F83H: 0 stops, 1 starts (only nodes that have guarding
  /// configured). Errors as above.
  canopen::AbortCode request_guarding(std::uint8_t node_id, std::uint8_t value, can::Time now);
  /// Guarding of this node is running (what 1F83H reads).
  [[nodiscard]] bool guarding(std::uint8_t node_id) const noexcept;
  /// Downloads the concise DCF of this node now, as a write of "conf" to 1F25H. Nothing is done for the own
  /// node. no_data without one, MasterOptions::not_master, device_state while the slave is being booted.
  canopen::AbortCode request_configuration(std::uint8_t node_id, can::Time now);
  /// Reads an object of another node over its default SDO channel, as soon as those before it are done; the
  /// start-up and the requests take turns. `done` is called at the end, never from inside this call; it may
  /// make other requests. invalid_value (node-ID), device_state (this node Stopped or in reset). A reset of
  /// this node ends all requests with device_state.
  canopen::AbortCode read_object(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                                 SdoRequests::Done done, can::Time now,
                                 const SdoRequestOptions& options = {});
  /// Writes one; the value is copied.
  canopen::AbortCode write_object(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                                  std::span<const std::uint8_t> value, SdoRequests::Done done, can::Time now,
                                  const SdoRequestOptions& options = {});
  /// Of these, how many to this node have not ended.
  [[nodiscard]] std::size_t pending_requests(std::uint8_t node_id) const noexcept;
  /// Ends those to one node, or to all (0), with local_control.
  void cancel_requests(std::uint8_t node_id, can::Time now);

 private:
  class Engine;
  std::unique_ptr<Engine> engine_;
};

}  // namespace canopus::manager
