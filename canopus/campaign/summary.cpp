#include "canopus/campaign/summary.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/text/json_fields.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::campaign {
namespace {

can::Duration duration_of(const text::Json& seconds) {
  const double value = seconds.is_number() ? std::clamp(seconds.get<double>(), 0.0, 1e6) : 0;
  return std::chrono::microseconds(static_cast<std::int64_t>(value * 1e6 + 0.5));
}

class Summing {
 public:
  explicit Summing(const ResultsHead& head) { summary_.head = head; }

  void add(const text::Json& run) {
    ++summary_.runs;
    if (const std::string canary = run.value("canary", ""); !canary.empty()) {
      const bool is_known = std::ranges::count(summary_.head.canaries, canary) != 0;
      if (is_known && run.value("outcome", "") != "failed") summary_.missed_canaries.push_back(canary);
      return;
    }
    const bool has_failed = run.value("outcome", "") == "failed";
    if (has_failed) ++summary_.failed;
    const auto count = [&](Share& share) {
      ++share.runs;
      if (has_failed) ++share.failed;
    };
    count(share_of(summary_.variants, run.value("variant", ""), most_variants));
    std::vector<std::string> rules;
    for (const text::Json& rule : field_list(run, "rules")) {
      rules.push_back(rule.value("name", ""));
      count(share_of(summary_.rules, rules.back(), most_rules));
    }
    for (const text::Json& name : field_list(run, "reached")) {
      if (name.is_string() && std::ranges::count(summary_.head.sometimes, name.string()) != 0)
        reached_.insert(name.string());
    }
    if (const auto boot = run.find("boot"); boot != run.end() && boot->is_number())
      summary_.boots.add(duration_of(*boot));
    if (const auto reactions = run.find("reactions"); reactions != run.end()) {
      for (const text::JsonMember& member : reactions->items()) {
        if (summary_.reactions.size() >= most_invariants && !summary_.reactions.contains(member.key))
          continue;
        (void)summary_.reactions[member.key].read(member.value);
      }
    }
    add_failures(run, rules);
  }

  Summary finish(bool is_complete) {
    std::ranges::sort(summary_.missed_canaries);
    const auto twice = std::ranges::unique(summary_.missed_canaries);
    summary_.missed_canaries.erase(twice.begin(), twice.end());
    if (is_complete) {
      for (const std::string& name : summary_.head.sometimes) {
        if (!reached_.contains(name)) summary_.holes.push_back(name);
      }
    }
    return std::move(summary_);
  }
  Summary& summary() noexcept { return summary_; }

 private:
  /// Names come from files: no more of them than a campaign may have.
  Share& share_of(std::map<std::string, Share>& shares, const std::string& name, std::size_t most) {
    return shares.size() < most || shares.contains(name) ? shares[name] : unknown_;
  }
  void add_failures(const text::Json& run, const std::vector<std::string>& rules) {
    std::set<std::string> seen;
    for (const text::Json& shown : field_list(run, "failures")) {
      InvariantFailure failure{.invariant = shown.value("invariant", ""),
                               .node = shown.value("node", ""),
                               .reason = shown.value("reason", ""),
                               .detail = shown.value("detail", "")};
      if (const auto at = shown.find("t"); at != shown.end()) failure.at = can::Time{} + duration_of(*at);
      std::string fingerprint = failure.fingerprint();
      if (!seen.insert(fingerprint).second) continue;
      const std::pair kind(run.value("variant", ""), fingerprint);
      const auto known = numbers_.find(kind);
      if (known != numbers_.end()) {
        ++summary_.kinds[known->second].runs;
        continue;
      }
      if (summary_.kinds.size() == most_kinds) {
        ++summary_.runs_of_other_kinds;
        continue;
      }
      numbers_.emplace(kind, summary_.kinds.size());
      const auto seed = run.find("seed");  // of two members the last, which need be no number
      const bool has_seed = seed != run.end() && seed->is_number_unsigned();
      summary_.kinds.push_back({.fingerprint = std::move(fingerprint),
                                .runs = 1,
                                .variant = run.value("variant", ""),
                                .seed = has_seed ? seed->get<std::uint64_t>() : 0,
                                .first = std::move(failure),
                                .rules = rules});
    }
  }

