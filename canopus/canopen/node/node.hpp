#pragma once
// One CANopen node: its object dictionary and the services that live on it (NMT slave, SDO server, PDOs,
// SYNC, TIME, EMCY, heartbeat, node guarding), each configured by the dictionary's own objects [CiA 301].
//
// A node is passive: it gets what came in and what time it is, sends through the Sink it was given, and
// sets its alarm to the time of its next tick. A service whose objects are missing from the dictionary is simply not
// there.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/dictionary/parameter_store.hpp"
#include "canopus/canopen/sdo/sdo_channel.hpp"
#include "canopus/canopen/service/identifier_filter.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/canopen/service/node_context.hpp"
#include "canopus/canopen/service/node_options.hpp"

namespace canopus::canopen {

class NodeListener;
struct TimeOfDay;

class Node final : public can::Participant {
 public:
  /// The node is off until power_on(). `sink` and the listener must outlive it. node_id 1..127; with FFH (not
  /// configured) it stays in Initialisation, sends and processes nothing, until it has another one and is reset.
  Node(std::shared_ptr<const DictionaryDescription> description, std::uint8_t node_id, can::Sink& sink,
       NodeOptions options = {});
  ~Node() override;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  void set_listener(NodeListener* listener) noexcept;

  /// Initialisation: defaults (then NodeListener::reset_done, where stored values are put in), boot-up
  /// message, Pre-operational.
  void power_on(can::Time now);
  /// Silent until power_on().
  void power_off();
  /// Makes dictionary and services anew, by another description and other options, while the node is off. Node-ID, listener,
  /// parameter store and the handlers of attach() stay; values, an active master and a paused heartbeat do not. What throws
  /// (std::bad_alloc) leaves the node as it was. References into dictionary() end here.
  void describe(std::shared_ptr<const DictionaryDescription> description, const NodeOptions& options);
  /// Another place for its frames, which must outlive it. As describe() with the description and options that there are.
  void set_sink(can::Sink& sink);

  /// Calls `handler` for the objects first..last of this dictionary and of any later one (describe()), in place of the handler that they
  /// have, the node's own or one of an earlier call. It must outlive the node, or be taken out.
  void attach(std::uint16_t first, std::uint16_t last, ObjectHandler& handler);
  /// `handler` is called no more; what it took the place of is again. Not from inside a call of it.
  void detach(const ObjectHandler& handler) noexcept;

  /// Takes effect at the next power_on() or reset.
  void set_node_id(std::uint8_t node_id) noexcept;

  [[nodiscard]] std::uint8_t node_id() const noexcept { return context_->node_id; }
  [[nodiscard]] NmtState state() const noexcept { return context_->state; }
  /// Until the next describe() or set_sink().
  [[nodiscard]] ObjectDictionary& dictionary() noexcept { return context_->dictionary; }
  [[nodiscard]] const ObjectDictionary& dictionary() const noexcept { return context_->dictionary; }

  /// Obeys an NMT command as if it had come from the bus, addressed to this node.
  void command(NmtCommand command, can::Time now);
  /// A communication error of the application's own finding: 1029:01 decides (only bus-off and the like;
  /// heartbeat and life guarding events are seen to by the node unless it is the active NMT master).
  void communication_error(can::Time now);
  /// The active NMT master ignores broadcast NMT frames, produces SYNC and TIME if configured, and does not
  /// react to heartbeat losses with 1029H [ME3CAN1-Q 4.7, 4.8.3].
  void set_active_master(bool active, can::Time now);

  /// Emergency: sets 1001H, puts the code on top of 1003H, sends. `error_register` bits are OR-ed into 1001H.
  /// False when 1015H has not elapsed or the state does not allow it (nothing is changed then).
  bool emergency(std::uint16_t code, std::uint8_t error_register,
                 std::span<const std::uint8_t, 5> manufacturer, can::Time now);
  /// All errors are gone: clears 1001H and sends code 0000H.
  bool emergency_reset(can::Time now);

  /// An error that emergency() reported is gone: its entries go out of 1003H. When that leaves none, 1001H is cleared
  /// and code 0000H sent [RJ71CN91 1.7].
  void forget_error(std::uint16_t code, std::span<const std::uint8_t, 5> manufacturer, can::Time now);
  /// Sends no heartbeats while paused, also over resets [RJ71CN91 App. 4].
  void pause_heartbeat(bool paused, can::Time now);

  /// The application changed process values: every event-driven TPDO (and acyclic synchronous one) whose
  /// content differs from what it last sent has its event. Returns how many had.
  unsigned values_changed(can::Time now) { return values_changed(all_values, now); }
  /// The same where, since the last call, values of other places were changed by the node's own services alone, below 2000H.
  unsigned values_changed(ValueMask places, can::Time now);
  /// The application event of one TPDO, changed or not. False when it is not valid, or was dismissed.
  bool tpdo_event(std::uint16_t number, can::Time now);
  /// Sends `value` (up to 4 bytes) to an object of node `node_id` (0 = all nodes) through the MPDO in TPDO
  /// `number`. False: that TPDO is not a valid MPDO in destination addressing mode, or its inhibit time runs.
  bool send_destination_mpdo(std::uint16_t number, std::uint8_t node_id, std::uint16_t index,
                             std::uint8_t sub, std::span<const std::uint8_t> value, can::Time now);
  /// Sends an object of the scanner list 1FA0H-1FCFH through the MPDO in source addressing mode. Values
  /// written through SDO do so by themselves (NodeOptions::sdo_write_is_event).
  bool send_source_mpdo(std::uint16_t index, std::uint8_t sub, can::Time now);
  /// Where 1010H keeps values; nullptr: in the node's own memory, over resets only. Must outlive the node.
  void set_parameter_store(ParameterStore* store) noexcept;
  /// Sends TIME once, if 1012H produces and the state allows.
  bool send_time(const TimeOfDay& time, can::Time now);

  /// SDO client channel 1280H + `number` (0..127) as the dictionary has it, if it is valid.
  [[nodiscard]] std::optional<SdoClientChannel> sdo_client_channel(std::uint8_t number) const;

  /// True when the node would do something with a data or remote frame of this base identifier; others need not be
  /// delivered to it.
  [[nodiscard]] bool wants(std::uint32_t base_identifier) const;
  /// All base identifiers that it wants, in order.
  [[nodiscard]] std::vector<std::uint32_t> wanted_identifiers() const;
  /// True when it listens to any 29-bit identifier.
  [[nodiscard]] bool wants_extended() const;
  /// Changes whenever wants() may answer differently than before.
  [[nodiscard]] std::uint32_t identifiers_revision() const {
    if (context_->identifiers_changed) settle();
    return context_->identifiers_revision;
  }

  /// A frame for another node costs a handful of instructions, without a call where the caller knows that this is a Node.
  void receive(const can::Frame& frame, can::Time now) override {
    if (filter_.may_pass(frame.identifier)) receive_passed(frame, now);
  }
  void tick(can::Time now) override;

 private:
  struct Services;
  void receive_passed(const can::Frame& frame, can::Time now);
  void settle() const;
  void rebuild(std::shared_ptr<const DictionaryDescription> description, can::Sink& sink,
               const NodeOptions& options);
  IdentifierFilter filter_;  // here, for every frame on the bus is checked with it, and with little else
  NodeContext* context_;     // of the services, what the node's owner reads all the time
  std::unique_ptr<Services> services_;
};

}  // namespace canopus::canopen
