#include "canopus/cli/run/campaign_command.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/campaign/failure_story.hpp"
#include "canopus/campaign/report.hpp"
#include "canopus/campaign/runner.hpp"
#include "canopus/cli/bus/bus_command.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/stop_signals.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using campaign::StoredResults;
using campaign::Summary;

int wrong_campaign(Output& err, std::string_view sentence) {
  err.line("canopus: {}", sentence);
  return exit_code::usage;
}

bool found_something(const Summary& summary) {
  return !summary.kinds.empty() || !summary.holes.empty() || !summary.missed_canaries.empty();
}

void print_summary(const Summary& summary, bool json, Output& out) {
  if (!json) {
    for (const std::string& line : campaign::describe(summary)) out.line("{}", line);
    return;
  }
  for (const campaign::FailureKind& kind : summary.kinds) {
    out.json({{"event", "failure"},
              {"fingerprint", kind.fingerprint},
              {"runs", kind.runs},
              {"variant", kind.variant},
              {"seed", kind.seed},
              {"detail", kind.first.detail},
              {"folder", campaign::story_folder(kind)}});
  }
  out.json({{"event", "summary"},
            {"campaign", summary.head.campaign},
            {"runs", summary.runs},
            {"failed", summary.failed},
            {"kinds", summary.kinds.size()},
            {"holes", text::Json(summary.holes)},
            {"missed_canaries", text::Json(summary.missed_canaries)},
            {"missing", text::Json(summary.missing)}});
}

void print_traceback(const campaign::InvariantFailure& failure, Output& out) {
  std::istringstream lines(failure.traceback);
  for (std::string line; std::getline(lines, line);) out.line("    {}", line);
}

/// One seed: what it chose, and what came of it.
int run_seed(const campaign::Campaign& campaign, const CampaignOptions& options, Output& out) {
  bool has_failed = false;
  bool is_canary = false;
  for (std::size_t variant = 0; variant < campaign.file.variants.size(); ++variant) {
    if (!options.variant.empty() && campaign.file.variants[variant].name != options.variant) continue;
    const campaign::RunPlan plan = campaign::plan_of(campaign, variant, *options.seed);
    const campaign::RunResult result = campaign::run_or_fail(campaign, plan);
    has_failed = has_failed || !result.failures.empty();
    is_canary = campaign.file.canary_of(plan.seed) != nullptr;
    if (options.json) {
      out.json(campaign::to_json(campaign.file, result, plan.rules));
      continue;
    }
    out.line("variant {}, seed {}:", campaign.file.variants[variant].name, plan.seed);
    for (const campaign::ChosenRule& chosen : plan.rules) {
      std::string knobs;
      for (const campaign::Knob& knob : chosen.knobs) knobs += fmt::format(" {} = {}", knob.name, knob.value);
      out.line("  rule {}{}{}", chosen.rule->name, knobs.empty() ? "" : ":", knobs);
    }
    for (const campaign::InvariantFailure& failure : result.failures) {
      print_traceback(failure, out);
      out.line("  FAILED at {}: {} ({})", text::describe_duration(failure.at.time_since_epoch()),
               failure.fingerprint(), failure.detail);
    }
    if (result.failures.empty()) out.line("  passed");
  }
  if (is_canary && !options.json) out.line("the seed of a canary: it has to fail");
  return has_failed == is_canary ? exit_code::done : exit_code::failed;
}

/// The progress on the terminal, and when the campaign ends before its last run.
class CampaignWatch {
 public:
  explicit CampaignWatch(std::optional<can::Duration> time) : stop_(HangUp::is_seen) {
    if (time) end_ = start_ + *time;
  }
  bool is_over() { return was_stopped() || (end_ && Clock::now() >= *end_); }
  bool is_over(const campaign::Progress& progress) {
    const Clock::time_point now = Clock::now();
    if (now - shown_ >= std::chrono::milliseconds(250)) {
      shown_ = now;
      show(progress, std::chrono::duration<double>(now - start_).count());
    }
    return is_over();
  }
  /// By a signal, up to now.
  [[nodiscard]] bool was_stopped() {
    was_stopped_ = was_stopped_ || stop_.came();
    return was_stopped_;
  }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

