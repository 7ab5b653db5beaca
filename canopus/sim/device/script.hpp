#pragma once
// Forces values of a device as a person would: at a moment, or whenever a condition becomes true, a step
// forces an object, for a while or until it is released. A script is deterministic: its moments are exact,
// and its conditions are evaluated after each event of the device.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "canopus/can/alarm.hpp"
#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"

namespace canopus::sim {

enum class Comparison : std::uint8_t { equal, not_equal, less, less_or_equal, greater, greater_or_equal };

/// "==", "!=", "<", "<=", ">", ">="
[[nodiscard]] std::string_view name(Comparison comparison) noexcept;

/// A number of a device compared with a constant.
struct Condition {
  canopen::Entry entry{};
  Comparison comparison = Comparison::equal;
  std::uint64_t value = 0;  ///< bit pattern, as wide as the entry

  [[nodiscard]] bool holds(const canopen::ObjectDictionary& dictionary) const noexcept;
};

struct ScriptStep {
  can::Time at = can::never;        ///< once, then
  std::optional<Condition> when{};  ///< or each time this becomes true
  enum class Action : std::uint8_t { force, release, release_all };
  Action action = Action::force;
  canopen::Entry entry{};               ///< of force and release
  std::uint64_t value = 0;              ///< of force: bit pattern, as wide as the entry
  std::optional<can::Duration> hold{};  ///< of force: released so long afterwards
};

/// The steps of one device, and which of them are due.
class Script {
 public:
  void add(const ScriptStep& step);
  [[nodiscard]] bool empty() const noexcept { return states_.empty(); }

  /// Steps with a moment that has come, in the order of their moments and of add().
  [[nodiscard]] const ScriptStep* next_due(can::Time now);
  /// When a step is due.
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

  /// Resets all conditions: one that holds already becomes true at the next evaluation.
  void restart() noexcept;
  /// Begins an evaluation: it returns each step at most once.
  void begin_evaluation() noexcept;
  /// The next step of this evaluation whose condition was false the last time and holds now; nullptr: there
  /// is none, the evaluation is over. The effect of a step may make further conditions true.
  [[nodiscard]] const ScriptStep* next_true(const canopen::ObjectDictionary& dictionary);

 private:
  struct State {
    ScriptStep step;
    bool held = false;      // at the last evaluation
    bool returned = false;  // in this evaluation
  };
  void set_alarm() noexcept {
    alarm_ = next_timed_ == timed_.size() ? can::never : states_[timed_[next_timed_]].step.at;
  }

  std::vector<State> states_;
  std::vector<std::size_t> timed_;        // steps with a moment, in its order
  std::vector<std::size_t> conditional_;  // steps with a condition
  std::size_t next_timed_ = 0;
  can::Alarm alarm_;
};

}  // namespace canopus::sim