  Summary summary_;
  Share unknown_;
  std::set<std::string> reached_;
  std::map<std::pair<std::string, std::string>, std::size_t> numbers_;  // of kinds, by variant
};

/// The runs that are not there, by shard. `found`: how many of each are.
std::vector<std::string> missing_runs(const ResultsHead& head, const std::vector<std::uint64_t>& found) {
  const std::uint64_t shards = found.size();
  std::vector<std::string> sentences;
  for (std::uint64_t shard = 0; shard < shards; ++shard) {
    const std::uint64_t expected = head.runs() / shards + (shard < head.runs() % shards ? 1 : 0);
    if (found[shard] >= expected) continue;
    const std::string count = ascii::counted(expected - found[shard], "run");
    sentences.push_back(shards == 1 ? count : fmt::format("shard {}/{}: {}", shard + 1, shards, count));
  }
  return sentences;
}

std::uint64_t runs_of(const Summary& summary, const std::string& variant) {
  const auto share = summary.variants.find(variant);
  return share == summary.variants.end() ? summary.runs : share->second.runs;
}

std::string share_text(std::uint64_t part, std::uint64_t whole) {
  return fmt::format("{} of {}", part, ascii::counted(whole, "run"));
}

}  // namespace

std::string other_kinds_text(const Summary& summary) {
  return fmt::format("{} of more than {} kinds, which are not named",
                     ascii::counted(summary.runs_of_other_kinds, "failure"), most_kinds);
}

namespace {

/// What the shards have in common; the error is a sentence.
std::expected<ResultsHead, std::string> common_head(const std::vector<StoredResults>& shards) {
  if (shards.empty()) return std::unexpected("expected one folder of results at least");
  ResultsHead head = shards.front().head;
  for (const StoredResults& shard : shards) {
    if (shard.head.checksum != head.checksum)
      return std::unexpected(
          fmt::format("{} and {} are results of two campaigns, or of one before and after its files changed",
                      shards.front().folder, shard.folder));
    if (shard.head.seeds > head.seeds) head = shard.head;
  }
  head.shard = {};
  for (const StoredResults& shard : shards)
    head.shard.count = std::max(head.shard.count, shard.head.shard.count);
  return head;
}

}  // namespace

std::expected<Summary, std::string> summarize(const std::vector<StoredResults>& shards,
                                              const std::string& variant, const EachLine& each_line) {
  auto head = common_head(shards);
  if (!head) return std::unexpected(head.error());
  if (!variant.empty() && std::ranges::count(head->variants, variant) == 0)
    return std::unexpected(fmt::format("{} has no variant \"{}\"", shards.front().folder, variant));
  std::vector<std::uint64_t> found(std::exchange(head->shard.count, 1));
  Summing summing(*head);
  const auto read = each_run(shards, *head, [&](std::uint64_t number, const std::string& line) {
    const auto run = parse_run(line);
    if (!run) return;
    ++found[number % found.size()];
    each_line(line);
    if (variant.empty() || run->value("variant", "") == variant) summing.add(*run);
  });
  if (!read) return std::unexpected(read.error());
  summing.summary().missing = missing_runs(*head, found);
  return summing.finish(summing.summary().missing.empty());
}

std::expected<Summary, std::string> merge_results(const std::vector<StoredResults>& shards,
                                                  const std::string& folder) {
  auto head = common_head(shards);
  if (!head) return std::unexpected(head.error());
  head->shard = {};
  auto file = FileDraft::create(results_path(folder));
  if (!file) return std::unexpected(file.error());
  file->add(to_json(*head).dump() + '\n');
  auto summary = summarize(shards, {}, [&](std::string_view line) {
    file->add(line);
    file->add("\n");
  });
  if (!summary) return summary;
  if (const auto written = file->commit(); !written) return std::unexpected(written.error());
  return summary;
}

std::vector<std::string> describe(const Summary& summary) {
  std::vector<std::string> lines;
  for (const FailureKind& kind : summary.kinds) {
    lines.push_back(fmt::format("FAILED {}: {}", share_text(kind.runs, runs_of(summary, kind.variant)),
                                kind.fingerprint));
    lines.push_back(fmt::format("  first in variant {}, seed {}, at {}: {}", kind.variant, kind.seed,
                                text::describe_duration(kind.first.at.time_since_epoch()),
                                kind.first.detail));
  }
  if (summary.runs_of_other_kinds != 0) lines.push_back("FAILED " + other_kinds_text(summary));
  for (const std::string& canary : summary.missed_canaries) {
    lines.push_back(fmt::format(
        "CANARY MISSED: rule \"{}\" disturbs the plant, and no invariant of the campaign sees it", canary));
  }
  for (const std::string& hole : summary.holes)
    lines.push_back(fmt::format("HOLE: no run reached \"{}\", which is expected sometimes", hole));
  for (const std::string& missing : summary.missing) lines.push_back(fmt::format("MISSING: {}", missing));
  lines.push_back(fmt::format("{}: {}, {} failed, {} of failure", summary.head.campaign,
                              ascii::counted(summary.runs, "run"), summary.failed,
                              ascii::counted(summary.kinds.size(), "kind")));
  return lines;
}

}  // namespace canopus::campaign
