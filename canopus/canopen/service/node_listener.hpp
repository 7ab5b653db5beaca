#pragma once
// What a node reports to the application around it.

#include <array>
#include <cstdint>

#include "canopus/can/time.hpp"
#include "canopus/canopen/service/nmt.hpp"

namespace canopus::canopen {

struct Entry;

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

/// What a node reports to the application around it. Every function has an empty default.
class NodeListener {
 public:
  /// The NMT state was entered, by a command, by the end of initialisation or by 1029H.
  virtual void nmt_state_changed(NmtState /*state*/, can::Time) {}
  /// Reset node or reset communication was asked for and is about to begin (values still the old ones).
  virtual void reset_requested(NmtCommand /*which*/, can::Time) {}
  /// The dictionary has its defaults again, all of them (reset node) or 0000H-1FFFH (reset communication);
  /// the stored values follow. Values put in here are defaults, too.
  virtual void defaults_loaded(NmtCommand /*which*/, can::Time) {}
  /// The dictionary has its power-on or stored values again; the boot-up message follows. Values put in here
  /// are what the services start with.
  virtual void reset_done(NmtCommand /*which*/, can::Time) {}
  /// May an NMT start command be obeyed now? [ME3CAN1-Q 4.7: not while the CPU is in STOP]
  virtual bool may_become_operational() { return true; }
  virtual void sync_received(std::uint8_t /*counter, 0 without*/, can::Time) {}
  virtual void time_received(const TimeOfDay&, can::Time) {}
  virtual void emergency_received(const Emergency&, can::Time) {}
  /// An emergency of this node was handed to the sink, or entered 1001H and 1003H while the state forbade
  /// sending.
  virtual void emergency_raised(const Emergency&, can::Time) {}
  /// RPDO `number` (0..511) put new values into the dictionary.
  virtual void rpdo_received(std::uint16_t /*number*/, can::Time) {}
  /// A frame of RPDO `number` was shorter than its mapping (`code` 8210H; not taken), or longer (8220H). Every time; the
  /// emergency message comes with the first one only.
  virtual void rpdo_length_wrong(std::uint16_t /*number*/, std::uint16_t /*code*/, can::Time) {}
  /// RPDO `number` did not come within its event timer (sub-index 05H) after the last time.
  virtual void rpdo_timed_out(std::uint16_t /*number*/, can::Time) {}
  /// TPDO `number` (0..511) was handed to the sink.
  virtual void tpdo_sent(std::uint16_t /*number*/, can::Time) {}
  /// Heartbeat (or boot-up) of a node that 1016H watches. `state` initialising = boot-up.
  virtual void heartbeat_received(std::uint8_t /*node_id*/, NmtState /*state*/, can::Time) {}
  virtual void heartbeat_lost(std::uint8_t /*node_id*/, can::Time) {}
  /// Life guarding (this node as NMT slave): the master's remote frame did not come in time; or it is back.
  virtual void life_guarding_event(bool /*occurred*/, can::Time) {}
  /// Life guarding runs since the master's first remote frame; or it has ended, by its event or by this node's heartbeat.
  virtual void life_guarding_running(bool /*running*/, can::Time) {}
  /// No remote frame came within the guard time (100CH).
  virtual void life_guarding_missed(can::Time) {}
  /// A value was written through an SDO or ObjectDictionary::write(); its own handler has been notified.
  virtual void object_written(const Entry&, can::Time) {}

 protected:
  ~NodeListener() = default;
};

}  // namespace canopus::canopen
