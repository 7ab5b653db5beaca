// Commands that hold a project against the devices on its bus, and write it.

#include "canopus/cli/network_project/bus_session.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/output/print.hpp"

namespace canopus::cli {
namespace {

using network_project::NetworkProject;
using network_project::ProjectNode;

/// The node of the arguments, or all that are present.
std::expected<std::vector<std::uint8_t>, std::string> nodes_of(const ProjectArguments& arguments,
                                                               const NetworkProject& project) {
  std::vector<std::uint8_t> nodes;
  if (!arguments.node.empty()) {
    const auto node = project.find(arguments.node);
    if (!node) return std::unexpected(node.error());
    return std::vector{(*node)->id()};
  }
  for (const ProjectNode& node : project.nodes()) {
    if (node.listed.present) nodes.push_back(node.id());
  }
  if (nodes.empty()) return std::unexpected("the project has no node that is present");
  return nodes;
}

int for_each_node(const ProjectArguments& arguments, void (BusSession::*action)(const ProjectNode&)) {
  return with_network(arguments, [&](const ProjectFolder&, const NetworkProject& project) {
    const auto nodes = nodes_of(arguments, project);
    if (!nodes) return project_failed(project_code::refused, nodes.error());
    return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
      BusSession session(arguments, bus, time_out);
      for (const std::uint8_t node : *nodes) (session.*action)(*project.find(node));
      return session.end();
    });
  });
}

}  // namespace

int compare_network(const ProjectArguments& arguments) {
  return for_each_node(arguments, &BusSession::compare);
}

int write_network(const ProjectArguments& arguments) {
  const auto write = [&] { return for_each_node(arguments, &BusSession::write); };
  // A closed output must not leave a device half written.
  const int code = arguments.yes ? run_ignoring_sigpipe(write) : write();
  if (code == project_code::different && !arguments.yes && !arguments.bus.json) {
    print_line("nothing is written yet: --yes writes");
  }
  return code;
}

int read_network(const ProjectArguments& arguments) {
  const std::string title = "read " + (arguments.node.empty() ? std::string("all nodes") : arguments.node);
  return change_network(arguments, title, [&](ProjectFolder&, NetworkProject& project) {
    const auto nodes = nodes_of(arguments, project);
    if (!nodes) return project_failed(project_code::refused, nodes.error());
    return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
      BusSession session(arguments, bus, time_out);
      for (const std::uint8_t node : *nodes) session.accept_values(project, node);
      const int code = session.end();
      return code == project_code::different ? project_code::done : code;
    });
  });
}

}  // namespace canopus::cli
