#pragma once
// One CANopen node: its object dictionary and the services that live on it (NMT slave, SDO server, PDOs,
// SYNC, TIME, EMCY, heartbeat, node guarding), each configured by the dictionary's own objects [CiA 301].
//
// A node is passive: it is told what came in and what time it is, sends through the Sink it was given, and
// says when it wants the next tick. A service whose objects are missing from the dictionary is simply not
// there.

#include <cstdint>
#include <memory>
#include <span>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/nmt.hpp"
#include "canopus/canopen/object_dictionary.hpp"

namespace canopus::canopen {

/// An emergency message as sent or received [CiA 301 7.2.7].
struct Emergency {
  std::uint8_t node_id = 0;         ///< of the sender
  std::uint16_t code = 0;           ///< emergency error code
  std::uint8_t error_register = 0;  ///< 1001H of the sender
  std::array<std::uint8_t, 5> manufacturer{};
};

/// TIME_OF_DAY as the TIME object carries it [CiA 301 7.2.6].
struct TimeOfDay {
  std::uint32_t milliseconds = 0;  ///< after midnight, 28 bits
  std::uint16_t days = 0;          ///< since 1984-01-01
};

/// What the application around a node hears of it. Every function has an empty default.
class NodeListener {
 public:
  /// The NMT state was entered. `by_command`: an NMT frame or Node::command() asked for it (else boot or
  /// 1029H).
  virtual void nmt_state_changed(NmtState /*state*/, can::Time) {}
  /// Reset node or reset communication was asked for and is about to begin (values still the old ones).
  virtual void reset_requested(NmtCommand /*which*/, can::Time) {}
  /// The dictionary has its power-on or stored values again; the boot-up message follows.
  virtual void reset_done(NmtCommand /*which*/, can::Time) {}
  /// May an NMT start command be obeyed now? [ME3CAN1-Q 4.7: not while the CPU is in STOP]
  virtual bool may_become_operational() { return true; }
  virtual void sync_received(std::uint8_t /*counter, 0 without*/, can::Time) {}
  virtual void time_received(const TimeOfDay&, can::Time) {}
  virtual void emergency_received(const Emergency&, can::Time) {}
  /// RPDO `number` (0..511) put new values into the dictionary.
  virtual void rpdo_received(std::uint16_t /*number*/, can::Time) {}
  /// TPDO `number` (0..511) was handed to the sink.
  virtual void tpdo_sent(std::uint16_t /*number*/, can::Time) {}
  /// Heartbeat (or boot-up) of a node that 1016H watches. `state` initialising = boot-up.
  virtual void heartbeat_received(std::uint8_t /*node_id*/, NmtState /*state*/, can::Time) {}
  virtual void heartbeat_lost(std::uint8_t /*node_id*/, can::Time) {}
  /// Life guarding (this node as NMT slave): the master's remote frame did not come in time; or it is back.
  virtual void life_guarding_event(bool /*occurred*/, can::Time) {}

 protected:
  ~NodeListener() = default;
};

/// How a node behaves where CiA 301 leaves a choice or a module's manual differs.
struct NodeOptions {
  /// An event of an event-driven TPDO during its inhibit time: sent when it ends (CiA 301) or forgotten
  /// [ME3CAN1-Q 4.6.5 case 2].
  bool dismiss_events_during_inhibit = false;
  /// Send all valid event-driven TPDOs once on entering Operational.
  bool send_tpdos_on_start = true;
  /// Produce SYNC and TIME only while Node::set_active_master(true) [ME3CAN1-Q 4.6.6, 4.6.9].
  bool sync_needs_active_master = false;
  /// Values written through SDO to mapped objects cause events of the TPDOs that hold them.
  bool sdo_write_is_event = true;
};

class Node final : public can::Participant {
 public:
  /// The node is off until power_on(). `sink` and the listener must outlive it. node_id 1..127.
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
  /// Takes effect at the next power_on() or reset.
  void set_node_id(std::uint8_t node_id) noexcept;

  [[nodiscard]] std::uint8_t node_id() const noexcept;
  [[nodiscard]] NmtState state() const noexcept;
  [[nodiscard]] ObjectDictionary& dictionary() noexcept;
  [[nodiscard]] const ObjectDictionary& dictionary() const noexcept;

  /// Obeys an NMT command as if it had come from the bus, addressed to this node.
  void command(NmtCommand command, can::Time now);
  /// A communication error of the application's own finding: 1029H:01 decides (only bus-off and the like;
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

  /// The application changed process values: every event-driven TPDO (and acyclic synchronous one) whose
  /// content differs from what it last sent has its event. Returns how many had.
  unsigned values_changed(can::Time now);
  /// The application event of one TPDO, changed or not. False when it is not valid, or was dismissed.
  bool tpdo_event(std::uint16_t number, can::Time now);
  /// Sends TIME once, if 1012H produces and the state allows.
  bool send_time(const TimeOfDay& time, can::Time now);

  void receive(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override;

 private:
  struct Services;
  std::unique_ptr<Services> services_;
};

}  // namespace canopus::canopen
