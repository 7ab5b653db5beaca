#include "canopus/plant/file/plant_references.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"

namespace canopus::plant {
namespace {

constexpr unsigned most_nodes = 127;

/// I/O points of the module in its rack; a module without signals has its head address for itself, too.
unsigned points(const ModuleSection& module) {
  const CatalogueEntry* entry = find_module(module.model);
  return std::max(16U, entry == nullptr ? 0U : entry->data_sheet->points);
}

/// Checks a plant of any size in one pass: every query is a look-up.
class References {
 public:
  References(PlantFile& plant, std::vector<text::FileError>& errors) : plant_(plant), errors_(errors) {}

  void check() {
    check_buses();
    check_bridges();
    for (DeviceSection& device : plant_.devices) {
      settle(device.bus, device.node, device.place, device.lift ? device.name : "device", device.usable);
      if (device.lift) plant_.lifts[device.lift->lift].bus = device.bus;
    }
    check_lifts();
    for (PlcSection& plc : plant_.plcs) check_modules(plc);
    check_names();
    check_masters();
    for (PlcSection& plc : plant_.plcs) {
      for (ModuleSection& module : plc.modules) check_slaves(module);
    }
    for (const DeviceSection& device : plant_.devices) check_behaviours(device);
  }

 private:
  struct Bus {
    std::uint32_t line = 0;
    bool may_have_others = false;  // nodes outside of the plant
    unsigned nodes = 0;
    std::map<unsigned, std::uint32_t> taken{};  // node-ID, line
  };

  template <typename... T>
  void error(text::Place place, fmt::format_string<T...> text, T&&... arguments) {
    errors_.push_back({place, fmt::format(text, std::forward<T>(arguments)...)});
  }

  void check_buses() {
    if (plant_.buses.empty()) error({1, 1}, "the plant has no bus; expected at least one [[bus]]");
    for (const BusSection& bus : plant_.buses) {
      const auto [known, is_new] =
          buses_.try_emplace(bus.name, Bus{.line = bus.place.line, .may_have_others = bus.may_have_others()});
      check_link(bus);
      if (is_new || bus.name.empty()) continue;
      error(bus.place, "bus \"{}\" is there already, in line {}", bus.name, known->second.line);
    }
  }

  /// Two buses of a plant on one real bus are one, and a bridge between them would be a ring.
  void check_link(const BusSection& bus) {
    if (!bus.address) return;
    const auto [other, is_new] = links_.try_emplace(link::describe(*bus.address), bus.link_place.line);
    if (!is_new) {
      error(bus.link_place, "link = \"{}\": the bus in line {} is on it already; put its nodes on one bus",
            bus.link, other->second);
    }
  }

  /// Two ways for a frame between two buses, or a way back to where it came from, would multiply it without end.
  void check_bridges() {
    std::map<std::string, std::string> part;  // of each bus: the first one of those it is connected with
    for (const BusSection& bus : plant_.buses) part[bus.name] = bus.name;
    for (BridgeSection& bridge : plant_.bridges) {
      bridge.usable = check_bridge_end(bridge, bridge.from) && check_bridge_end(bridge, bridge.to);
      if (!bridge.usable) continue;
      const std::string from = part[bridge.from];
      const std::string to = part[bridge.to];
      if (from == to) {
        bridge.usable = false;
        error(bridge.place, "bridge: frames can come from bus \"{}\" to bus \"{}\" already{}", bridge.from,
              bridge.to,
              bridge.from == bridge.to
                  ? "; expected two buses"
                  : "; a second way would repeat them. For both directions: both_ways = true");
        continue;
      }
      for (auto& [bus, name] : part) name = name == to ? from : name;
    }
  }

