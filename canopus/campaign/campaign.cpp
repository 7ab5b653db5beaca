#include "canopus/campaign/campaign.hpp"

#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "canopus/campaign/plant_run.hpp"
#include "canopus/campaign/python_check.hpp"
#include "canopus/campaign/random_stream.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::campaign {
namespace {

/// Builds the plant with each rule alone, and runs nothing.
bool try_rules(const Campaign& campaign, text::Output& err) {
  bool is_good = true;
  std::set<std::string> printed;
  const auto try_plan = [&](std::size_t variant, const Rule* rule) {
    RunPlan plan{.variant = variant, .seed = campaign.file.first_seed};
    if (rule != nullptr) plan.rules.push_back(chosen_rule(*rule, plan.seed));
    const auto built = run(campaign, plan);
    if (built) return true;
    is_good = false;
    text::FileError error = built.error();
    if (error.place == text::Place{} && rule != nullptr)
      error = {place_of_key_in(error.message, rule->places, rule->place),
               fmt::format("rule \"{}\": {}", rule->name, error.message)};
    if (error.place == text::Place{}) error.place = campaign.file.variants[variant].place;
    std::string line = text::describe(error, campaign.file.path);
    if (printed.insert(line).second) err.line("{}", line);
    return false;
  };
  for (std::size_t variant = 0; variant < campaign.plants.size(); ++variant) {
    if (!try_plan(variant, nullptr)) continue;
    for (const Rule& rule : campaign.file.rules) (void)try_plan(variant, &rule);
  }
  return is_good;
}

/// Of each invariant in Python. False after what is not there was printed.
bool find_python_functions(const CampaignFile& campaign, text::Output& err) {
  bool is_good = true;
  for (const Invariant& invariant : campaign.invariants) {
    if (invariant.kind != InvariantKind::python) continue;
    const std::string problem =
        find_python_function(python_path(campaign.path, invariant), invariant.function);
    if (problem.empty()) continue;
    is_good = false;
    err.line("{}", text::describe(
                       text::FileError{place_of_key_in(problem, invariant.places, invariant.place), problem},
                       campaign.path));
  }
  return is_good;
}

/// What decides what a run does.
std::string checksum_of(const Campaign& campaign) {
  Checksum checksum;
  toml::table source = campaign.source;
  if (toml::table* const head = source["campaign"].as_table()) head->erase("seeds");
  checksum.add(text_of(source));
  for (const Invariant& invariant : campaign.file.invariants) {
    if (invariant.kind != InvariantKind::python) continue;
    if (const auto text = text::read_file(python_path(campaign.file.path, invariant))) checksum.add(*text);
  }
  std::set<std::string> files;
  for (const PlantTemplate& plant : campaign.plants) {
    toml::table table = *plant.with({});
    each_path(table, [&](std::string& path) {
      const auto file = std::filesystem::path(plant.path()).parent_path() / path;
      if (!files.insert(file.string()).second) {
        // read before
      } else if (const auto text = text::read_file(file.string())) {
        checksum.add(*text);
      }
      path = std::filesystem::path(path).filename().string();  // the same in another folder
    });
    checksum.add(text_of(table));
  }
  return fmt::format("{:016x}", checksum.value());
}

}  // namespace

std::optional<Campaign> load_campaign(const std::string& path, text::Output& err) {
  const auto text = text::read_file(path);
  if (!text) {
    err.line("canopus: {}", text.error());
    return std::nullopt;
  }
  CampaignReading reading = read_campaign(*text, path);
  if (!reading.errors.empty()) {
    text::print_errors(std::move(reading.errors), path, err);
    return std::nullopt;
  }
  Campaign campaign{.file = std::move(reading.campaign), .source = *text::parse_toml(*text)};
  for (const Variant& variant : campaign.file.variants) {
    if (!campaign.plants.emplace_back().load(campaign.file, variant, err)) return std::nullopt;
  }
  if (!find_python_functions(campaign.file, err) || !try_rules(campaign, err)) return std::nullopt;
  campaign.checksum = checksum_of(campaign);
  return campaign;
}

}  // namespace canopus::campaign
