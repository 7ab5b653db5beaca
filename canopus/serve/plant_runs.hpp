#pragma once
// Runs of a given time or number of scans that clients wait for, in plant time. In real time the plant runs
// by itself, and the runs are concurrent. In a plant that is driven in step (run --step) its time moves only
// during a run, one run after the other.

#include <cstdint>
#include <expected>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/can/timeline.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plc/melsec/target.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::serve {

/// A condition on what a PLC holds: "X1", "D100 >= 5", "U0\G601 == 5".
class PlcCondition {
 public:
  /// An address as `canopus plc` takes it, one of == != < <= > >=, and a constant; a bit alone means == 1. A
  /// constant with a minus sign compares the word as -32768 to 32767. The error names what was expected; the
  /// rack must have the address.
  [[nodiscard]] static std::expected<PlcCondition, std::string> parse(std::string_view text,
                                                                      const plc::Rack& rack);

  /// Evaluates the values that a program would read at this moment; false when there is no supply.
  [[nodiscard]] bool holds(plc::Rack& rack, can::Time now) const;

 private:
  enum class Comparison : std::uint8_t { equal, not_equal, less_or_equal, greater_or_equal, less, greater };

  plc::melsec::Target target_;
  bool is_bit_ = false;
  bool is_signed_ = false;
  Comparison comparison_ = Comparison::equal;
  std::int32_t constant_ = 1;
};

class PlantRuns final : private can::Ticker {
 public:
  enum class Order : std::uint8_t {
    side_by_side,  ///< all of them begin at once
    in_turn,       ///< each begins when the one before it is over
  };
  /// Ends with the first of them that comes. Without any: never.
  struct Goal {
    std::optional<std::size_t> plc{};      ///< PLC of the scans and devices; none: the plant has no PLC
    std::optional<std::uint64_t> scans{};  ///< the number of scans to run
    std::optional<can::Duration> duration{};
    std::optional<PlcCondition> until{};  ///< evaluated when it begins and at the end of each scan
  };
  struct Outcome {
    std::uint64_t scans = 0;   ///< that have ended meanwhile
    bool is_met = false;       ///< `until` holds
    bool plant_ended = false;  ///< the run of the plant ended before
  };
  using Done = std::function<void(const Outcome&)>;
  using Number = std::uint64_t;

  /// `over` is called when report() has something to report, also inside the timeline. The plant must outlive
  /// this.
  PlantRuns(plant::Plant& plant, Order order, std::function<void()> over);
  PlantRuns(const PlantRuns&) = delete;
  PlantRuns& operator=(const PlantRuns&) = delete;

  /// Begins at the plant's present moment, or in its turn. `done` comes by report(), or never after cancel().
  Number start(Goal goal, Done done);
  /// The client that waited has disconnected.
  void cancel(Number number);

  /// A run is waiting for plant time to pass.
  [[nodiscard]] bool wants_time() const noexcept;
  /// How far the plant may run before a run may be over.
  [[nodiscard]] can::Time next() const noexcept { return deadline(); }
  /// Calls `done` of the finished runs, and begins the next ones. Must not be called inside the timeline.
  void report();
  /// The run of the plant ends, and with it all waiting runs. Call report() next.
  void end_all();

 private:
  struct Run {
    Number number = 0;
    Goal goal{};
    Done done{};
    bool has_begun = false;
    bool is_over = false;
    std::uint64_t scans_before = 0;
    can::Time end = can::never;
    can::Alarm due{};
    Outcome outcome{};
  };

  // can::Ticker
  void tick(can::Time now) override;

  void begin_next();
  void begin(Run& run, can::Time now);
  void evaluate(Run& run, can::Time now);
  void finish(Run& run, can::Time now);
  [[nodiscard]] plc::Rack* rack(const Run& run) const;

  plant::Plant& plant_;
  Order order_;
  std::function<void()> over_;
  std::list<Run> runs_;
  Number last_number_ = 0;
};

}  // namespace canopus::serve
