#pragma once
// Runs a compiled program in a rack's CPU: while the CPU is in RUN its tasks are executed, those of the scan after X and Y have been
// refreshed. A program takes no plant time itself: the length of a scan is the rack's.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/module/interface/non_volatile_memory.hpp"
#include "canopus/plc/execution/cpu_devices.hpp"
#include "canopus/plc/execution/device_label.hpp"
#include "canopus/plc/execution/instruction_time.hpp"
#include "canopus/plc/execution/program_tasks.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/program/machine.hpp"

namespace canopus::plc {

/// A file of a program, as it was compiled.
struct ProgramSource {
  std::string name;  ///< as in Program::files
  std::string text;
};

struct ProgramParts {
  std::shared_ptr<const program::Program> program{};
  std::vector<ProgramSource> sources{};
  std::vector<DeviceLabel> labels{};
  std::vector<ProgramTask> tasks{};  ///< none: all programs in the scan
  /// Longest execution of a scan's programs, by the family's instruction times; none: the family's.
  std::optional<can::Duration> watchdog{};
  /// Where RETAIN variables are kept beyond the run; null: nowhere. It must outlive the execution.
  module::NonVolatileMemory* memory = nullptr;
};

/// How long the programs of a scan take, by the family's instruction times.
struct ScanTimes {
  can::Duration now{};
  can::Duration least{};
  can::Duration most{};
};

class ProgramExecution final : private RackListener, private can::Ticker {
 public:
  static constexpr std::string_view retained_name = "retain";  ///< in the memory
  /// "main.st:12:5: division by zero": the CPU has stopped.
  using FaultReport = std::function<void(const std::string& text, can::Time now)>;

  /// The rack must have a scan of its own, and outlive this; so must the timeline, which is the rack's.
  ProgramExecution(can::Timeline& timeline, Rack& rack, ProgramParts parts, FaultReport report);
  ~ProgramExecution() = default;
  ProgramExecution(const ProgramExecution&) = delete;
  ProgramExecution& operator=(const ProgramExecution&) = delete;

  /// The program's variables.
  [[nodiscard]] program::Machine& machine() noexcept { return machine_; }
  [[nodiscard]] const program::Machine& machine() const noexcept { return machine_; }
  [[nodiscard]] const std::vector<ProgramSource>& sources() const noexcept { return sources_; }
  /// Global labels that stand for devices.
  [[nodiscard]] const std::vector<DeviceLabel>& labels() const noexcept { return labels_; }
  /// Whatever the case of letters; null: there is none.
  [[nodiscard]] const DeviceLabel* label(std::string_view name) const noexcept;
  [[nodiscard]] const ProgramTasks& tasks() const noexcept { return tasks_; }
  [[nodiscard]] const ScanTimes& scan_times() const noexcept { return scan_times_; }

  /// No program is executed any more, while plant time goes on and Y stay: until resume() or single_scan().
  void halt() noexcept { mode_ = Mode::halted; }
  /// The next scan, or the rest of one that a break has halted, is executed, and no other.
  void single_scan() noexcept { mode_ = Mode::single_scan; }
  void resume() noexcept { mode_ = Mode::free; }
  /// By halt(), after a single scan, or at a break.
  [[nodiscard]] bool is_halted() const noexcept { return mode_ == Mode::halted; }

  /// Why the program stopped the CPU, until it is in RUN again.
  struct Error {
    program::SourcePosition position{};
    std::string text{};  ///< "main.st:12:5: division by zero"
    std::uint16_t code = 0;
    can::Time time{};
  };
  [[nodiscard]] const std::optional<Error>& error() const noexcept { return error_; }

  /// Online change: variables keep their values. Tasks whose PROGRAM is no more execute the others.
  void change(std::shared_ptr<const program::Program> program, std::vector<ProgramSource> sources,
              std::vector<DeviceLabel> labels = {});

  /// Keeps what RETAIN variables hold now, if the supply has ever been on. To be called before the end of the run.
  void save_retained();
  /// RETAIN variables of the memory that the program has no more, or with another type: they have their initial values.
  [[nodiscard]] const std::vector<std::string>& not_restored() const noexcept { return not_restored_; }

 private:
  enum class Mode : std::uint8_t { free, halted, single_scan };

  void supply_changed(bool on, can::Time now) override;
  void cpu_changed(module::CpuState state, can::Time now) override;
  void scan_begins(can::Time now) override;
  void tick(can::Time now) override;  // a fixed scan

  [[nodiscard]] bool is_running() const noexcept;
  void start(can::Time now);
  void set_watchdog();
  void ended(const std::optional<program::Fault>& fault, can::Time now);

  /// Whatever the watchdog timer says: an endless loop must not stop the plant.
  static constexpr std::int64_t most_instructions = 100'000'000;

  Rack& rack_;
  program::Machine machine_;
  std::vector<ProgramSource> sources_;
  std::vector<DeviceLabel> labels_;
  ProgramTasks tasks_;
  CpuDevices devices_;
  FaultReport report_;
  std::optional<can::Duration> watchdog_;
  module::NonVolatileMemory* memory_;
  std::vector<std::uint8_t> saved_;
  can::Time saved_at_{};
  std::vector<std::string> not_restored_;
  ScanTimes scan_times_;
  std::optional<Error> error_;
  Mode mode_ = Mode::free;
  bool was_on_ = false;  // before: what is retained has values
  can::Time last_run_ = can::never;
};

}  // namespace canopus::plc
