#pragma once
// All runs of a campaign, or of a shard, on threads: a plant on each, in one process.

#include <chrono>
#include <cstdint>
#include <expected>
#include <functional>
#include <string>

#include "canopus/campaign/results.hpp"

namespace canopus::campaign {

struct Progress {
  std::uint64_t done = 0;    ///< of `all`, those of an earlier start included
  std::uint64_t all = 0;     ///< runs of this shard
  std::uint64_t failed = 0;  ///< of `done`
  std::uint64_t ran = 0;     ///< by this process
};

struct RunnerUse {
  std::size_t jobs = 1;
  Shard shard{};
  /// Asked between two runs, by one thread at a time. True: no further one begins.
  std::function<bool(const Progress&)> is_over{};
};

/// Runs what `results` does not have. The progress at the end; the error is a sentence: the results could not be written.
[[nodiscard]] std::expected<Progress, std::string> run_all(const Campaign& campaign, Results& results,
                                                           const RunnerUse& use);

}  // namespace canopus::campaign
