#pragma once
// What the controllers of a bus see of a line with length, and when they monitor it: once a quantum, each by its own clock.
// Only the sources of the bus include this.
//
// While no level is on its way, quanta in which nothing new is seen are left out: BitClock::skip().

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/sim/bus/controller/bit_timing.hpp"
#include "canopus/sim/bus/line/line.hpp"

namespace canopus::sim {

class LineClocks {
 public:
  explicit LineClocks(Line line) : line_(std::move(line)) {}

  /// One more port.
  void add(const std::string& name, std::uint32_t bit_rate, can::Time now);
  [[nodiscard]] std::size_t size() const noexcept { return stations_.size(); }

  /// Its bit begins with a quantum now, whatever its clock was doing.
  void restart(std::size_t port, std::uint32_t bit_rate, can::Time now);
  /// Whether the port's clock has a bit of this rate begin now, by itself.
  [[nodiscard]] bool begins_bit(std::size_t port, std::uint32_t bit_rate, can::Time now) const noexcept;
  /// Its clock goes on to now. True: a quantum begins now, and the port monitors the wire.
  bool advance(std::size_t port, can::Time now) noexcept;
  /// One that waits for a dominant bit: only its quanta go on. True: one begins now.
  bool advance_asleep(std::size_t port, can::Time now) noexcept;
  /// It sees a dominant bit: that begins with this quantum.
  void wake(std::size_t port) noexcept;
  /// After advance(): what the quantum is to its bit.
  BitClock::Quantum monitor(std::size_t port, bool dominant, bool hard, bool driving) noexcept {
    return stations_[port].clock.monitor(dominant, hard, driving);
  }
  /// Its next sample point, or its next bit, as synchronisation has them now.
  [[nodiscard]] can::Time sample_point(std::size_t port) const noexcept;
  [[nodiscard]] can::Time end_of_bit(std::size_t port) const noexcept;
  /// The sample point of its next bit, if no level comes to it before.
  [[nodiscard]] can::Time next_sample_point(std::size_t port) const noexcept;
  /// Its clock goes on to end_of_bit(), which nothing was to be seen before.
  void pass_end_of_bit(std::size_t port) noexcept;
  /// A level may be on its way to the port: it has to monitor the wire in every quantum.
  [[nodiscard]] bool monitors(std::size_t port) const noexcept {
    return stations_[port].monitored < changed_ + longest_;
  }
  /// The quantum at or after `now` in which it has to monitor the wire; by itself it would at `then`, a sample point or the end
  /// of a bit.
  [[nodiscard]] can::Time next_quantum(std::size_t port, can::Time now, can::Time then) const noexcept;

  /// What the port puts on the wire now.
  void drive(std::size_t port, bool dominant, can::Time now);
  /// Something else changed what is seen.
  void disturb(can::Time now) noexcept { changed_ = now; }
  /// What is driven or seen has changed now.
  [[nodiscard]] bool has_changed(can::Time now) const noexcept { return changed_ == now; }
  /// Whether `from` is seen dominant at `to`.
  [[nodiscard]] bool sees(std::size_t to, std::size_t from, can::Time now) const noexcept;
  /// The ports that drive dominant, or have until lately.
  [[nodiscard]] const std::vector<std::size_t>& driving() const noexcept { return driving_; }
  /// Forgets what all ports have seen by now.
  void forget(can::Time now) noexcept;

 private:
  struct Change {
    can::Time time;
    bool dominant;
  };
  struct Station {
    double place;
    double stub;
    double ppm;
    BitClock clock;
    std::uint32_t bit_rate;
    can::Time origin{};            // its quanta are counted from here ...
    double phase = 0;              // ... and begin so many ns later
    double quantum = 1;            // ns
    std::uint64_t quanta = 0;      // that have begun for the clock
    can::Time monitored{};         // last
    std::vector<Change> driven{};  // as long as some port may still see it
  };
  void set_rate(Station& station, std::uint32_t bit_rate) noexcept;
  [[nodiscard]] static can::Time quantum_begin(const Station& station, std::uint64_t number) noexcept;
  /// The first that begins at `time` or later.
  [[nodiscard]] static std::uint64_t quantum_from(const Station& station, can::Time time) noexcept;
  [[nodiscard]] static can::Time quanta_later(const Station& station, unsigned quanta) noexcept {
    return quantum_begin(station, station.quanta - 1 + quanta);
  }
  [[nodiscard]] can::Time is_old_at(const Station& station) const noexcept;
  void measure();

  Line line_;
  std::vector<Station> stations_;
  std::vector<std::vector<can::Duration>> delays_;  // to, from
  std::vector<std::size_t> driving_;
  can::Duration longest_{};
  can::Time changed_{};
  can::Time forgetting_ = can::never;  // of forget(): the next moment with something to do
};

}  // namespace canopus::sim
