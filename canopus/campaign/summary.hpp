#pragma once
// What the results of a campaign amount to, whatever number of shards they come from.

#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "canopus/campaign/results.hpp"
#include "canopus/campaign/run_result.hpp"

namespace canopus::campaign {

/// More kinds of failures are counted, and not kept.
inline constexpr std::size_t most_kinds = 1000;

/// Failures of a variant with one fingerprint.
struct FailureKind {
  std::string fingerprint{};
  std::uint64_t runs = 0;
  std::string variant{};   ///< of the first run that shows it
  std::uint64_t seed = 0;  ///< of the same
  InvariantFailure first{};
  std::vector<std::string> rules{};  ///< that this run had
};

struct Share {
  std::uint64_t runs = 0;
  std::uint64_t failed = 0;
};

struct Summary {
  ResultsHead head{};  ///< of the whole campaign
  std::uint64_t runs = 0;
  std::uint64_t failed = 0;                    ///< canaries are not counted
  std::vector<FailureKind> kinds{};            ///< in the order of their first runs
  std::uint64_t runs_of_other_kinds = 0;       ///< failures that came after `most_kinds` others
  std::map<std::string, Share> variants{};     ///< by name
  std::map<std::string, Share> rules{};        ///< by name: runs that had the rule
  std::vector<std::string> missed_canaries{};  ///< whose run did not fail, of those that ran
  std::vector<std::string> holes{};            ///< expected "sometimes", reached by no run
  TimeHistogram boots{};
  std::map<std::string, TimeHistogram> reactions{};
  std::vector<std::string> missing{};  ///< "shard 3/16: 62 runs"

  /// Judged when all runs are there alone: canaries and holes.
  [[nodiscard]] bool is_good() const {
    return kinds.empty() && missing.empty() && missed_canaries.empty() && holes.empty();
  }
};

/// Of the folders of all shards, whose runs are read one after the other: a campaign of any size takes the same memory. `each_line`
/// gets every run's line, in order. `variant`: only its runs count; empty: all. The error is a sentence: they are not of one campaign,
/// have no such variant, or cannot be read.
using EachLine = std::function<void(std::string_view line)>;
[[nodiscard]] std::expected<Summary, std::string> summarize(
    const std::vector<StoredResults>& shards, const std::string& variant = {},
    const EachLine& each_line = [](std::string_view) {});

/// The same, and writes the lines of all shards as one file, results.jsonl in the folder.
[[nodiscard]] std::expected<Summary, std::string> merge_results(const std::vector<StoredResults>& shards,
                                                                const std::string& folder);

/// "12 failures of more than 1000 kinds"
[[nodiscard]] std::string other_kinds_text(const Summary& summary);

/// Sentences for people, most important first.
[[nodiscard]] std::vector<std::string> describe(const Summary& summary);

}  // namespace canopus::campaign