 private:
  static void show(const campaign::Progress& progress, double seconds) {
    const double rate = seconds > 0 ? static_cast<double>(progress.ran) / seconds : 0;
    std::string left;
    if (rate > 0)
      left = fmt::format(", {:.0f} s left", static_cast<double>(progress.all - progress.done) / rate);
    show_progress(Line("{} of {} runs, {} failed, {} runs/s{}", progress.done, progress.all, progress.failed,
                       fmt::format("{:.1f}", rate), left));
  }

  StopWatch stop_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point shown_{};
  std::optional<Clock::time_point> end_;
  bool was_stopped_ = false;
};

std::string default_folder(const CampaignOptions& options, campaign::Shard shard) {
  if (!options.results.empty()) return options.results;
  const fs::path folder = fs::path(options.campaign).stem().string() + ".results";
  return shard.count == 1 ? folder.string()
                          : (folder / fmt::format("shard-{}-of-{}", shard.number, shard.count)).string();
}

int run_seeds(campaign::Campaign& campaign, const CampaignOptions& options, campaign::Shard shard,
              Output& out, Output& err) {
  if (options.seeds) campaign.file.seeds = *options.seeds;
  const std::string folder = default_folder(options, shard);
  auto results = campaign::Results::open(folder, head_of(campaign, shard));
  if (!results) return wrong_campaign(err, results.error());
  std::optional<can::Duration> time;
  if (!options.time.empty()) time = *text::parse_duration(options.time);
  CampaignWatch watch(time);
  const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
  const auto progress =
      campaign::run_all(campaign, *results,
                        {.jobs = options.jobs == 0 ? processors : options.jobs,
                         .shard = shard,
                         .is_over = [&](const campaign::Progress& now) { return watch.is_over(now); }});
  const double seconds = watch.seconds();
  end_progress();
  if (!progress) return wrong_campaign(err, progress.error());
  if (const auto finished = results->finish(); !finished) return wrong_campaign(err, finished.error());
  auto summary = campaign::summarize({{folder, head_of(campaign, shard)}});
  if (!summary) return wrong_campaign(err, summary.error());
  // Other shards are not missing here, and time that has run out leaves runs to the next start.
  summary->missing.clear();
  const auto no_more = [&] { return watch.was_stopped() || watch.is_over(); };
  const auto stories = campaign::write_stories(campaign, *summary, folder,
                                               [&] { return time ? watch.was_stopped() : no_more(); });
  if (!stories) return wrong_campaign(err, stories.error());
  if (shard.count == 1) {
    const auto written = campaign::write_report(*summary, {folder}, folder);
    if (!written) return wrong_campaign(err, written.error());
  }
  print_summary(*summary, options.json, out);
  if (!options.json) {
    if (progress->done < progress->all)
      out.line("{} of {} runs are done; the same command continues", progress->done, progress->all);
    const double plant_seconds =
        static_cast<double>(progress->ran) * std::chrono::duration<double>(campaign.file.duration).count();
    if (progress->ran != 0)
      out.line("{} runs/s, {} s of plant time a second; results in {}",
               fmt::format("{:.1f}", static_cast<double>(progress->ran) / seconds),
               fmt::format("{:.0f}", plant_seconds / seconds), folder);
  }
  return found_something(*summary) ? exit_code::failed : exit_code::done;
}

