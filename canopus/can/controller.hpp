#pragma once
// What stands between a protocol object and a bus: where frames go (Sink), what a CAN controller reports of
// itself (Controller), what receives from a bus (Listener), what is called in time (Ticker), and what does
// both, as most do (Participant).

#include <cstdint>

#include "canopus/can/alarm.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::can {

/// Where a protocol object sends its frames.
class Sink {
 public:
  /// Queues a frame for transmission. False: the transmit queue is full (or the controller is off) and the
  /// frame is lost; the sender decides whether to try again.
  virtual bool send(const Frame& frame) = 0;

 protected:
  ~Sink() = default;
};

/// Fault confinement state of a controller [ISO 11898-1].
enum class ErrorState : std::uint8_t {
  error_active,   ///< TEC and REC <= 127
  error_passive,  ///< TEC or REC >= 128
  bus_off,        ///< TEC >= 256: takes no part in the bus
};

/// Bit rates in bit/s that CiA 301 names, and 100 kbit/s, which is common.
inline constexpr std::uint32_t bit_rates[] = {10'000,  20'000,  50'000,  100'000,  125'000,
                                              250'000, 500'000, 800'000, 1'000'000};

/// The controller of one node, as its firmware sees it.
class Controller : public Sink {
 public:
  [[nodiscard]] virtual std::uint16_t transmit_error_counter() const = 0;  ///< TEC 0..256
  [[nodiscard]] virtual std::uint16_t receive_error_counter() const = 0;   ///< REC 0..255
  [[nodiscard]] virtual ErrorState error_state() const = 0;
  [[nodiscard]] virtual std::uint32_t bit_rate() const = 0;  ///< bit/s
  /// Whether it returns from bus-off by itself (after 128 times 11 recessive bits), or by restart() alone.
  /// What it does before this is called is its own business; a controller that cannot choose ignores it.
  virtual void set_automatic_recovery(bool /*automatic*/) {}
  /// Changes the bit rate and starts the controller anew: counters 0, error active, transmit queue empty.
  virtual void restart(std::uint32_t bit_rate) = 0;
  /// Off: as if it had no supply. It receives nothing, acknowledges nothing, pending frames are lost, send() refuses.
  /// On: as after restart() with the bit rate it has. A controller whose supply cannot be switched ignores it.
  virtual void set_power(bool /*on*/) {}
  /// Frames that send() refused since the last restart().
  [[nodiscard]] virtual std::uint32_t transmit_overflows() const = 0;
  /// Received frames lost because they were not read in time, since the last restart().
  [[nodiscard]] virtual std::uint32_t receive_overflows() const { return 0; }
  /// True when send() would take a frame now.
  [[nodiscard]] virtual bool has_room() const { return true; }
  /// Takes back every frame that waits. One that is on the wire is completed, but not repeated when it fails
  /// or loses arbitration. Frames taken back are not reported.
  virtual void abort_transmissions() {}

 protected:
  ~Controller() = default;
};

/// Hears what happens at its place on a bus, and when.
class Listener {
 public:
  virtual ~Listener() = default;
  /// A frame of another node was received without error; `now` is the end of the frame.
  virtual void receive(const Frame& frame, Time now) = 0;
  /// A frame this participant sent was acknowledged and is complete on the bus.
  virtual void transmitted(const Frame& /*frame*/, Time /*now*/) {}
  /// The controller's error state, or a counter's way over the warning limit, changed; or received frames were lost.
  virtual void controller_changed(Time /*now*/) {}
};

/// Has deadlines: sets its alarm whenever the moment of its next tick changes.
class Ticker {
 public:
  Ticker() = default;
  virtual ~Ticker() = default;
  /// The alarm is due (now >= deadline()).
  virtual void tick(Time now) = 0;
  [[nodiscard]] Alarm& alarm() noexcept { return alarm_; }
  /// Earliest moment at which tick() is wanted; never = not at all.
  [[nodiscard]] Time deadline() const noexcept { return alarm_.deadline(); }

 private:
  Alarm alarm_;
};

/// Hears a bus and lives in time.
class Participant : public Listener, public Ticker {};

}  // namespace canopus::can
