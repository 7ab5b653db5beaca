#pragma once
// The events of a plant, as lines: JSON for programs (one object per line, docs/events.md), or plain text for
// people and pipes. Each line goes out whole.

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plant/slave_boot.hpp"
#include "canopus/sim/lift/lift_report.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/output.hpp"
#include "canopus/text/repeated_lines.hpp"

namespace canopus::plant {

/// The result and the figures of a run.
struct RunSummary {
  can::Time end{};       ///< how far the plant's time got
  can::Duration wall{};  ///< how long that took
  bool virtual_time = false;
  can::Duration largest_lag{};  ///< real time only: how late the plant was at worst
  struct BusCount {
    std::string_view name;
    can::BusLoad load;
  };
  std::vector<BusCount> buses{};
  std::vector<NodeStatus> nodes{};
  std::vector<SlaveBoot> boots{};
  std::vector<ModuleTrouble> troubles{};
  std::vector<ForcedObject> forced{};
  struct LiftCount {
    std::string_view bus;
    sim::lift::LiftReport report;
  };
  std::vector<LiftCount> lifts{};
};

/// In seconds. Microseconds are what a trace has; more digits would only be noise.
[[nodiscard]] double event_seconds(can::Time time);
/// The common beginning of every event.
[[nodiscard]] text::Json event_line(can::Time now, std::string_view kind);

/// Lines for programs.
class JsonPrinter final : public PlantObserver {
 public:
  explicit JsonPrinter(text::Output& out) : out_(out) {}
  void listening(std::string_view protocol, std::string_view of, std::string_view address);
  void summary(const RunSummary& summary);
  /// The line with the number of lines lost up to now. Thread-safe.
  [[nodiscard]] std::string lost_line(std::uint64_t lines) const;

  void on(const Event& event) override;

 private:
  void add(const BootUp& event, can::Time now);
  void add(const NmtStateChange& event, can::Time now);
  void add(const LssSetting& event, can::Time now);
  void add(const EmergencySent& event, can::Time now);
  void add(const MissingAck& event, can::Time now);
  void add(const BusErrorEvent& event, can::Time now);
  void add(const ControllerChange& event, can::Time now);
  void add(const SlaveBootStep& event, can::Time now);
  void add(const SignalChange& event, can::Time now);
  void add(const BufferChange& event, can::Time now);
  void add(const ObjectForced& event, can::Time now);
  void add(const ObjectReleased& event, can::Time now);
  void add(const LiftChange& change, can::Time now);
  void add(const LoadMeasured& event, can::Time now);
  void add(const Warning& event, can::Time now);
  void add(const ModuleEvent& event, can::Time now);
  void add(const ModuleError& event, can::Time now);
  void add(const Failure& event, can::Time now);
  void print(const text::Json& line, can::Time now);
  static void add_lifts(text::Json& summary, const std::vector<RunSummary::LiftCount>& lifts);
  text::Output& out_;
  std::atomic<can::Time> latest_{};
};

/// Lines for people: everything but the load and single bus errors. Lines that repeat quickly are counted.
class LinePrinter final : public PlantObserver {
 public:
  /// `quiet`: errors alone.
  LinePrinter(text::Output& out, text::Output& errors, bool quiet)
      : out_(out), errors_(errors), quiet_(quiet) {}
  void summary(const RunSummary& summary);
  /// The line with the number of lines lost up to now. Thread-safe.
  [[nodiscard]] std::string lost_line(std::uint64_t lines) const;

  void on(const Event& event) override;

 private:
  void add(const LoadMeasured&, can::Time) {}
  void add(const BusErrorEvent&, can::Time) {}
  void add(const ModuleEvent&, can::Time) {}
  void add(const BootUp& event, can::Time now);
  void add(const NmtStateChange& event, can::Time now);
  void add(const LssSetting& event, can::Time now);
  void add(const EmergencySent& event, can::Time now);
  void add(const MissingAck& event, can::Time now);
  void add(const ControllerChange& event, can::Time now);
  void add(const SlaveBootStep& event, can::Time now);
  void add(const SignalChange& event, can::Time now);
  void add(const BufferChange& event, can::Time now);
  void add(const ObjectForced& event, can::Time now);
  void add(const ObjectReleased& event, can::Time now);
  void add(const LiftChange& change, can::Time now);
  void add(const Warning& event, can::Time now);
  void add(const ModuleError& event, can::Time now);
  void add(const Failure& event, can::Time now);
  void line(can::Time now, std::string_view text);
  /// Lines of those that were counted, whose repetition has ended; can::never: of all.
  void print_counted(can::Time now);
  text::Output& out_;
  text::Output& errors_;
  bool quiet_;
  text::RepeatedLines repeated_;         // in out_
  text::RepeatedLines repeated_errors_;  // in errors_
  std::atomic<can::Time> latest_{};
};

/// "error 1806H (minor): An error occurred during NMT slave start-up; Node ID 5, ... cause 66"
[[nodiscard]] std::string describe(const module::ModuleErrorRecord& record);
/// "operational", "off", "layer 2 online"
[[nodiscard]] std::string_view state_name(const NodeStatus& node);
/// The same, but of a node that takes no part in its bus: "cut off from its bus", "bus-off".
[[nodiscard]] std::string_view condition_name(const NodeStatus& node);
/// Operational, or online in a Layer 2 mode, and takes part in its bus.
[[nodiscard]] bool in_operation(const NodeStatus& node);
/// "line1 node 3 (encoder)", "line1 unconfigured (encoder)"; without a node-ID "line1 (ME3CAN1-Q U0)"
[[nodiscard]] std::string describe(const NodeLabel& node);
/// "stuff error in data, bit 45, seen by node 3 (encoder), node 4 (drive), sending"
[[nodiscard]] std::string describe(const BusErrorEvent& error);
/// "line1 node 3 (encoder): error passive, TEC 128, REC 0"
[[nodiscard]] std::string describe_controller(const NodeLabel& node, const can::ControllerReport& report);
/// "line1 node 9: not booted: no answer to 1000H, ...": empty when it is booted.
[[nodiscard]] std::string describe_trouble(const SlaveBoot& boot, can::Time now);
[[nodiscard]] std::string describe_unacknowledged(const NodeLabel& node);
/// "line1 node 3 (encoder): LSS: node-ID 3, 125 kbit/s": what LSS has set.
[[nodiscard]] std::string describe_lss(const NodeLabel& node, std::uint32_t bit_rate);
/// "6000:01 (Digital inputs 1 to 8) forced to 3 until 5.2 s"
[[nodiscard]] std::string describe_value(const ForcedObject& forced);
/// "line1 node 2 (io-block): 6000:01 (Digital inputs 1 to 8) forced to 3 until 5.2 s"
[[nodiscard]] std::string describe(const ForcedObject& forced);
/// "hoist lift 1+2: 40 of 40 passengers arrived; ..."
[[nodiscard]] std::string describe(const RunSummary::LiftCount& lift);
/// The summary's lines.
[[nodiscard]] std::vector<std::string> describe(const RunSummary& summary);

// A slave's boot as fields of a JSON line, the same in `canopus run --json` and `canopus master --json`.

/// Adds to `line`: step (words), since (seconds), and as far as the step has them object ("1018:02"),
/// attempts, expected and received (of a comparison that failed), error (CiA 302 letter), abort ("05040000"),
/// reason (sentences: the fault, and what to check).
void add_boot(text::Json& line, const manager::BootRecord& record, can::Time now);

}  // namespace canopus::plant
