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
//   start_up.hpp           the network's start-up, and what becomes of lost slaves
//   error_control.hpp      heartbeats, guarding, the states and error bits that are shown
//   nmt_command_queue.hpp  commands and their inhibit time
//   nmt_requests.hpp       1F82H and 1F83H
//   flying_start_up.hpp    one of several flying masters
//   master_context.hpp     what these share; slave.hpp: what is known of one slave
//
// Driving it: MasterNode does (master_node.hpp). Otherwise the owner of node and master
//   - calls receive(frame, now) for every frame, *after* Node::receive (PDOs may be left out: nothing is done with
//     them); tick() and deadline() as of any Participant;
//   - forwards what its NodeListener gets:   nmt_state_changed   -> own_state_changed
//                                            heartbeat_received  -> heartbeat_received
//                                            heartbeat_lost      -> heartbeat_lost
//   - calls start(now) after each power-on, reset node or reset communication of the node (from
//     NodeListener::reset_done or later), and stop(now) when a reset begins or the node goes off.
//
// Frames and commands to the node that these calls cause come in the next tick() (deadline() is then `now`),
// never inside the call, so they may be made from the node's own callbacks; stop() is silent on the bus. Only
// receive(), tick() and the request functions send frames, only tick() commands the node.

#include <algorithm>
#include <cstdint>
#include <utility>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/manager/boot/master_options.hpp"
#include "canopus/manager/nmt/error_control.hpp"
#include "canopus/manager/nmt/flying_start_up.hpp"
#include "canopus/manager/nmt/master_context.hpp"
#include "canopus/manager/nmt/master_port.hpp"
#include "canopus/manager/nmt/nmt_command_queue.hpp"
#include "canopus/manager/nmt/nmt_requests.hpp"
#include "canopus/manager/nmt/start_up.hpp"
#include "canopus/manager/sdo/sdo_requests.hpp"

namespace canopus::manager {

class NmtMaster final : public can::Participant, private MasterContext, private SdoChannelGate {
 public:
  /// Attaches itself to 1F80H-1F83H and 1F90H of the node's dictionary. Node and sink must outlive it.
  NmtMaster(canopen::Node& the_node, can::Sink& sink, const MasterOptions& the_options = {});
  NmtMaster(const NmtMaster&) = delete;
  NmtMaster& operator=(const NmtMaster&) = delete;

  void set_listener(MasterListener* to) noexcept { MasterContext::set_listener(to); }
  /// nullptr: no configurations.
  void set_configuration_source(ConfigurationSource* from) noexcept { source = from; }
  /// Options may change at any time (G70, G71) and hold from the next use on; for what waits, from options_changed() on.
  [[nodiscard]] MasterOptions& options() noexcept { return MasterContext::options; }
  void options_changed(can::Time now) { commands_.flush(now); }

  // --- driving
  /// Begins anew as 1F80H says (bit 0 = 0: no master, only the states of heartbeat-watched nodes are shown).
  void start(can::Time now);
  /// Gives everything up: no longer active, all states unknown, no frame is sent.
  void stop(can::Time now);
  void receive(const can::Frame& frame, can::Time now) override;
  /// SDO requests that wait for a full bus do not time out if the owner passes this on.
  void transmitted(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;
  void own_state_changed(canopen::NmtState, can::Time now) { start_up_.own_state_changed(now); }
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) {
    error_control_.heartbeat_received(node_id, state, now);
  }
  void heartbeat_lost(std::uint8_t node_id, can::Time now) { error_control_.heartbeat_lost(node_id, now); }

