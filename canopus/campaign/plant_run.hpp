#pragma once
// One run of a campaign: a plant built anew, in virtual time, with rules acting on it and invariants looking at it.

#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "canopus/campaign/campaign.hpp"
#include "canopus/campaign/run_result.hpp"
#include "canopus/text/file_error.hpp"
#include "canopus/trace/decode/names.hpp"
#include "canopus/trace/file/trace_record.hpp"

namespace canopus::campaign {

/// What is run.
struct RunPlan {
  std::size_t variant = 0;
  std::uint64_t seed = 0;
  std::vector<ChosenRule> rules{};
  can::Duration duration{};
  std::vector<std::string> without_devices{};
};

/// What is kept of a run besides its result.
struct RunRecord {
  /// A frame of the run, or an error frame.
  struct Frame {
    std::string bus{};
    trace::TraceRecord record{};
  };
  static constexpr std::size_t most_frames = 500'000;

  std::vector<Frame> frames{};       ///< the first ones
  std::string events{};              ///< lines of `canopus run --json`
  std::vector<std::string> boots{};  ///< of slaves that are not booted at the end
  trace::Names names{};              ///< of the plant's nodes
};

/// The plan of a campaign for this seed.
[[nodiscard]] RunPlan plan_of(const Campaign& campaign, std::size_t variant, std::uint64_t seed);

/// The error, at the place of a rule or an invariant: no such plant can be built. `until`: the run ends with this failure, by its
/// fingerprint; empty: none.
[[nodiscard]] std::expected<RunResult, text::FileError> run(const Campaign& campaign, const RunPlan& plan,
                                                            const std::string& until = {},
                                                            RunRecord* record = nullptr);

/// The same; a plan of which no plant can be built is a failure of the invariant "plant file".
[[nodiscard]] RunResult run_or_fail(const Campaign& campaign, const RunPlan& plan);

}  // namespace canopus::campaign
