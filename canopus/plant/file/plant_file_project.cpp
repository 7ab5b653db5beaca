// Nodes of a bus that a CiA 306 project lists.

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "canopus/network_project/project_members.hpp"
#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/store/inner_path.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::plant {
namespace {

/// Whether something without a bus of its own is on this one.
bool is_on(const std::string& bus, const BusSection& wanted, const PlantFile& plant) {
  return bus == wanted.name || (bus.empty() && plant.buses.size() == 1);
}

DeviceSection* find_device(PlantFile& plant, const BusSection& bus, std::uint8_t node) {
  const auto found = std::ranges::find_if(plant.devices, [&](const DeviceSection& device) {
    return device.node == node && is_on(device.bus, bus, plant);
  });
  return found == plant.devices.end() ? nullptr : &*found;
}

bool is_module(const PlantFile& plant, const BusSection& bus, std::uint8_t node) {
  return std::ranges::any_of(plant.plcs, [&](const PlcSection& plc) {
    return std::ranges::any_of(plc.modules, [&](const ModuleSection& module) {
      return module.node == node && is_on(module.bus, bus, plant);
    });
  });
}

}  // namespace

void add_projects(PlantFile& plant, std::vector<text::FileError>& errors) {
  const std::filesystem::path folder = std::filesystem::path(plant.path).parent_path();
  const std::size_t own_devices = plant.devices.size();
  for (const BusSection& bus : plant.buses) {
    if (bus.project.empty()) continue;
    const auto list = text::read_file((folder / bus.project).string());
    const auto read_dcf = [&](const std::string& below, const std::string& name) {
      return store::read_inner_file(folder / below, name);
    };
    const auto find_dcf = [&](const std::string& below, const std::string& name) {
      return store::find_inner_file(folder / below, name);
    };
    const network_project::ProjectMembers project =
        network_project::read_members(bus.project, list, bus.project_network - 1, read_dcf, find_dcf);
    for (const std::string& error : project.errors) {
      errors.push_back({bus.project_place, fmt::format("project = \"{}\": {}", bus.project, error)});
    }
    if (project.bit_rate != 0 && bus.bit_rate != 0 && project.bit_rate != bus.bit_rate) {
      errors.push_back(
          {bus.project_place, fmt::format("project = \"{}\": its DCFs say {} kbit/s, bit_rate {} kbit/s",
                                          bus.project, project.bit_rate / 1000, bus.bit_rate / 1000)});
    }
    for (const network_project::ProjectMember& member : project.members) {
      if (DeviceSection* own = find_device(plant, bus, member.node_id); own != nullptr) {
        if (own->eds.empty()) own->eds = member.path;
        if (own->name.empty()) own->name = member.name;
        continue;
      }
      if (member.is_manager || is_module(plant, bus, member.node_id)) continue;
      plant.devices.push_back({.place = bus.project_place,
                               .eds_place = bus.project_place,
                               .store_place = bus.project_place,
                               .bus = bus.name,
                               .name = member.name,
                               .eds = member.path,
                               .node = member.node_id});
    }
  }
  for (std::size_t i = 0; i < own_devices; ++i) {
    DeviceSection& device = plant.devices[i];
    if (!device.eds.empty() || device.lift || device.eds_place != device.place) continue;
    device.usable = false;
    errors.push_back(
        {device.place, "device: eds is missing: the device file, or a node of the bus's project"});
  }
}

}  // namespace canopus::plant
