#pragma once
// A bus as the nodes of a plant see it: controllers (ports) that are plugged into it, what observes it, and how
// busy it is. The simulated bus (sim::Bus) and one of this machine's hardware (link::LinkedBus) are both.

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "canopus/can/bus_error.hpp"
#include "canopus/can/controller.hpp"
#include "canopus/can/timeline.hpp"

namespace canopus::can {

class Port;

/// What a bus did, for traces and statistics.
class BusObserver {
 public:
  /// A frame was completed on the bus: from the start of its SOF to the end of its EOF. Called before any participant
  /// on the bus is notified.
  virtual void frame_completed(const Frame& frame, Time start, Time end) = 0;
  /// A controller found an error at the sample point of a bit; its error flag follows.
  virtual void error_detected(const Port& /*port*/, BusError /*error*/, Time /*now*/) {}
  /// The same with its place and what it did, for all ports that found an error at this moment, in one call.
  virtual void errors_reported(std::span<const BusErrorReport> /*reports*/, Time /*now*/) {}
  /// A controller's error state, or its way over or below the warning limit, changed.
  virtual void controller_changed(const ControllerReport& /*report*/, Time /*now*/) {}

 protected:
  ~BusObserver() = default;
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
class Port : public Controller {
 public:
  /// The participant that receives what this port receives.
  virtual void connect(Listener& participant) = 0;
  /// The port has no participant any more; the controller stays on the bus.
  virtual void disconnect() = 0;
  /// Unplugged: receives nothing, its frames wait. A controller that is plugged, switched on, restarted or added
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
  /// Frames that were sent and are not on the bus yet, the one being sent included.
  [[nodiscard]] virtual std::size_t waiting() const = 0;
  /// Bus monitoring: receives everything and drives nothing, no acknowledgement, no error flag; send() is
  /// refused.
  virtual void set_listen_only(bool listen_only) = 0;
  /// After bus-off: true (default) = returns by itself after 128 times 11 recessive bits; false = on request
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

/// A bus and the controllers of this process on it.
class Bus {
 public:
  virtual ~Bus() = default;
  [[nodiscard]] virtual const std::string& name() const noexcept = 0;
  [[nodiscard]] virtual std::uint32_t bit_rate() const noexcept = 0;
  /// False: it is outside of this process and was lost; nothing is received or sent.
  [[nodiscard]] virtual bool is_there() const noexcept { return true; }
  /// Adds a controller with the bus's bit rate; it belongs to the bus and lives as long.
  virtual Port& add_port(std::string name) = 0;
  /// In the order of add_port().
  [[nodiscard]] virtual std::vector<const Port*> ports() const = 0;
  /// Observers are called in the order of add and must outlive the bus or be removed.
  virtual void add_observer(BusObserver& observer) = 0;
  virtual void remove_observer(BusObserver& observer) = 0;
  [[nodiscard]] virtual BusLoad load(Time now) const = 0;
  /// Frames completed with this identifier. Extended identifiers beyond the first 1024 seen are not counted.
  [[nodiscard]] virtual std::uint64_t frames_of(std::uint32_t identifier, bool extended = false) const = 0;
};

}  // namespace canopus::can
