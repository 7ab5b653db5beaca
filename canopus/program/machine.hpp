#pragma once
// A CPU's run of a program: its memory, scan by scan, and access to its variables by name.

#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/program/execution.hpp"
#include "canopus/program/linked_code.hpp"
#include "canopus/program/program.hpp"

namespace canopus::program {

class Machine {
 public:
  /// In the state of a cold start.
  explicit Machine(std::shared_ptr<const Program> program);

  /// All variables get their initial values; forced ones stay forced.
  void cold_start();
  /// All but the retained ones [IEC 61131-3 6.5.6]: after a power cut.
  void warm_start();

  /// One scan: every program once, in order. `now` in ns is what timers measure. A fault ends the scan where it is.
  [[nodiscard]] std::optional<Fault> scan(std::int64_t now, DeviceImage* devices);
  /// These programs, by their numbers in Program::functions, in this order; at a break it is_halted().
  [[nodiscard]] std::optional<Fault> run(std::span<const std::uint32_t> programs, std::int64_t now,
                                         DeviceImage* devices);
  /// The rest of what a break has halted, up to the next one. Of a machine that is not halted: nothing.
  [[nodiscard]] std::optional<Fault> resume(std::int64_t now, DeviceImage* devices);
  /// Instructions of the last scan(), run() or resume(), as loops and calls count them.
  [[nodiscard]] std::int64_t executed() const noexcept { return executed_; }

  /// A break before the first instruction of that line, or of the next one that has some: its line, in every function with it.
  /// `file`: as in Program::files. The error names what was expected.
  [[nodiscard]] std::expected<std::uint32_t, std::string> set_break(std::string_view file,
                                                                    std::uint32_t line);
  /// False: there is none.
  bool clear_break(std::string_view file, std::uint32_t line);
  void clear_breaks();
  struct Break {
    std::uint16_t file = 0;
    std::uint32_t line = 0;
    bool operator==(const Break&) const = default;
  };
  [[nodiscard]] const std::vector<Break>& breaks() const noexcept { return breaks_; }
  /// A break has halted the run: what is executed next stands there.
  [[nodiscard]] bool is_halted() const noexcept { return suspension_.is_set; }
  [[nodiscard]] SourcePosition halted_at() const noexcept;
  /// Instructions that a scan may execute, as loops and calls count them.
  void set_watchdog(std::int64_t instructions) noexcept { watchdog_ = instructions; }

  /// Online change: another program takes over. Variables with the same path keep their values where their types are the same; in
  /// arrays and structures element by element. Forces on variables that are no more are released.
  void change(std::shared_ptr<const Program> program);

  struct Variable {
    const DataType* type = nullptr;
    std::uint32_t place = 0;
    bool is_constant = false;
  };
  /// "counter", "MAIN.timer1.ET", "MAIN.list[3].x", whatever the case of letters. The error names what was expected.
  [[nodiscard]] std::expected<Variable, std::string> find(std::string_view path) const;
  [[nodiscard]] std::expected<std::string, std::string> read(std::string_view path) const;
  /// The error is a sentence; nothing is changed then.
  [[nodiscard]] std::expected<void, std::string> write(std::string_view path, std::string_view value);
  /// The variable has this value before and after every scan, until release().
  [[nodiscard]] std::expected<void, std::string> force(std::string_view path, std::string_view value);
  [[nodiscard]] std::expected<void, std::string> release(std::string_view path);
  void release_all() noexcept { forces_.clear(); }
  [[nodiscard]] bool is_forced(std::string_view path) const;
  [[nodiscard]] std::size_t forced() const noexcept { return forces_.size(); }
  /// The names of what is forced, as they were written.
  [[nodiscard]] std::vector<std::string> forced_names() const;

  [[nodiscard]] const Program& program() const noexcept { return *program_; }
  /// A single variable gets a value as the memory holds it; false: these are none of its type, and nothing is changed.
  bool write_slots(const Variable& variable, std::span<const Slot> value);
  /// The value at a place of the memory (variables.hpp).
  [[nodiscard]] const Slot* value_at(std::uint32_t place) const noexcept { return memory_.data() + place; }
  /// The values that a power cut leaves, as rows of bytes that restore_retained() of the same program accepts.
  [[nodiscard]] std::vector<Slot> retained() const;
  /// False: they are another program's; nothing is changed then.
  bool restore_retained(const std::vector<Slot>& values);

 private:
  struct Force {
    std::string path;
    std::uint32_t place = 0;
    std::vector<Slot> value;
  };

  /// Calls each(place, slots) for every retained variable.
  template <typename Each>
  void each_retained(Each each) const;
  void apply_forces() noexcept;
  std::optional<Fault> run_pending(std::int64_t now, DeviceImage* devices);
  void place_breaks();

  std::shared_ptr<const Program> program_;
  std::vector<Slot> memory_;
  std::vector<Force> forces_;
  std::int64_t watchdog_ = 100'000'000;
  std::int64_t executed_ = 0;
  std::vector<Break> breaks_;
  std::vector<Instruction> code_with_breaks_;  // empty: there are none
  LinkedCode linked_;
  std::vector<std::uint32_t> pending_;  // programs of this run; the first one that is not complete is halted
  std::size_t next_pending_ = 0;
  Suspension suspension_;
};

}  // namespace canopus::program
