#include "canopus/app/plant_references.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "canopus/app/module_catalogue.hpp"

namespace canopus::app {
namespace {

constexpr std::uint8_t no_node_id = 0xFF;
constexpr unsigned most_nodes = 127;

/// I/O points of the module in its rack; a module without signals has its head address for itself, too.
unsigned points(const ModuleSection& module) {
  const CatalogueEntry* entry = find_module(module.model);
  return std::max(16U, entry == nullptr ? 0U : entry->data_sheet->points);
}

/// Looks at a plant in one pass, whatever its size: every question is a look-up.
class References {
 public:
  References(PlantFile& plant, std::vector<PlantError>& errors) : plant_(plant), errors_(errors) {}

  void check() {
    check_buses();
    for (DeviceSection& device : plant_.devices) {
      settle(device.bus, device.node, device.place, "device", device.usable);
    }
    for (PlcSection& plc : plant_.plcs) check_modules(plc);
  }

 private:
  template <typename... T>
  void error(Place place, fmt::format_string<T...> text, T&&... arguments) {
    errors_.push_back({place, fmt::format(text, std::forward<T>(arguments)...)});
  }

  void check_buses() {
    if (plant_.buses.empty()) error({1, 1}, "the plant has no bus; expected at least one [[bus]]");
    for (const BusSection& bus : plant_.buses) {
      const auto [known, is_new] = buses_.try_emplace(bus.name, Bus{.line = bus.place.line});
      if (is_new || bus.name.empty()) continue;
      error(bus.place, "bus \"{}\" is there already, in line {}", bus.name, known->second.line);
    }
  }

  /// The names, or the first of them.
  [[nodiscard]] std::string bus_names() const {
    constexpr std::size_t enough = 8;
    std::string names;
    for (std::size_t i = 0; i < plant_.buses.size() && i < enough; ++i) {
      names += (i == 0 ? "" : ", ") + plant_.buses[i].name;
    }
    return plant_.buses.size() > enough ? names + ", ..." : names;
  }

  /// Names the bus, and takes the node-ID on it.
  void settle(std::string& bus, unsigned node, Place place, std::string_view what, bool& usable) {
    if (bus.empty() && plant_.buses.size() == 1) bus = plant_.buses.front().name;
    const auto found = buses_.find(bus);
    if (found == buses_.end()) {
      usable = false;
      if (bus.empty()) return error(place, "{}: bus is missing; expected one of {}", what, bus_names());
      return error(place, "{}: there is no bus \"{}\"; expected one of {}", what, bus, bus_names());
    }
    Bus& on = found->second;
    if (node != 0 && node != no_node_id) {
      const auto [other, is_free] = on.taken.try_emplace(node, place.line);
      if (!is_free) {
        usable = false;
        return error(place, "{}: node {} of bus \"{}\" is taken already, in line {}", what, node, bus,
                     other->second);
      }
    }
    if (++on.nodes <= most_nodes) return;
    usable = false;
    if (on.nodes > most_nodes + 1) return;  // said once
    error(place, "{}: bus \"{}\" has {} nodes already, as many as there are node-IDs", what, bus, most_nodes);
  }

  void check_modules(PlcSection& plc) {
    std::map<unsigned, const ModuleSection*> by_head;  // those that do not overlap
    for (ModuleSection& module : plc.modules) {
      settle(module.bus, module.node, module.place, "module", module.usable);
      place_in_rack(module, by_head);
      if (!module.master && (module.all_slaves || !module.slaves.empty())) {
        error(module.place, "slaves need master = true");
      }
      check_slaves(module);
    }
  }

  void place_in_rack(ModuleSection& module, std::map<unsigned, const ModuleSection*>& by_head) {
    const unsigned end = module.head + points(module);
    auto next = by_head.lower_bound(module.head);
    const ModuleSection* other = next != by_head.end() && next->first < end ? next->second : nullptr;
    if (other == nullptr && next != by_head.begin()) {
      const ModuleSection* before = std::prev(next)->second;
      if (before->head + points(*before) > module.head) other = before;
    }
    if (other == nullptr) {
      by_head.emplace(module.head, &module);
      return;
    }
    error(module.place, "the module at head {:03X}H overlaps the one in line {}", module.head,
          other->place.line);
    module.usable = false;
  }

  void check_slaves(const ModuleSection& module) {
    const auto bus = buses_.find(module.bus);
    std::set<unsigned> assigned;
    for (const SlaveSection& slave : module.slaves) {
      if (!assigned.insert(slave.node).second) {
        error(slave.place, "slave: node {} is assigned already, in another [[plc.module.slave]]", slave.node);
      }
      if (bus == buses_.end() || is_device(module.bus, slave.node)) continue;
      error(slave.place, "slave: there is no device with node = {} on bus \"{}\"", slave.node, module.bus);
    }
  }

  /// A device has this node-ID, or may get it from its file.
  bool is_device(const std::string& bus, unsigned node) {
    if (device_nodes_.empty()) {
      for (const DeviceSection& device : plant_.devices) device_nodes_.emplace(device.bus, device.node);
    }
    return device_nodes_.contains({bus, node}) || device_nodes_.contains({bus, 0});
  }

  struct Bus {
    std::uint32_t line = 0;
    unsigned nodes = 0;
    std::map<unsigned, std::uint32_t> taken{};  // node-ID, line
  };
  PlantFile& plant_;
  std::vector<PlantError>& errors_;
  std::map<std::string, Bus> buses_;
  std::set<std::pair<std::string, unsigned>> device_nodes_;
};

}  // namespace

void check_references(PlantFile& plant, std::vector<PlantError>& errors) {
  References(plant, errors).check();
}

}  // namespace canopus::app
