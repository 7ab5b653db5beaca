// A running network taken over into a project.

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/bus/scan_command.hpp"
#include "canopus/cli/network_project/bus_session.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/output/device_names.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;
using client::FoundNode;
using network_project::NetworkProject;
using Json = text::Json;

/// A device file, and the identity of its device.
struct Candidate {
  std::string path;
  std::string text;
  eds::Identity identity;
};

/// A path of a file must be a device file; in folders other files are skipped.
std::expected<std::vector<Candidate>, std::string> read_candidates(const std::vector<std::string>& names) {
  std::vector<std::string> paths;
  std::vector<Candidate> candidates;
  const auto take = [&](const std::string& path) -> std::expected<void, std::string> {
    auto text = text::read_file(path);
    if (!text) return std::unexpected(text.error());
    const eds::ReadResult read = eds::read_device_file(*text);
    if (read.file == nullptr) {
      return std::unexpected(fmt::format("{}:{}: {}", path, read.problems[0].line, read.problems[0].message));
    }
    candidates.push_back({path, std::move(*text), eds::identity(*read.file)});
    return {};
  };
  for (const std::string& name : names) {
    std::error_code error;
    if (!fs::is_directory(name, error)) {
      if (const auto taken = take(name); !taken) return std::unexpected(taken.error());
      continue;
    }
    paths.clear();
    for (fs::directory_iterator entry(name, error), end; !error && entry != end; entry.increment(error)) {
      std::error_code none;
      if (is_device_file(entry->path()) && entry->is_regular_file(none))
        paths.push_back(entry->path().string());
    }
    if (error) return std::unexpected(fmt::format("{}: {}", name, error.message()));
    std::ranges::sort(paths);
    for (const std::string& path : paths) {
      if (const auto taken = take(path); !taken)
        print_error("canopus project: passed over: {}", taken.error());
    }
  }
  if (candidates.empty()) return std::unexpected("--eds: no device file is there");
  return candidates;
}

enum class Match : std::uint8_t { none, other_revision, exact };

Match match(const Candidate& candidate, const FoundNode& node) {
  const eds::Identity& file = candidate.identity;
  // A device with only a known profile matches no file.
  if (!node.vendor && !node.product) return Match::none;
  const auto differs = [](std::optional<std::uint32_t> file_value, std::optional<std::uint32_t> found) {
    return file_value.value_or(0) != found.value_or(0);
  };
  if (differs(file.vendor_id, node.vendor) || differs(file.product_code, node.product)) return Match::none;
  if (file.device_type && node.device_type && *file.device_type != *node.device_type) return Match::none;
  return differs(file.revision, node.revision) ? Match::other_revision : Match::exact;
}

struct Choice {
  const Candidate* candidate = nullptr;
  Match match = Match::none;
};

/// The best; of revisions that are all others the newest one.
Choice choose(const std::vector<Candidate>& candidates, const FoundNode& node) {
  Choice best;
  for (const Candidate& candidate : candidates) {
    const Match one = match(candidate, node);
    const bool is_newer =
        one == best.match && one == Match::other_revision &&
        candidate.identity.revision.value_or(0) > best.candidate->identity.revision.value_or(0);
    if (one > best.match || is_newer) best = {&candidate, one};
  }
  return best;
}

std::string_view describe(Match match) {
  switch (match) {
    case Match::exact: return "exact";
    case Match::other_revision: return "other revision";
    case Match::none: break;
  }
  return "none";
}

void tell(const ProjectArguments& arguments, const FoundNode& node, const Choice& choice,
          std::string_view result) {
  if (arguments.bus.json) {
    Json json = scan_json(node);
    json["match"] = describe(choice.match);
    if (choice.candidate != nullptr) json["eds"] = choice.candidate->path;
    json["result"] = result;
    return print_json(json);
  }
  print_line("node {} ({}): {}{}", node.node_id, node.name.value_or("no name"), result,
             choice.candidate == nullptr
                 ? ""
                 : fmt::format(", {}{}", choice.candidate->path,
                               choice.match == Match::exact ? "" : ": the device has another revision"));
}

/// Adds the nodes that are not in the project. Returns how many failed.
unsigned add_found(const ProjectArguments& arguments, std::uint32_t bit_rate,
                   const std::vector<Candidate>& candidates, const std::vector<FoundNode>& found,
                   NetworkProject& project, std::vector<std::uint8_t>& added) {
  unsigned left = 0;
  for (const FoundNode& node : found) {
    if (project.find(node.node_id) != nullptr) {
      tell(arguments, node, {}, "is in the project already");
      continue;
    }
    const Choice choice = choose(candidates, node);
    if (choice.candidate == nullptr) {
      ++left;
      tell(arguments, node, choice, node.answers_sdo ? "no device file matches it" : "does not answer");
      continue;
    }
    const auto done = project.add_node({.node_id = node.node_id,
                                        .name = node.name.value_or(""),
                                        .eds = choice.candidate->text,
                                        .eds_name = fs::path(choice.candidate->path).filename().string(),
                                        .bit_rate = bit_rate});
    if (!done) {
      ++left;
      print_error("canopus project: node {}: {}", node.node_id, done.error());
      continue;
    }
    added.push_back(*done);
    tell(arguments, node, choice, "added");
  }
  return left;
}

}  // namespace

int adopt_network(const ProjectArguments& arguments) {
  const auto range = parse_node_range(arguments.nodes);
  if (!range) return project_failed(project_code::usage, range.error());
  const auto bit_rate = parse_bit_rate(arguments.bit_rate);
  if (!bit_rate) return project_failed(project_code::usage, bit_rate.error());
  const auto candidates = read_candidates(arguments.eds);
  if (!candidates) return project_failed(project_code::file, candidates.error());
  return change_network(arguments, "adopt", [&](ProjectFolder&, NetworkProject& project) {
    return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
      std::vector<FoundNode> found;
      if (const int code = scan_bus(bus, *range, time_out, found); code != exit_code::done) return code;
      if (found.empty()) return project_failed(project_code::no_answer, "no node answers");
      std::vector<std::uint8_t> added;
      const unsigned left = add_found(arguments, *bit_rate, *candidates, found, project, added);
      BusSession session(arguments, bus, time_out);
      if (!arguments.no_values) {
        for (const std::uint8_t node : added) session.take_over(project, node);
      }
      const int code = session.end();
      if (!arguments.bus.json) {
        print_line("{} of {} nodes taken over{}", added.size(), found.size(),
                   left == 0 ? "" : fmt::format(", {} left", left));
      }
      if (code == project_code::no_answer) return code;
      return left == 0 ? project_code::done : project_code::different;
    });
  });
}

}  // namespace canopus::cli
