// A running network taken over into a project.

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/bus/scan_command.hpp"
#include "canopus/cli/files/device_file_match.hpp"
#include "canopus/cli/network_project/bus_session.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;
using client::FoundNode;
using network_project::NetworkProject;
using Json = text::Json;

void print_result(const ProjectArguments& arguments, const FoundNode& node, const DeviceFileChoice& choice,
                  std::string_view result) {
  if (arguments.bus.json) {
    Json json = scan_json(node);
    json["match"] = describe(choice.match);
    if (choice.candidate != nullptr) json["eds"] = choice.candidate->path;
    json["result"] = result;
    return print_json(json);
  }
  print_line(
      "node {} ({}): {}{}", node.node_id, node.name.value_or("no name"), result,
      choice.candidate == nullptr
          ? ""
          : fmt::format(", {}{}", choice.candidate->path,
                        choice.match == DeviceFileMatch::exact ? "" : ": the device has another revision"));
}

/// Adds the nodes that are not in the project. Returns how many failed.
unsigned add_found(const ProjectArguments& arguments, std::uint32_t bit_rate,
                   const std::vector<DeviceFileCandidate>& candidates, const std::vector<FoundNode>& found,
                   NetworkProject& project, std::vector<std::uint8_t>& added) {
  unsigned left = 0;
  for (const FoundNode& node : found) {
    if (project.find(node.node_id) != nullptr) {
      print_result(arguments, node, {}, "is in the project already");
      continue;
    }
    const DeviceFileChoice choice = choose_device_file(candidates, node);
    if (choice.candidate == nullptr) {
      ++left;
      print_result(arguments, node, choice,
                   node.answers_sdo ? "no device file matches it" : "does not answer");
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
    print_result(arguments, node, choice, "added");
  }
  return left;
}

}  // namespace

int adopt_network(const ProjectArguments& arguments) {
  const auto range = parse_node_range(arguments.nodes);
  if (!range) return project_failed(project_code::usage, range.error());
  const auto bit_rate = bit_rate_of(arguments.bit_rate);
  if (!bit_rate) return project_failed(project_code::usage, bit_rate.error());
  std::vector<std::string> skipped;
  const auto candidates = read_device_files(arguments.eds, skipped);
  for (const std::string& reason : skipped) print_error("canopus project: passed over: {}", reason);
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
        for (const std::uint8_t node : added) session.accept_values(project, node);
      }
      const int code = session.end();
      if (!arguments.bus.json) {
        print_line("{} of {} taken over{}", added.size(), ascii::counted(found.size(), "node"),
                   left == 0 ? "" : fmt::format(", {} left", left));
      }
      if (code == project_code::no_answer) return code;
      return left == 0 ? project_code::done : project_code::different;
    });
  });
}

}  // namespace canopus::cli
