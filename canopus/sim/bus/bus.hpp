#pragma once
// The simulated CAN bus: frames occupy it for their exact number of bits, the lowest identifier wins
// arbitration, and every controller on it has its own bit rate, queues and error counters. Time is virtual:
// the bus is on the timeline that its nodes live on, so the same code runs as fast as possible
// or in step with a clock.
//
// Frames of one moment are arbitrated together: a node that queues a frame in its tick at a moment takes part
// in what starts at that moment. A frame is delivered at the end of its EOF; the next one starts three bits
// (intermission) later at the earliest.

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/sim/bus/fault.hpp"

namespace canopus::sim {

class Bus;
class Port;
struct BusCore;

/// What a controller found wrong [ISO 11898-1 error detection].
enum class BusError : std::uint8_t { none, bit, stuff, crc, form, acknowledgement };

/// What a bus did, for traces and statistics.
class BusObserver {
 public:
  /// A frame was completed on the bus: from the start of its SOF to the end of its EOF. Called before anybody
  /// on the bus is notified.
  virtual void frame_completed(const can::Frame& frame, can::Time start, can::Time end) = 0;
  /// A controller found an error at the sample point of a bit; its error flag follows.
  virtual void error_detected(const Port& /*port*/, BusError /*error*/, can::Time /*now*/) {}

 protected:
  ~BusObserver() = default;
};

/// Looks at the wire itself. While there is one, the bus works bit by bit.
class WireObserver {
 public:
  /// The level of the wire as the first segment has it.
  virtual void level_changed(bool dominant, can::Time now) = 0;
  /// What a controller drives; not reported for a port that hangs on no wire.
  virtual void transmit_changed(const Port& port, bool dominant, can::Time now) = 0;
  /// A controller sends its error or overload flag, or its frame takes part in arbitration.
  virtual void activity_changed(const Port& port, bool flagging, bool arbitrating, can::Time now) = 0;

 protected:
  ~WireObserver() = default;
};

/// Which of its waiting frames a controller offers first.
enum class TransmitOrder : std::uint8_t {
  identifier,  ///< the one that would win arbitration, equal ones in the order of send(): sorted mailboxes
  fifo,        ///< the oldest
};

/// Which frames a port hands to its participant. Filtering changes nothing on the bus.
struct Acceptance {
  std::bitset<2048> base = std::bitset<2048>{}.set();  ///< base identifiers
  bool extended = true;                                ///< all extended identifiers or none
};

/// What a controller counted since its port was added.
struct PortCounters {
  std::uint64_t transmitted = 0;        ///< frames completed
  std::uint64_t received = 0;           ///< frames handed to the participant
  std::uint64_t receive_overflows = 0;  ///< frames lost because the participant did not take them
  std::uint64_t errors = 0;             ///< errors this controller detected
  std::uint64_t bus_offs = 0;
};

/// A controller plugged into the bus, and the participant behind it.
class Port : public can::Controller {
 public:
  /// The participant that hears this port. Its deadline is refreshed in the timeline after every call.
  virtual void connect(can::Listener& participant, can::Timeline::Handle handle) = 0;
  /// Nobody hears this port any more; the controller stays on the bus.
  virtual void disconnect() = 0;
  /// Unplugged: hears nothing, its frames wait. A controller that is plugged, switched on, restarted or added
  /// to a running bus takes part after 11 recessive bits.
  virtual void plug(bool plugged) = 0;
  /// Unplugged is not off: what waits is kept, and is sent when it is plugged again.
  void set_power(bool on) override = 0;
  [[nodiscard]] virtual bool plugged() const = 0;
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Default: everything.
  virtual void accept(const Acceptance& acceptance) = 0;
  /// Order and number of waiting frames (1..65535, the one being sent included); empties the queue. Default:
  /// by identifier, 128.
  virtual void set_transmit_queue(TransmitOrder order, std::size_t capacity) = 0;
  [[nodiscard]] virtual const PortCounters& counters() const = 0;
  /// Bus monitoring: hears everything and drives nothing, no acknowledgement, no error flag; send() is
  /// refused.
  virtual void set_listen_only(bool listen_only) = 0;
  /// After bus-off: true (default) = returns by itself after 128 times 11 recessive bits; false = when asked
  /// to by recover(), or at once by restart().
  void set_automatic_recovery(bool automatic) override = 0;
  /// Starts to count the 128 times 11 recessive bits when bus-off; else nothing.
  virtual void recover() = 0;
};

/// How busy a bus is.
struct BusLoad {
  std::uint64_t frames = 0;
  std::uint64_t error_frames = 0;
  std::uint64_t bits = 0;  ///< on the wire, interframe space included
  double now = 0;          ///< share of the last full second that was busy, 0..1
  double peak = 0;         ///< highest `now` so far
};

class Bus final : public can::Ticker {
 public:
  /// bit_rate in bit/s. Adds itself to the timeline, which must outlive the bus.
  Bus(std::string name, std::uint32_t bit_rate, can::Timeline& timeline);
  ~Bus() override;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  [[nodiscard]] const std::string& name() const noexcept;
  [[nodiscard]] std::uint32_t bit_rate() const noexcept;
  /// Adds a controller with the bus's bit rate; it belongs to the bus and lives as long.
  Port& add_port(std::string name);
  /// In the order of add_port().
  [[nodiscard]] std::vector<const Port*> ports() const;
  /// Replaces all observers by this one; null: by none.
  void set_observer(BusObserver* observer);
  /// Observers are called in the order of add and must outlive the bus or be removed.
  void add_observer(BusObserver& observer);
  void remove_observer(BusObserver& observer);
  /// While there is a wire observer the bus works bit by bit: slower, with the same result.
  void add_observer(WireObserver& observer);
  void remove_observer(WireObserver& observer);
  /// Replaces all faults by these, numbered in error messages from 1; what the old ones did ends now. Ports
  /// are named as in add_port() and have to exist; the first of a name counts. On error nothing changes.
  std::expected<void, std::string> set_faults(const std::vector<Fault>& faults, std::uint64_t seed);
  [[nodiscard]] BusLoad load(can::Time now) const;
  /// Frames completed with this identifier. Extended identifiers beyond the first 1024 seen are not counted.
  [[nodiscard]] std::uint64_t frames_of(std::uint32_t identifier, bool extended = false) const;

  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace canopus::sim
