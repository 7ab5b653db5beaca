#pragma once
// `canopus campaign`: a plant run with thousands of seeds, rules and invariants; its reports and comparisons.

#include <optional>
#include <string>
#include <vector>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

class Command;

struct CampaignOptions {
  std::string campaign{};
  std::optional<std::uint64_t> seeds{};  ///< in place of the file's
  std::optional<std::uint64_t> seed{};   ///< this one alone
  std::string variant{};                 ///< with `seed`: this one alone
  std::string shard{};                   ///< "3/16"
  std::string results{};                 ///< folder; empty: by the campaign file's name
  std::string time{};                    ///< no run begins later
  std::size_t jobs = 0;                  ///< 0: one for each processor
  bool json = false;
};

/// Exit codes: 0 nothing was found, 1 failures, holes or a missed canary, 2 wrong usage or files.
int run_campaign(const CampaignOptions& options, Output& out, Output& err);

struct CampaignReportOptions {
  std::vector<std::string> folders{};  ///< of shards, or with folders of shards in them
  std::string output{};                ///< empty: the first of the folders
  bool json = false;
};
/// The same exit codes; 1 as well if runs are missing.
int report_campaign(const CampaignReportOptions& options, Output& out, Output& err);

struct CampaignComparison {
  std::string before{};
  std::string after{};
  std::vector<std::string> variants{};  ///< of `before` and of `after`; none: all
};
/// Exit codes: 0 nothing is worse, 1 something is, 2 wrong usage or files.
int compare_campaigns(const CampaignComparison& options, Output& out, Output& err);

/// Adds the subcommand `campaign` to the program.
void add_campaign_command(Command& app, int& exit_code);

}  // namespace canopus::cli
