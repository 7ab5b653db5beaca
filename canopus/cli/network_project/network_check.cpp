#include "canopus/cli/network_project/network_check.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>
#include <system_error>
#include <utility>

#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/initial_nodes.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/plant/plant_review.hpp"

namespace canopus::cli {
namespace {

using network_project::ProjectNode;

plant::ReviewedNode reviewed(const ProjectNode& node) {
  static const std::vector<text::ObjectSetting> no_settings;
  plant::ReviewedNode result{.place = {node.listed.line, 0},
                             .name = node.shown_name(),
                             .node_id = node.id(),
                             .objects = canopen::ObjectDictionary(node.device->dictionary, node.id()),
                             .settings = &no_settings,
                             .file = node.device.get()};
  const canopen::CobId sync{static_cast<std::uint32_t>(node.value(0x1005).value_or(0))};
  result.produces_sync =
      sync.has_bit_30() && !canopen::is_restricted(sync) && node.value(0x1006).value_or(0) != 0;
  return result;
}

/// A manager is in the project, so what happens on its bus is known.
bool has_manager(const network_project::NetworkProject& project) {
  return std::ranges::any_of(project.nodes(), [](const ProjectNode& node) {
    return node.device != nullptr && node.device->commissioning &&
           node.device->commissioning->canopen_manager;
  });
}

/// The buses of a plant file that have this project; all where none has it.
std::set<std::string, std::less<>> buses_of(const plant::PlantFile& file, const std::string& list) {
  std::set<std::string, std::less<>> with_project, all;
  for (const plant::BusSection& bus : file.buses) {
    all.insert(bus.name);
    std::error_code unknown;
    const auto path = std::filesystem::path(file.path).parent_path() / bus.project;
    if (!bus.project.empty() && std::filesystem::equivalent(path, list, unknown))
      with_project.insert(bus.name);
  }
  return with_project.empty() ? all : with_project;
}

}  // namespace

std::optional<network_project::ExternalPdos> external_pdos(const network_project::NetworkProject& project,
                                                           const std::string& plant_file, text::Output& err) {
  class NoObserver final : public plant::PlantObserver {
  } no_observer;
  const auto plant = plant::load_plant(plant_file, no_observer, err);
  if (!plant) return std::nullopt;
  const auto buses = buses_of(plant->file(), project.list_path());
  const std::vector<text::ObjectSetting> no_settings;
  network_project::ExternalPdos external;
  for (plant::InitialPlantNode& node : plant::initial_nodes(*plant)) {
    const bool is_own = std::ranges::any_of(project.nodes(), [&](const ProjectNode& one) {
      return one.id() == node.node_id && one.listed.present;
    });
    if (is_own || !buses.contains(node.bus)) continue;
    for (const plant::ReviewedPdo& pdo : plant::active_pdos(
             {.name = node.name, .objects = std::move(node.objects), .settings = &no_settings}))
      (pdo.transmit ? external.sent : external.received).insert(pdo.cob_id.key());
  }
  return external;
}

std::vector<network_project::Finding> review_network(const network_project::NetworkProject& project,
                                                     const network_project::ExternalPdos& external) {
  std::vector<network_project::Finding> findings = network_project::review(project, external);
  plant::ReviewedBus bus{.name = project.network().name};
  for (const ProjectNode& node : project.nodes()) {
    if (node.device != nullptr && node.listed.present) bus.nodes.push_back(reviewed(node));
  }
  bus.may_have_others = !has_manager(project);
  // One CAN-ID of two senders cannot work; the other warnings about plants may be intended.
  plant::Warnings conflicts;
  plant::find_two_senders(bus, conflicts);
  plant::Warnings warnings;
  plant::review(bus, warnings);
  for (text::FileWarning& warning : warnings) {
    const bool is_conflict = std::ranges::find(conflicts, warning) != conflicts.end();
    const auto node = std::ranges::find_if(
        project.nodes(), [&](const ProjectNode& one) { return one.listed.line == warning.place.line; });
    findings.push_back(
        {.severity = is_conflict ? eds::Problem::Severity::error : eds::Problem::Severity::warning,
         .node_id = node == project.nodes().end() ? std::uint8_t{0} : node->id(),
         .path = project.list_path(),
         .line = warning.place.line,
         .message = std::move(warning.message)});
  }
  std::ranges::stable_sort(findings,
                           [](const network_project::Finding& a, const network_project::Finding& b) {
                             return std::pair(a.severity, a.node_id) < std::pair(b.severity, b.node_id);
                           });
  return findings;
}

}  // namespace canopus::cli