  // --- what is going on
  /// The active NMT master.
  [[nodiscard]] bool active() const noexcept { return start_up_.active(); }
  /// Node-ID of the network's active master: the own one, or while this flying master stands by the one it
  /// watches; 0 = unknown.
  [[nodiscard]] std::uint8_t active_master() const noexcept {
    return active() ? node.node_id() : flying_.active_master();
  }
  /// The start-up, or the boot of a slave that was found, is in progress [ME3CAN1-Q G25.14].
  [[nodiscard]] bool starting() const noexcept { return start_up_.starting(); }
  /// The start-up ended with a failed mandatory slave, or 1F80H bit 6 stopped the network: no slave is booted
  /// until the next start().
  [[nodiscard]] bool halted() const noexcept { return start_up_.phase() == StartUp::Phase::halted; }
  /// The boot of an assigned slave that is not mandatory has failed [RJ71CN91 G25.13].
  [[nodiscard]] bool optional_slave_failed() const noexcept;
  /// The active master's own node is not Operational, and nothing else is missing: 1F80H bit 2, a CPU in STOP,
  /// or it has left Operational since. Request NMT to itself (1F82H) goes on from here.
  [[nodiscard]] bool waits_for_own_start() const noexcept { return start_up_.waits_for_own_start(); }
  /// node_state::... of node 1..127. Nodes without error control: the state last commanded.
  [[nodiscard]] std::uint8_t node_state(std::uint8_t node_id) const noexcept {
    return nmt_requests_.node_state(node_id);
  }
  /// error_control::... bits of node 1..127.
  [[nodiscard]] std::uint16_t error_control(std::uint8_t node_id) const noexcept {
    return node_id < slaves.size() ? slaves[node_id].error_bits : std::uint16_t{0};
  }
  /// Clears the error bits (not the two activity bits) of one node, or of all (0).
  void clear_error_control(std::uint8_t node_id, can::Time now) { error_control_.clear(node_id, now); }
  /// How the boot of node 1..127 went or where it is. Turned into words by explain().
  [[nodiscard]] const BootRecord& boot_record(std::uint8_t node_id) const noexcept;
  /// A search for this node by LSS is configured, should it be missing when the boot time is over: 1F89H,
  /// 1F84H-1F88H of the node all set, its 1F81H bits 0, 2 and 3 [ME3CAN1-Q 4.8.11]. See slave_search.hpp.
  [[nodiscard]] bool lss_configured(std::uint8_t node_id) const noexcept {
    return start_up_.search().is_configured(node_id);
  }
  /// The LSS master is looking for missing slaves [ME3CAN1-Q G25.10]; the start-up fails when it is done.
  [[nodiscard]] bool lss_active() const noexcept { return start_up_.phase() == StartUp::Phase::searching; }
  /// The start-up, or a request of read_object() or write_object(), is using the default SDO channel of this
  /// node.
  [[nodiscard]] bool sdo_channel_busy(std::uint8_t node_id) const noexcept {
    return requests_.busy(node_id) || (node_id < slaves.size() && slaves[node_id].boot_uses_channel());
  }
  /// The concise DCF of this node is being downloaded.
  [[nodiscard]] bool configuring(std::uint8_t node_id) const noexcept {
    return boot_record(node_id).step == BootStep::configuration;
  }