  bool check_bridge_end(const BridgeSection& bridge, const std::string& bus) {
    if (bus.empty()) return false;
    const auto found = buses_.find(bus);
    if (found == buses_.end()) {
      error(bridge.place, "bridge: there is no bus \"{}\"; expected one of {}", bus, bus_names());
      return false;
    }
    found->second.may_have_others = true;
    std::ranges::find(plant_.buses, bus, &BusSection::name)->is_bridged = true;
    return true;
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
  void settle(std::string& bus, unsigned node, text::Place place, std::string_view what, bool& usable) {
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
    if (on.nodes > most_nodes + 1) return;  // reported once
    error(place, "{}: bus \"{}\" has {} nodes already, as many as there are node-IDs", what, bus, most_nodes);
  }

  void check_lifts() {
    std::map<std::pair<std::string_view, unsigned>, std::uint32_t> lines;
    for (const LiftSection& lift : plant_.lifts) {
      for (const std::uint8_t number : lift.building.lifts) {
        const auto [other, is_free] = lines.try_emplace({lift.bus, number}, lift.place.line);
        if (is_free) continue;
        error(lift.place, "lift: bus \"{}\" has a lift {} already, in line {}", lift.bus, number,
              other->second);
      }
    }
  }

  void check_modules(PlcSection& plc) {
    std::map<unsigned, const ModuleSection*> by_head;  // those that do not overlap
    for (ModuleSection& module : plc.modules) {
      settle(module.bus, module.node, module.place, "module", module.usable);
      place_in_rack(module, by_head);
      if (!module.master && (module.all_slaves || !module.slaves.empty())) {
        error(module.place, "slaves need master = true");
      }
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

  /// A device or module that a slave may be.
  struct Member {
    const std::string* bus;
    std::uint8_t node;
    const ModuleSection* module;  // nullptr: a device
    text::Place place;
  };

  void check_names() {
    for (const DeviceSection& device : plant_.devices) {
      by_node_.try_emplace({device.bus, device.node},
                           Member{&device.bus, device.node, nullptr, device.place});
      if (device.name.empty()) continue;
      by_name_[device.name].push_back({&device.bus, device.node, nullptr, device.place});
    }
    for (const PlcSection& plc : plant_.plcs) {
      for (const ModuleSection& module : plc.modules) {
        const Member member{&module.bus, module.node, &module, module.place};
        if (module.node != 0) by_node_.try_emplace({module.bus, module.node}, member);
        if (module.name.empty()) continue;
        std::vector<Member>& same = by_name_[module.name];
        if (!same.empty()) {
          error(module.name_place, "name = \"{}\": a {} has this name already, in line {}", module.name,
                same.front().module == nullptr ? "device" : "module", same.front().place.line);
        }
        same.push_back(member);
      }
    }
  }

  /// 1F80H with bit 5, in the module's objects [CiA 302-2].
  static bool is_flying_master(const ModuleSection& module) {
    return std::ranges::any_of(module.objects, [](const text::ObjectSetting& setting) {
      const auto* value = std::get_if<std::int64_t>(&setting.value);
      return setting.object == text::ObjectName{0x1F80, 0} && value != nullptr && (*value & 0x20) != 0;
    });
  }

  void check_masters() {
    std::map<std::string, const ModuleSection*> masters;
    for (const PlcSection& plc : plant_.plcs) {
      for (const ModuleSection& module : plc.modules) {
        if (!module.master) continue;
        const auto [other, is_first] = masters.try_emplace(module.bus, &module);
        if (is_first || (is_flying_master(module) && is_flying_master(*other->second))) continue;
        error(module.place,
              "master = true: bus \"{}\" has an NMT master already, in line {}; expected one, or flying "
              "masters: objects = {{ \"1F80:00\" = 0x21 }} for each",
              module.bus, other->second->place.line);
      }
    }
  }

  void check_slaves(ModuleSection& module) {
    const auto bus = buses_.find(module.bus);
    std::set<std::pair<unsigned, std::string>> assigned;
    for (SlaveSection& slave : module.slaves) {
      const std::size_t before = errors_.size();
      if (bus != buses_.end()) {
        if (slave.name.empty()) {
          check_slave_node(slave, module, bus->second);
        } else {
          check_slave_name(slave, module);
        }
      }
      slave.usable = errors_.size() == before;
      if (slave.usable && !assigned.emplace(slave.node, slave.node == 0 ? slave.name : "").second) {
        slave.usable = false;
        error(slave.place, "slave: node {} is assigned already, in another [[plc.module.slave]]", slave.node);
      }
    }
  }

  void check_behaviours(const DeviceSection& device) {
    std::map<std::pair<unsigned, unsigned>, std::uint32_t> moved;  // object, line
    for (const BehaviourSection& behaviour : device.behaviours) {
      const auto [index, sub] = behaviour.object;
      const auto [other, is_new] = moved.try_emplace({index, sub}, behaviour.place.line);
      if (is_new) continue;
      error(behaviour.place, "behaviour: {} moves already, by the one in line {}",
            canopen::object_text(index, sub), other->second);
    }
  }

  void check_slave_name(SlaveSection& slave, const ModuleSection& master) {
    const auto found = by_name_.find(slave.name);
    if (found == by_name_.end()) {
      return error(slave.place, "slave: name = \"{}\": there is no device or module of this name{}",
                   slave.name, names_of(master.bus));
    }
    const std::vector<Member>& named = found->second;
    if (named.size() > 1) {
      return error(slave.place,
                   "slave: name = \"{}\": there are more of this name, in lines {} and {}; expected node = a "
                   "node-ID",
                   slave.name, named[0].place.line, named[1].place.line);
    }
    const Member& member = named.front();
    if (*member.bus != master.bus) {
      return error(slave.place, "slave: \"{}\" (line {}) is on bus \"{}\"; expected a node of bus \"{}\"",
                   slave.name, member.place.line, *member.bus, master.bus);
    }
    if (member.node == no_node_id || (member.module != nullptr && member.node == 0)) {
      return error(slave.place,
                   "slave: \"{}\" (line {}) has no node-ID in the plant file; expected node = {}", slave.name,
                   member.place.line,
                   member.module == nullptr ? "the node-ID that LSS will give it" : "1 to 127 there");
    }
    slave.node = member.node;
    check_member(slave, master, member);
  }

  void check_slave_node(const SlaveSection& slave, const ModuleSection& master, const Bus& bus) {
    const auto member = by_node_.find({master.bus, slave.node});
    if (member != by_node_.end()) return check_member(slave, master, member->second);
    if (slave.node == master.node)
      return error(slave.place, "slave: node {} is the module itself", slave.node);
    if (may_appear(master.bus) || bus.may_have_others) return;
    error(slave.place,
          "slave: there is no device or module with node = {} on bus \"{}\"; for an external node "
          "the bus needs serve or link",
          slave.node, master.bus);
  }

  void check_member(const SlaveSection& slave, const ModuleSection& master, const Member& member) {
    if (member.module == &master) {
      return error(slave.place, "slave: node {} is the module itself; expected another node", slave.node);
    }
    if (!slave.eds.empty()) {
      error(slave.eds_place, "slave: eds is for an external node; node {} is in the plant file, in line {}",
            slave.node, member.place.line);
    }
    if (member.module == nullptr || !member.module->master) return;
    if (is_flying_master(*member.module) && is_flying_master(master)) return;
    error(slave.place, "slave: the module with node {} (line {}) has master = true; expected a slave",
          slave.node, member.place.line);
  }

  /// A device may get this node-ID from its file, or by LSS.
  [[nodiscard]] bool may_appear(const std::string& bus) const {
    return by_node_.contains({bus, 0}) || by_node_.contains({bus, no_node_id});
  }

  /// "; expected one of encoder, rack2": the names on this bus, or the first of them.
  [[nodiscard]] std::string names_of(const std::string& bus) const {
    constexpr std::size_t enough = 8;
    std::string names;
    std::size_t count = 0;
    for (const auto& [name, members] : by_name_) {
      if (*members.front().bus != bus) continue;
      if (++count > enough) return names + ", ...";
      names += (count == 1 ? "; expected one of " : ", ") + name;
    }
    return names;
  }

  PlantFile& plant_;
  std::vector<text::FileError>& errors_;
  std::map<std::string, Bus> buses_;
  std::map<std::string, std::uint32_t> links_;                  // addresses of real buses, and their lines
  std::map<std::pair<std::string, unsigned>, Member> by_node_;  // bus and node-ID
  std::map<std::string, std::vector<Member>> by_name_;
};

}  // namespace

void check_references(PlantFile& plant, std::vector<text::FileError>& errors) {
  References(plant, errors).check();
  check_servers(plant, errors);
}

}  // namespace canopus::plant
