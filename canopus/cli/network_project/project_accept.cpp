// A device that took the place of another one: its identity becomes the project's.

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/network_project/bus_objects.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/network_project/device_acceptance.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using network_project::AcceptedValue;
using network_project::IdentityValue;
using network_project::NetworkProject;
using network_project::ProjectNode;
using Json = text::Json;

constexpr text::ObjectName identity_objects[] = {
    {0x1000, 0}, {0x1018, 1}, {0x1018, 2}, {0x1018, 3}, {0x1018, 4}};

/// The identity that the device answers; a value that it refuses does not exist. The error: it does not
/// answer.
std::expected<std::vector<IdentityValue>, std::string> read_identity(master::ObjectAccess& device) {
  std::vector<IdentityValue> found;
  for (const text::ObjectName object : identity_objects) {
    const auto value = device.read(object, canopen::DataType::unsigned32);
    if (!value && !value.error().is_refused) return std::unexpected(value.error().reason);
    if (!value || value->size() != 4) continue;
    found.push_back({object.index, object.sub, static_cast<std::uint32_t>(can::load_value(*value))});
  }
  return found;
}

void print_accepted(const ProjectArguments& arguments, const NetworkProject& project,
                    const AcceptedValue& value) {
  const ProjectNode& node = *project.find(value.node_id);
  const canopen::Entry entry = node.device->dictionary->find(value.index, value.sub);
  const std::string title = network_project::object_title(*node.device, entry);
  const std::string object = canopen::object_text(value.index, value.sub);
  if (arguments.bus.json) {
    return print_json(Json{{"node", node.id()},
                           {"object", object},
                           {"name", title},
                           {"state", arguments.yes ? "taken" : "different"},
                           {"project", value.before},
                           {"device", value.after}});
  }
  print_line("{}: {}  project {:08X}H, device {:08X}H  {}", node.shown_name(), object, value.before,
             value.after, title);
}

/// Calls use(project, values) with what differs.
int with_difference(const ProjectArguments& arguments, const NetworkProject& project,
                    const std::function<int(const std::vector<AcceptedValue>&)>& use) {
  const auto node = project.find(arguments.node);
  if (!node) return project_failed(project_code::refused, node.error());
  if ((*node)->device == nullptr) {
    return project_failed(project_code::file,
                          fmt::format("{}: {}", (*node)->shown_name(), (*node)->trouble()));
  }
  // Accepting values creates the node again.
  const std::uint8_t id = (*node)->id();
  const std::string name = (*node)->shown_name();
  return with_bus(arguments.bus, [&](BusLoop& bus, can::Duration time_out) {
    bus.need({link::IdentifierFilter::function(canopen::cob_id::sdo_response)});
    BusObjects objects(bus, id, time_out);
    const auto found = read_identity(objects);
    if (!found) {
      return project_failed(project_code::no_answer,
                            fmt::format("{} does not answer ({})", name, found.error()));
    }
    const auto values = find_accepted_values(project, id, *found);
    for (const AcceptedValue& value : values) print_accepted(arguments, project, value);
    const int code = use(values);
    if (code == project_code::refused) return code;
    if (arguments.bus.json) {
      print_json(Json{{"node", id},
                      {"state", values.empty()  ? "same"
                                : arguments.yes ? "taken"
                                                : "different"},
                      {"differ", values.size()}});
    } else if (values.empty()) {
      print_line("{}: is the device that the project has", name);
    } else {
      print_line(
          "{}: {}", name,
          arguments.yes ? "this device is the project's now" : "nothing is changed yet: --yes accepts it");
    }
    return code;
  });
}

}  // namespace

int accept_device(const ProjectArguments& arguments) {
  if (!arguments.yes) {
    return with_network(arguments, [&](const ProjectFolder&, const NetworkProject& project) {
      return with_difference(arguments, project, [](const std::vector<AcceptedValue>& values) {
        return values.empty() ? project_code::done : project_code::different;
      });
    });
  }
  return change_network(arguments, "accept " + arguments.node, [&](ProjectFolder&, NetworkProject& project) {
    return with_difference(arguments, project, [&](const std::vector<AcceptedValue>& values) {
      const auto done = accept_values(project, values);
      return done ? project_code::done : project_failed(project_code::refused, done.error());
    });
  });
}

}  // namespace canopus::cli
