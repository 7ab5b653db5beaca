#pragma once
// When the programs of a CPU are executed: the execution types of GX Works3. What a scan executes, in its order.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/program/device_image.hpp"
#include "canopus/program/program.hpp"

namespace canopus::plc {

enum class TaskKind : std::uint8_t {
  scan,
  initial,     ///< in the first scan after RUN, instead of those of the kind scan
  fixed_scan,  ///< every so often, from RUN on
  event,  ///< when a bit device goes ON, before the other programs of the scan that finds it; of an interrupt maybe OFF
  standby  ///< not at all
};
inline constexpr std::size_t task_kind_count = 5;
/// "fixed scan"
[[nodiscard]] std::string_view name(TaskKind kind) noexcept;

struct ProgramTask {
  std::string name{};
  TaskKind kind = TaskKind::scan;
  std::vector<std::string> programs{};  ///< PROGRAMs, in their order
  can::Duration every{};                ///< of a fixed scan
  std::string on{};                     ///< of an event: "X10"
  program::DevicePoint on_point{};      ///< the same
  unsigned priority =
      0;  ///< of what is due at the same time the lowest number is first; then the order of the tasks
};

class ProgramTasks {
 public:
  /// Programs that no task names belong to the scan. All names must be those of PROGRAMs. The program's interrupts are tasks before
  /// all others.
  ProgramTasks(std::vector<ProgramTask> tasks, const program::Program& program);

  /// RUN begins, or the supply has come.
  void start(can::Time now);
  /// The programs of the scan that begins: events, then those of the first scan or of every scan. Valid until the next call.
  [[nodiscard]] std::span<const std::uint32_t> scan_begins(program::DeviceImage& devices);
  /// When the next fixed scan is due; never: there is none.
  [[nodiscard]] can::Time next_fixed_scan() const noexcept;
  /// Those that are due now. Valid until the next call.
  [[nodiscard]] std::span<const std::uint32_t> fixed_scan(can::Time now);
  /// The programs may have other numbers: those of a program that has replaced the other one. A timer interrupt that is new begins
  /// with the next RUN.
  void change(const program::Program& program);

  struct Row {
    const ProgramTask& task;
    std::uint64_t runs;
  };
  [[nodiscard]] std::vector<Row> rows() const;

 private:
  struct Entry {
    ProgramTask task;
    std::vector<std::uint32_t> programs{};  // numbers in Program::functions
    can::Time due = can::never;
    bool was_on = false;
    bool is_interrupt = false;
    bool is_falling = false;  // an edge that is one
    std::uint64_t runs = 0;
    bool is_of_others = false;  // of no task of the file: the programs that none of those names
  };
  void add_due(Entry& entry);
  void change_interrupts(const program::Program& program);

  std::vector<Entry> entries_;  // by priority
  std::vector<std::uint32_t> due_;
  bool is_first_scan_ = true;
};

}  // namespace canopus::plc