/// A folder of results, and those of shards in it.
std::vector<std::string> folders_of_results(const std::string& folder) {
  std::vector<std::string> found;
  const auto has_results = [](const fs::path& path) {
    return fs::exists(path / "results.jsonl") || fs::exists(path / "results.part.jsonl");
  };
  if (has_results(folder)) found.push_back(folder);
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename().string().starts_with("shard-") && has_results(entry.path()))
      found.push_back(entry.path().string());
  }
  std::ranges::sort(found);
  if (found.empty()) found.push_back(folder);  // whose mistake is reported
  return found;
}

std::expected<std::vector<StoredResults>, std::string> read_folders(const std::vector<std::string>& folders) {
  std::vector<StoredResults> all;
  for (const std::string& folder : folders) {
    for (const std::string& each : folders_of_results(folder)) {
      auto results = campaign::read_results(each);
      if (!results) return std::unexpected(results.error());
      all.push_back(std::move(*results));
    }
  }
  return all;
}

OptionCheck is_duration() {
  return [](const std::string& text) {
    const auto duration = text::parse_duration(text);
    return duration ? std::string() : duration.error();
  };
}

/// Whether `report` or `compare` was run, and not a campaign.
using InnerRan = std::shared_ptr<bool>;

void build_report(Command& command, int& exit_code, const InnerRan& ran) {
  auto options = std::make_shared<CampaignReportOptions>();
  command
      .add_option("DIR", options->folders, "Folders of results: of shards, or with folders of shards in them")
      ->required();
  command.add_option("--output", options->output, "Folder of the reports; default: the first DIR")
      ->type_name("DIR");
  command.add_flag("--json", options->json, "One JSON object per line");
  command.footer(
      "Writes report.html, junit.xml and results.jsonl: the same bytes for any number of shards.\n"
      "Exit codes: 0 nothing was found, 1 failures, holes, missed canaries or missing runs, 2 wrong usage or "
      "files.");
  command.callback([options, ran, &exit_code] {
    *ran = true;
    exit_code = report_campaign(*options, standard_output(), standard_error());
  });
}

void build_compare(Command& command, int& exit_code, const InnerRan& ran) {
  auto options = std::make_shared<CampaignComparison>();
  command.add_option("BEFORE", options->before, "Folder of results")->required();
  command.add_option("AFTER", options->after, "Folder of results")->required();
  command
      .add_option("--variants", options->variants,
                  "A variant of BEFORE with one of AFTER; the folders may be the same")
      ->type_name("OLD NEW")
      ->expected(2);
  command.footer(
      "New failures, failures in half as many runs again, new holes, boot and reaction times that are half "
      "as long again.\n"
      "Exit codes: 0 nothing is worse, 1 something is, 2 wrong usage or files.");
  command.callback([options, ran, &exit_code] {
    *ran = true;
    exit_code = compare_campaigns(*options, standard_output(), standard_error());
  });
}

void build_campaign_command(Command& command, int& exit_code) {
  auto options = std::make_shared<CampaignOptions>();
  command.add_option("CAMPAIGN", options->campaign, "Campaign file (TOML, see docs/campaign.md)");
  command.add_option("--seeds", options->seeds, "Number of seeds, instead of the file's")
      ->type_name("N")
      ->check(number_from(1, campaign::most_seeds));
  auto* seed =
      command
          .add_option("--seed", options->seed, "Run this seed alone, and print what it chose and what failed")
          ->type_name("N")
          ->check(number_from(0, std::numeric_limits<std::int64_t>::max()));
  command.add_option("--variant", options->variant, "With --seed: this variant alone")
      ->type_name("NAME")
      ->needs(seed);
  command.add_option("--shard", options->shard, "This share of the runs alone, 1/N to N/N")
      ->type_name("I/N")
      ->excludes(seed)
      ->check([](const std::string& text) {
        const auto shard = campaign::parse_shard(text);
        return shard ? std::string() : shard.error();
      });
  command
      .add_option(
          "--results", options->results,
          "Folder of the results, which a second start continues; default: by the name of CAMPAIGN, in the "
          "current folder")
      ->type_name("DIR")
      ->excludes(seed);
  command.add_option("--time", options->time, "Begin no run after this time")
      ->type_name("TIME")
      ->excludes(seed)
      ->check(is_duration());
  command.add_option("--jobs", options->jobs, "Runs at once, a plant each; default: one for each processor")
      ->type_name("N")
      ->check(number_from(1, 1024));
  command.add_flag("--json", options->json, "One JSON object per line");
  command.footer(
      "Ctrl-C keeps what is done; the same command continues.\n"
      "Exit codes: 0 nothing was found, 1 failures, holes or a missed canary, 2 wrong usage or files.\n"
      "Example: canopus campaign examples/campaign/campaign.toml --time 10min");
  const auto ran = std::make_shared<bool>(false);
  command.add_subcommand("report", "Merge the results of shards into one report",
                         [&exit_code, ran](Command& inner) { build_report(inner, exit_code, ran); });
  command.add_subcommand("compare", "What got worse from one campaign to another",
                         [&exit_code, ran](Command& inner) { build_compare(inner, exit_code, ran); });
  command.callback([options, ran, &exit_code] {
    if (!*ran) exit_code = run_campaign(*options, standard_output(), standard_error());
  });
}

}  // namespace

