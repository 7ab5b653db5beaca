#pragma once
// What a run of a campaign showed, and its line in a file of results.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "canopus/campaign/chosen_rules.hpp"
#include "canopus/can/time.hpp"
#include "canopus/text/json.hpp"

namespace canopus::campaign {

/// Counts times in classes: each is a quarter of the time wider than its lowest one.
class TimeHistogram {
 public:
  void add(can::Duration time);
  void add(const TimeHistogram& other);
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] can::Duration longest() const noexcept { return longest_; }
  /// The end of the class in which `share` (0..1) of all are reached; 0 without any.
  [[nodiscard]] can::Duration quantile(double share) const;
  /// By the number of the class.
  [[nodiscard]] const std::map<unsigned, std::uint64_t>& classes() const noexcept { return classes_; }
  /// Where a class begins.
  [[nodiscard]] static can::Duration begin_of(unsigned number) noexcept;

  [[nodiscard]] text::Json to_json() const;
  /// False: the value is no histogram.
  bool read(const text::Json& value);

 private:
  std::map<unsigned, std::uint64_t> classes_;
  std::uint64_t count_ = 0;
  can::Duration longest_{};
};

/// An invariant that did not hold.
struct InvariantFailure {
  std::string invariant{};
  std::string node{};    ///< "line1 node 3 (encoder)", a word, an object ...; empty: of the whole plant
  std::string reason{};  ///< without times and numbers of this run
  std::string detail{};  ///< a sentence, for people
  can::Time at{};
  std::string traceback{};  ///< of an exception in Python: lines; not in the results

  /// What makes two failures the same: invariant, node and reason.
  [[nodiscard]] std::string fingerprint() const;
};

/// The reason without the numbers in it: "slave 3 lost" and "slave 4 lost" are "slave # lost".
[[nodiscard]] std::string without_numbers(std::string_view text);

struct RunResult {
  std::size_t variant = 0;
  std::uint64_t seed = 0;
  std::vector<InvariantFailure> failures{};          ///< in order of time
  std::vector<std::string> reached{};                ///< invariants expected "sometimes"
  std::optional<can::Duration> boot{};               ///< when all nodes were operational for the first time
  std::map<std::string, TimeHistogram> reactions{};  ///< by invariant
  std::uint64_t frames = 0;                          ///< on all buses
  std::uint64_t checksum = 0;                        ///< of these frames and their times
};

/// The line of a run in a file of results; docs/campaign.md has its fields.
[[nodiscard]] text::Json to_json(const CampaignFile& campaign, const RunResult& result,
                                 const std::vector<ChosenRule>& rules);

}  // namespace canopus::campaign
