#pragma once
// A checked list of faults at work on one bus. Only the sources of the bus
// include this. Ports are pointers to compare here: what a port is, the plan
// does not know.

#include <cstdint>
#include <expected>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/sim/bus/faults/fault.hpp"

namespace canopus::sim {

class BusPort;

/// What happens to one frame on the wire.
struct FrameFaults {
  static constexpr std::size_t max_corruptions = 4;
  struct Corruption {
    unsigned bit = 0;
    const BusPort* at = nullptr;  // null: everywhere
  };
  bool drop_everywhere = false;
  const BusPort* drop_at = nullptr;
  std::size_t corruptions = 0;
  Corruption corruption[max_corruptions]{};
};

class FaultPlan {
 public:
  /// The bus that the faults are for.
  struct Target {
    std::string_view bus_name;
    can::Duration bit;                                     ///< at the bus's rate
    std::function<BusPort*(std::string_view)> port_named;  ///< the first of that name; null: none
  };
  /// Checks the faults against the bus. Error: which fault, what is wrong.
  static std::expected<FaultPlan, std::string> make(const std::vector<Fault>& faults, std::uint64_t seed,
                                                    const Target& target);

  /// There are rules about frames on the wire.
  [[nodiscard]] bool hits_frames() const noexcept { return !frames_.empty(); }
  [[nodiscard]] bool delays_frames() const noexcept { return !delays_.empty(); }
  /// `bit`: of the sender, at its rate.
  [[nodiscard]] FrameFaults on_frame(const BusPort& sender, can::Duration bit, const can::Frame& frame,
                                     can::Time now);
  /// How long the frame has to wait, usually 0.
  [[nodiscard]] can::Duration on_send(const BusPort& sender, const can::Frame& frame, can::Time now);

  /// A fault that a port has for some time.
  struct TimedFault {
    Fault fault;
    std::vector<BusPort*> ports;
    std::size_t number = 0;  // in the list of faults
    bool active = false;
    can::Time next_act = can::never;  // babble: of the next frame; noise: of its next edge
    bool is_inverting = false;        // noise
    std::mt19937_64 random{};         // noise
    [[nodiscard]] can::Time next() const noexcept;
    /// Noise: good bits before the next bad one.
    [[nodiscard]] std::uint64_t bits_to_next_hit();
  };
  [[nodiscard]] std::vector<TimedFault>& timed_faults() noexcept { return timed_faults_; }
  /// When a fault begins, ends or babbles next.
  [[nodiscard]] can::Time next() const noexcept { return timed_faults_.empty() ? can::never : next_change(); }
  [[nodiscard]] std::vector<FaultState> states() const;
  /// The rules of this fault hit no frame from now on. False: it has none.
  bool end_rules(std::size_t number, can::Time now) noexcept;
  /// Of which the times are multiples that the faults have of their own; 0:
  /// they have none.
  [[nodiscard]] can::Duration time_grid() const noexcept { return time_grid_; }
  [[nodiscard]] BitDriver& driver() noexcept { return driver_; }
  [[nodiscard]] const BitDriver& driver() const noexcept { return driver_; }

 private:
  [[nodiscard]] can::Time next_change() const noexcept;
  struct Rule {
    Fault fault;
    std::size_t number = 0;  // in the list of faults
    const BusPort* sender = nullptr;
    const BusPort* receiver = nullptr;
    std::uint64_t seen = 0;
    std::uint64_t hit = 0;
  };
  void add(TimedFault fault);
  void drive(Rule& rule, const BusPort& sender, can::Duration bit, const can::Frame& frame, can::Time now);
  [[nodiscard]] bool hits(Rule& rule, const BusPort& sender, const can::Frame& frame, can::Time now);

  std::vector<Rule> frames_;
  std::vector<Rule> delays_;
  std::vector<TimedFault> timed_faults_;
  BitDriver driver_;
  std::size_t count_ = 0;  // of faults
  can::Duration time_grid_{};
  std::mt19937_64 random_;
};

}  // namespace canopus::sim