int run_campaign(const CampaignOptions& options, Output& out, Output& err) {
  if (options.campaign.empty())
    return wrong_campaign(err, "expected CAMPAIGN, a campaign file, or the command report or compare");
  auto campaign = campaign::load_campaign(options.campaign, err);
  if (!campaign) return exit_code::usage;
  if (!options.variant.empty() &&
      std::ranges::count(campaign->file.variants, options.variant, &campaign::Variant::name) == 0) {
    return wrong_campaign(
        err, fmt::format("--variant {}: the campaign has no variant of this name", options.variant));
  }
  if (options.seed) return run_seed(*campaign, options, out);
  campaign::Shard shard;
  if (!options.shard.empty()) shard = *campaign::parse_shard(options.shard);
  return run_seeds(*campaign, options, shard, out, err);
}

int report_campaign(const CampaignReportOptions& options, Output& out, Output& err) {
  const auto shards = read_folders(options.folders);
  if (!shards) return wrong_campaign(err, shards.error());
  const std::string output = options.output.empty() ? options.folders.front() : options.output;
  const auto summary = campaign::merge_results(*shards, output);
  if (!summary) return wrong_campaign(err, summary.error());
  std::vector<std::string> folders;
  for (const StoredResults& shard : *shards) folders.push_back(shard.folder);
  const auto written = campaign::write_report(*summary, folders, output);
  if (!written) return wrong_campaign(err, written.error());
  print_summary(*summary, options.json, out);
  return summary->is_good() ? exit_code::done : exit_code::failed;
}

int compare_campaigns(const CampaignComparison& options, Output& out, Output& err) {
  const auto summary_of = [&](const std::string& folder,
                              std::size_t number) -> std::expected<Summary, std::string> {
    const auto shards = read_folders({folder});
    if (!shards) return std::unexpected(shards.error());
    return campaign::summarize(*shards, options.variants.empty() ? "" : options.variants[number]);
  };
  const auto before = summary_of(options.before, 0);
  if (!before) return wrong_campaign(err, before.error());
  const auto after = summary_of(options.after, 1);
  if (!after) return wrong_campaign(err, after.error());
  const campaign::Comparison comparison = campaign::compare(*before, *after);
  for (const std::string& line : comparison.lines) out.line("{}", line);
  if (comparison.lines.empty()) out.line("no difference");
  return comparison.is_worse ? exit_code::failed : exit_code::done;
}

void add_campaign_command(Command& app, int& exit_code) {
  app.add_subcommand("campaign", "Run a plant with thousands of seeds, and find what breaks it",
                     [&exit_code](Command& command) { build_campaign_command(command, exit_code); });
}

}  // namespace canopus::cli
