#pragma once
// Errors of a running plant's modules cleared, and modules restarted, from the page: what a PLC program would do, in plant
// time. A Y that is ON for it goes OFF again whatever happens.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/link/loop_clock.hpp"
#include "canopus/module/interface/reset_procedure.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/json.hpp"

namespace canopus::web {

class WebModules final : private can::Ticker {
 public:
  using Json = text::Json;
  using Done = std::function<void(std::expected<Json, std::string>)>;
  /// How long a module may take to answer, of plant time: to an error clear, to a restart (or `restart_time` of the plant
  /// file, if that is longer, and `longest_clear`).
  static constexpr can::Duration longest_clear = std::chrono::seconds(1);
  static constexpr can::Duration longest_restart = std::chrono::seconds(10);

  /// Both must outlive this.
  WebModules(plant::Plant& plant, link::LoopClock& clock);
  WebModules(const WebModules&) = delete;
  WebModules& operator=(const WebModules&) = delete;

  /// {"number": 0}: the errors of that module in `state` are cleared. The row {"module", "said", "seconds"}, or why not, comes
  /// when it has ended, which is later in plant time. One of the two at a time for each module.
  void clear_errors(const text::Json& wish, Done done);
  /// The same: the module is restarted.
  void restart(const text::Json& wish, Done done);
  /// {"number": 0, "address": 10000, "value": 5}: that word of the module's buffer memory is written, as a PLC program writes it.
  /// The row {"module", "address", "name", "value"}, `value`: what it has then; or why not.
  [[nodiscard]] std::expected<Json, std::string> write_word(const text::Json& wish);
  /// The bus of the module that the wish names, if it is a real one; else empty.
  [[nodiscard]] std::string live_bus(const text::Json& wish) const;

 private:
  enum class Step : std::uint8_t {
    asked,     ///< the module is to answer
    released,  ///< Y is OFF, or the word was written: what there is now
    in_stop,   ///< whoever asked knows; with RUN the CPU takes Y as it was, and it has to go OFF
  };
  struct Job {
    std::size_t module = 0;
    plc::Rack* rack = nullptr;
    const module::ResetProcedure* procedure = nullptr;
    bool is_restart = false;
    Step step = Step::asked;
    can::Time began{};
    can::Time until{};      ///< of this step
    can::Duration took{};   ///< to the answer
    std::string trouble{};  ///< empty: none
    Done done{};
    std::expected<Json, std::string> result{};
    bool has_result = false;
    bool is_over = false;

    [[nodiscard]] const module::ResetRequest& request() const noexcept {
      return is_restart ? procedure->restart : procedure->clear_errors;
    }
  };

  // can::Ticker
  void tick(can::Time now) override;

  void begin(const text::Json& wish, bool is_restart, Done done);
  [[nodiscard]] std::expected<std::size_t, std::string> module_of(const text::Json& wish) const;
  [[nodiscard]] plc::Rack* rack_of(std::size_t module) const;
  [[nodiscard]] std::expected<Job, std::string> job_of(const text::Json& wish, bool is_restart);
  void step(Job& job, can::Time now);
  void step_signal(Job& job, can::Time now);
  void step_word(Job& job, can::Time now);
  void end(Job& job, can::Time now);
  void fail(Job& job, std::string why);
  [[nodiscard]] bool initializes(std::size_t module, can::Time now) const;
  [[nodiscard]] std::string still_wrong(const Job& job, can::Time now) const;

  plant::Plant& plant_;
  link::LoopClock& clock_;
  std::vector<Job> jobs_;  // few: one for each module at most
};

}  // namespace canopus::web