  // --- requests
  /// Request NMT, as a write to 1F82H: node_id 1..127, or 80H for all nodes; value 04 05 06 07 7F, or 84 85
  /// 86 87 8F (the own node excluded). MasterOptions::not_master, no_sub_index, invalid_value.
  canopen::AbortCode request_nmt(std::uint8_t node_id, std::uint8_t value, can::Time now) {
    return nmt_requests_.request_nmt(node_id, value, now);
  }
  /// Request node guarding, as a write to 1F83H: 0 stops, 1 starts (only nodes that have guarding
  /// configured). Errors as above.
  canopen::AbortCode request_guarding(std::uint8_t node_id, std::uint8_t value, can::Time now) {
    return nmt_requests_.request_guarding(node_id, value, now);
  }
  /// Guarding of this node is running (what 1F83H reads).
  [[nodiscard]] bool guarding(std::uint8_t node_id) const noexcept {
    return node_id < slaves.size() && slaves[node_id].guarding.running();
  }
  /// Downloads the concise DCF of this node now, as a write of "conf" to 1F25H. Nothing is done for the own
  /// node. no_data without one, MasterOptions::not_master, device_state while the slave is being booted.
  canopen::AbortCode request_configuration(std::uint8_t node_id, can::Time now);
  /// Reads an object of another node over its default SDO channel, as soon as those before it are done; the
  /// start-up and the requests take turns. `done` is called at the end, never from inside this call; it may
  /// make other requests. invalid_value (node-ID), device_state (this node Stopped or in reset). A reset of
  /// this node ends all requests with device_state.
  canopen::AbortCode read_object(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                                 SdoRequests::Done done, can::Time now,
                                 const SdoRequestOptions& request_options = {});
  /// Writes one; the value is copied.
  canopen::AbortCode write_object(std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
                                  std::span<const std::uint8_t> value, SdoRequests::Done done, can::Time now,
                                  const SdoRequestOptions& request_options = {});
  /// Of these, how many to this node have not ended.
  [[nodiscard]] std::size_t pending_requests(std::uint8_t node_id) const noexcept {
    return requests_.pending(node_id);
  }
  /// Ends those to one node, or to all (0), with local_control.
  void cancel_requests(std::uint8_t node_id, can::Time now) {
    port_.set_time(now);
    requests_.cancel(node_id, canopen::AbortCode::local_control, now);
  }

 private:
  // MasterContext
  bool send(const can::Frame& frame) override { return port_.send(frame); }
  void mute(bool muted) override { port_.mute(muted); }
  void command_sent(canopen::NmtCommand command, std::uint8_t node_id, can::Time now) override;
  NmtCommandQueue& commands() override { return commands_; }
  void slave_lost(std::uint8_t node_id, can::Time now) override { start_up_.slave_lost(node_id, now); }
  void begin_flying(can::Time now) override { flying_.begin(now); }

  // BootHost
  void send_nmt(canopen::NmtCommand command, std::uint8_t node_id, can::Time now) override {
    commands_.push(command, node_id, now);
  }
  void request_state(std::uint8_t node_id) override { error_control_.request_state(node_id); }
  [[nodiscard]] bool guards(std::uint8_t node_id) const override { return error_control_.guards(node_id); }
  void start_guarding(std::uint8_t node_id, can::Time now) override {
    error_control_.start_guarding(node_id, now);
  }
  bool sdo_channel_free(std::uint8_t node_id, can::Time now) override;
  [[nodiscard]] bool request_waits(std::uint8_t node_id, can::Time now) const override {
    return port_.waits(canopen::cob_id::sdo_request + node_id, now);
  }
  void presence_known(std::uint8_t node_id, bool present, can::Time now) override {
    error_control_.presence_known(node_id, present, now);
  }
  void boot_ended(std::uint8_t node_id, BootError error, can::Time now) override {
    start_up_.boot_ended(node_id, error, now);
  }

  // SdoChannelGate
  bool channel_is_free(std::uint8_t node_id) override;
  void channel_freed(std::uint8_t node_id, can::Time now) override;

  void process(const can::Frame& frame, can::Time now);
  void process_deferred(can::Time now);
  void process_sdo_response(std::uint8_t node_id, const can::Frame& frame, can::Time now);
  void process_error_control(std::uint8_t node_id, const can::Frame& frame, can::Time now);
  void master_tick(can::Time now);
  void node_tick(std::uint8_t node_id, can::Time now);
  void boot_may_have_ended_transfer(std::uint8_t node_id, can::Time now);
  [[nodiscard]] canopen::AbortCode check_sdo_request(std::uint8_t node_id) const noexcept;

  MasterPort port_;
  SdoRequests requests_;
  NmtCommandQueue commands_;
  ErrorControl error_control_;
  StartUp start_up_;
  FlyingStartUp flying_;
  NmtRequests nmt_requests_;
};

}  // namespace canopus::manager
