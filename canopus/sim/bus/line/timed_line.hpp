#pragma once
// A line with CAN controllers whose clocks, bit timing and places differ: the controllers of the simulated bus, each
// with a BitClock of its own, and a wire on which levels need time. For questions of bit timing; Bus knows nothing of
// it.
//
// A level travels at one speed, is not weakened and not reflected: what a node drives is seen by another after its
// driver's delay, the way along stubs and line, and the other's receiver's delay.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <ratio>
#include <vector>

#include "canopus/can/fault_confinement.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/sim/bus/controller/bit_controller.hpp"
#include "canopus/sim/bus/controller/bit_timing.hpp"

namespace canopus::sim {

class TimedLine {
 public:
  /// A clock's ppm of a quantum would be lost in nanoseconds. Ends after 2.5 hours.
  using Time = std::chrono::duration<std::int64_t, std::femto>;

  struct Node {
    BitTiming timing{};                          ///< without problem()
    double clock_ppm = 0;                        ///< positive: fast; above -1,000,000
    double metres = 0;                           ///< place on the line
    double stub_metres = 0;                      ///< from the line to the node, 0 or more
    std::chrono::nanoseconds driver_delay{0};    ///< of the transceiver, 0 or more
    std::chrono::nanoseconds receiver_delay{0};  ///< likewise
    std::chrono::nanoseconds start{0};           ///< of its first quantum, 0 or more
  };

  /// `bit_rate`: bit/s of every node, above 0. `nanoseconds_per_metre`: about 5 for copper with polyethylene.
  explicit TimedLine(std::uint32_t bit_rate, double nanoseconds_per_metre = 5) noexcept
      : bit_rate_(bit_rate), nanoseconds_per_metre_(nanoseconds_per_metre) {}

  /// Returns its number, from 0. Before the first run().
  std::size_t add(const Node& node);
  /// The node sends it when it can, after those queued before, and again until it is acknowledged.
  void send(std::size_t node, const can::Frame& frame) { stations_[node]->pending.push_back(frame); }
  void run(std::chrono::nanoseconds duration);

  [[nodiscard]] const std::vector<can::Frame>& received(std::size_t node) const {
    return stations_[node]->received;
  }
  /// Frames the node has sent and got acknowledged.
  [[nodiscard]] unsigned transmitted(std::size_t node) const { return stations_[node]->transmitted; }
  /// Errors the node has found, of this kind.
  [[nodiscard]] unsigned errors(std::size_t node, can::BusError error) const {
    return stations_[node]->errors[static_cast<unsigned>(error)];
  }
  /// Errors all nodes have found.
  [[nodiscard]] unsigned errors() const noexcept;
  [[nodiscard]] const can::FaultConfinement& faults(std::size_t node) const {
    return stations_[node]->faults;
  }

 private:
  struct Change {
    Time time;
    bool dominant = false;
  };
  struct Station {
    explicit Station(const Node& setting) : node(setting), clock(setting.timing) {}
    Node node;
    BitClock clock;
    can::FaultConfinement faults;
    BitController controller{faults};
    Time quantum{0};
    Time next{0};               // quantum
    std::deque<Change> driven;  // as long as some node may still see it
    bool driving = false;
    std::vector<Time> delay;  // from each node to this one
    std::deque<can::Frame> pending;
    std::vector<can::Frame> received;
    unsigned transmitted = 0;
    unsigned errors[6] = {};
  };

  void measure();
  void begin_bit(Station& station);
  void drive(Station& station);
  void begin_quantum(Station& station);
  void sample(Station& station, bool dominant);
  [[nodiscard]] bool dominant_at(const Station& station) const;

  std::uint32_t bit_rate_;
  double nanoseconds_per_metre_;
  Time now_{0};
  Time longest_{0};  // delay
  std::vector<std::unique_ptr<Station>> stations_;
};

}  // namespace canopus::sim
