#pragma once
// The invariants of a campaign, checked while a plant runs.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/campaign/campaign_file.hpp"
#include "canopus/campaign/run_result.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/trace/decode/message.hpp"

namespace canopus::campaign {

/// One invariant in one run. What it finds it adds to the result.
class InvariantCheck {
 public:
  /// More failures of one invariant in one run are not reported.
  static constexpr std::size_t most_failures = 16;

  InvariantCheck(const Invariant& invariant, RunResult& result) : invariant_(invariant), result_(result) {}
  virtual ~InvariantCheck() = default;
  InvariantCheck(const InvariantCheck&) = delete;
  InvariantCheck& operator=(const InvariantCheck&) = delete;

  /// The plant is built, and still without supply. The error is a sentence: what the plant does not have.
  [[nodiscard]] virtual std::string attach(plant::Plant& /*plant*/) { return {}; }
  /// At each multiple of the sample interval. `nodes` are the plant's.
  virtual void sample(const std::vector<plant::NodeStatus>& /*nodes*/, can::Time /*now*/) {}
  virtual void receive(const trace::Message& /*message*/, std::string_view /*bus*/) {}
  virtual void on(const plant::Event& /*event*/) {}
  virtual void end(can::Time /*now*/) {}

  [[nodiscard]] const Invariant& invariant() const noexcept { return invariant_; }

 protected:
  [[nodiscard]] bool counts(can::Time now) const noexcept {
    return now.time_since_epoch() >= invariant_.after && failures_ < most_failures;
  }
  /// `traceback`: of an exception in Python.
  void fail(std::string node, std::string reason, std::string detail, can::Time now,
            std::string traceback = {});
  void reach();
  /// What the expectation makes of something that was seen.
  void seen(std::string node, std::string reason, std::string detail, can::Time now);

 private:
  const Invariant& invariant_;
  RunResult& result_;
  std::size_t failures_ = 0;
  bool is_reached_ = false;

 protected:
  [[nodiscard]] RunResult& result() noexcept { return result_; }
};

/// Paths in the invariant are relative to the campaign file.
[[nodiscard]] std::unique_ptr<InvariantCheck> make_check(const Invariant& invariant,
                                                         const std::string& campaign_path, RunResult& result);

}  // namespace canopus::campaign
