#pragma once
// Flying master [CiA 302-2; ME3CAN1-Q 4.8.10]: several nodes of a network can be its NMT master, and agree
// which one is. Frames without a node-ID in the identifier:
//
//   071H [level, node-ID]  I am the active master        073H  is there an active master?
//   072H                   negotiation begins: wait      075H  is there a master-capable device?  074H  yes
//   076H                   active masters: negotiate
//
//   delay --1F90:02--> detecting (073H) --071H of a better one--> standby
//                          |--071H of a worse one--> 076H, negotiating
//                          `--1F90:01, none-->   Reset communication all (once), negotiating
//   negotiating (072H): each waits level x 1F90:04 + node-ID x 1F90:05; the first to send 071H --> active
//   standby: heartbeat of the active master lost --> Reset communication all, delay
//   active: every 1F90:06 076H, so that a second active master negotiates; 072H or a better 071H ends it
//
// Better is the lower level, then the lower node-ID.

#include <chrono>
#include <cstdint>
#include <string>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"

namespace canopus::manager {

/// 1F90H.
struct FlyingMasterTiming {
  can::Duration time_out = std::chrono::milliseconds(100);           ///< 01: answer to 073H
  can::Duration negotiation_delay = std::chrono::milliseconds(500);  ///< 02: after a reset
  std::uint8_t level = 1;                                            ///< 03: 0 high, 1 medium, 2 low
  can::Duration priority_slot = std::chrono::milliseconds(1500);     ///< 04: more than 127 x device slot
  can::Duration device_slot = std::chrono::milliseconds(10);         ///< 05
  can::Duration detect_cycle = std::chrono::seconds(4);              ///< 06
};

/// How long a node of this node-ID, 1..127, waits in a negotiation before it claims to be the active master.
[[nodiscard]] constexpr can::Duration negotiation_wait(const FlyingMasterTiming& timing,
                                                       std::uint8_t node_id) noexcept {
  return timing.priority_slot * timing.level + timing.device_slot * node_id;
}
/// Every node of one priority answers before any of the next one.
inline constexpr int highest_node_id = 127;
[[nodiscard]] constexpr bool slots_fit(const FlyingMasterTiming& timing) noexcept {
  return timing.priority_slot > highest_node_id * timing.device_slot;
}

/// What the outcome is for.
class FlyingMasterListener {
 public:
  /// This node is the active master.
  virtual void mastership_won(can::Time now) = 0;
  /// It is not any longer (only after mastership_won()).
  virtual void mastership_lost(can::Time now) = 0;
  /// Another node is the active master; returns the time within which its heartbeats must come.
  virtual can::Duration standby_for(std::uint8_t master_node_id, can::Time now) = 0;
  /// Reset communication of all other nodes is to be sent.
  virtual void reset_all_nodes(can::Time now) = 0;

 protected:
  ~FlyingMasterListener() = default;
};

class FlyingMaster {
 public:
  enum class State : std::uint8_t { off, delay, detecting, negotiating, standby, active };

  FlyingMaster(can::Sink& sink, FlyingMasterListener& listener) : sink_(&sink), listener_(&listener) {}

  /// Begins after a power-on or reset communication.
  void start(std::uint8_t node_id, const FlyingMasterTiming& timing, can::Time now);
  /// Silent from now on; the listener is not notified.
  void stop() noexcept;
  void receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

  [[nodiscard]] State state() const noexcept { return state_; }
  /// Node-ID of the active master while standby, own while active, else 0.
  [[nodiscard]] std::uint8_t active_master() const noexcept { return active_master_; }
  /// How long this node waits in a negotiation.
  [[nodiscard]] can::Duration waiting_time() const noexcept { return negotiation_wait(timing_, node_id_); }

 private:
  void enter(State state, can::Time until);
  void negotiate(bool request, can::Time now);
  void claimed(std::uint8_t level, std::uint8_t node_id, can::Time now);
  void become_standby(std::uint8_t master, can::Time now);
  void become_active(can::Time now);
  void resign(can::Time now);
  void send_claim();
  [[nodiscard]] can::Duration whole_negotiation() const noexcept;

  can::Sink* sink_;
  FlyingMasterListener* listener_;
  FlyingMasterTiming timing_;
  std::uint8_t node_id_ = 0;
  std::uint8_t active_master_ = 0;
  State state_ = State::off;
  can::Duration heartbeat_time_{};
  can::Time last_reset_{};  // of all nodes, sent or received
  bool reset_seen_ = false;
  can::Alarm alarm_;
};

// What the times of a flying master come to, for people: after what time it answers a negotiation, and whether priorities overlap
// [CiA 302-2; RJ71CN91 1.9].

/// 1F90H of a dictionary; a sub-index that it has not has the default of a device of this node-ID, 1..127.
[[nodiscard]] FlyingMasterTiming flying_timing(const canopen::ObjectDictionary& objects,
                                               std::uint8_t node_id);

/// "negotiation: 500 ms + 1 x 1500 ms + 5 x 10 ms = 2.05 s after a reset, and 100 ms more while it looks for an active master; asked for
/// by another one: 1.55 s". After a reset: the delay, then negotiation_wait(), and between them the time-out 1F90:01; a node that is asked later
/// waits negotiation_wait() alone.
[[nodiscard]] std::string negotiation_words(const FlyingMasterTiming& timing, std::uint8_t node_id);

/// What is wrong with the slots: 127 device time slots must be less than a priority time slot, or a node of one priority answers when
/// one of the next has begun to. Empty: nothing.
[[nodiscard]] std::string overlapping_slots(const FlyingMasterTiming& timing);

}  // namespace canopus::manager
