#pragma once
// What a module reports to its CPU: the events of the event history, and the errors that module diagnostics show, each with
// its class and its detailed information [RJ71CN91 5.1, 5.2, 5.5, 5.6]. A module without the two tables reports nothing.
//
//   minor     the module goes on; cleared by the program, or by the engineering tool
//   moderate  a parameter is wrong; cleared by the program
//   major     hardware or memory failure; stays until the supply goes off

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/module/interface/event_records.hpp"

namespace canopus::module {

class ModuleObserver;

enum class ModuleEvent : std::uint8_t {
  canopen_start,
  layer2_base_start,
  layer2_extended_start,
  restarted,
  online,
  offline,
  errors_cleared,
  node_failures_cleared,
  emergencies_cleared,
  saved,
  restored,
  warning_level,
  error_passive,
  emergency_received,  ///< detail: node-ID
  emergency_sent,      ///< by the command interface
  error_control,       ///< detail: node-ID
  life_guarding,
  nmt_reset,
  nmt_state,      ///< detail: the state
  flying_master,  ///< detail: the active master's node-ID, 0: unknown
};
inline constexpr std::size_t module_events = static_cast<std::size_t>(ModuleEvent::flying_master) + 1;

struct EventRow {
  ModuleEvent event{};
  std::uint16_t code = 0;
  std::string_view overview{};
};

/// An error that module diagnostics show.
enum class Diagnosis : std::uint8_t {
  flash_worn,
  queue_overflow,
  rpdo_length,     ///< details: PDO number from 1 on, emergency code
  invalid_object,  ///< details: COB-ID, emergency code
  message_slot,    ///< detail: slot
  bus_off,
  save_while_online,
  slave_boot,           ///< details: node-ID, cause (letter of BootError)
  start_up,             ///< detail: cause
  slave_configuration,  ///< details: node-ID, cause
  extension_parameter,  ///< detail: parameter type
  invalid_value,        ///< detail: buffer memory address
  flash_data,
  hardware,
  watchdog,
};
inline constexpr std::size_t diagnoses = static_cast<std::size_t>(Diagnosis::watchdog) + 1;

struct DiagnosisRow {
  Diagnosis diagnosis{};
  std::uint16_t code = 0;
  ErrorClass error_class{};
  std::string_view overview{};
  std::array<std::string_view, 2> details{};  ///< names
};

struct DiagnosticsTables {
  std::span<const EventRow> events{};
  std::span<const DiagnosisRow> errors{};
};

class Diagnostics {
 public:
  /// The tables must outlive it.
  explicit Diagnostics(const DiagnosticsTables& tables);

  void set_observer(ModuleObserver* observer) noexcept { observer_ = observer; }

  void log(ModuleEvent event, can::Time now, std::optional<std::uint32_t> detail = {});
  /// The error is there from now on. One that is there already stays as it was found first.
  void raise(Diagnosis diagnosis, can::Time now, std::initializer_list<std::uint32_t> details = {});
  /// Its cause is gone.
  void end(Diagnosis diagnosis) {
    if (!errors_.empty()) remove(diagnosis);
  }
  /// While held, what comes is not noted and what is there goes, but for major errors [RJ71CN91 App. 1 YF].
  void hold_clear(bool held);
  /// The engineering tool's: minor errors go, unless there is a worse one. False: there is, and nothing was cleared
  /// [RJ71CN91 5.2].
  bool clear_minor();
  /// No errors; the history stays.
  void reset() noexcept { errors_.clear(); }

  /// The worst class of what is there.
  [[nodiscard]] std::optional<ErrorClass> worst() const noexcept;
  /// False: nothing is ever logged or raised.
  [[nodiscard]] bool reports() const noexcept { return has_tables() || !tables_.events.empty(); }
  [[nodiscard]] bool has_tables() const noexcept { return !tables_.errors.empty(); }
  [[nodiscard]] const std::vector<ModuleErrorRecord>& errors() const noexcept { return errors_; }
  /// The last 128, oldest first.
  [[nodiscard]] const std::deque<ModuleEventRecord>& history() const noexcept { return history_; }

 private:
  static constexpr std::size_t most_events = 128;

  void remove(Diagnosis diagnosis);

  DiagnosticsTables tables_;
  std::array<const EventRow*, module_events> event_{};
  std::array<const DiagnosisRow*, diagnoses> error_{};
  ModuleObserver* observer_ = nullptr;
  std::deque<ModuleEventRecord> history_;
  std::vector<ModuleErrorRecord> errors_;  // in the order they came
  bool hold_clear_ = false;
};

}  // namespace canopus::module
