#include "canopus/web/commands/faults.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/plant/file/fault_text.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::web {

WebFaults::WebFaults(plant::Plant& plant, link::LoopClock& clock) : plant_(plant), clock_(clock) {
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    auto& rules = rules_.emplace_back();
    seeds_.push_back(plant.file().seed);
    if (plant.simulated_bus(i) == nullptr) continue;
    for (const plant::FaultSection& section : plant.bus_section(i).faults) {
      rules.push_back({.section = section, .is_on = true, .is_of_file = true});
    }
  }
}

WebFaults::Json WebFaults::list() const {
  Json row{{"buses", Json::array()}};
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    const sim::Bus* const bus = plant_.simulated_bus(i);
    if (bus == nullptr) continue;
    Json one{{"bus", bus->name()}, {"seed", seeds_[i]}, {"ports", Json::array()}, {"faults", Json::array()}};
    for (const plant::NodeStatus& node : plant_.nodes()) {
      if (node.label.bus == bus->name()) one["ports"].push_back(node.label.name);
    }
    const auto states = bus->fault_states();
    std::size_t place = 0;  // among those that are on
    for (const Rule& rule : rules_[i]) {
      Json fault{{"text", rule.section.text}, {"on", rule.is_on}, {"from_file", rule.is_of_file}};
      if (rule.is_on && place < states.size()) {
        fault["hits"] = states[place].hits;
        fault["active"] = states[place++].is_active;
      }
      one["faults"].push_back(std::move(fault));
    }
    row["buses"].push_back(std::move(one));
  }
  return row;
}

std::expected<WebFaults::Json, std::string> WebFaults::run(const text::Json& wish) {
  const auto text_of = [](const text::Json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  const std::string name = text_of(wish, "bus");
  std::size_t number = 0;
  while (number < rules_.size() && plant_.bus(number).name() != name) ++number;
  sim::Bus* const bus = number < rules_.size() ? plant_.simulated_bus(number) : nullptr;
  if (bus == nullptr) {
    return std::unexpected(fmt::format("there is no simulated bus \"{}\": faults are for simulated buses",
                                       text::printable(name)));
  }
  const auto list = wish.find("faults");
  if (list == wish.end() || !list->is_array() || list->size() > most_faults) {
    return std::unexpected(fmt::format("\"faults\" is to be a list of up to {} faults", most_faults));
  }
  std::uint64_t seed = seeds_[number];
  if (const auto said = wish.find("seed"); said != wish.end()) {
    if (!said->is_number_unsigned()) return std::unexpected("\"seed\" is to be a number from 0 on");
    seed = said->get<std::uint64_t>();
  }
  std::vector<Rule> rules;
  std::vector<sim::Fault> faults;
  for (const text::Json& one : *list) {
    const std::string text = one.is_object() ? text_of(one, "text") : std::string();
    const auto wrong = [&](const std::string& what) {
      return std::unexpected(fmt::format("fault {}: {}", rules.size() + 1, what));
    };
    if (text.empty() || text.size() > longest_fault)
      return wrong("expected its text, for example kind = \"drop\"");
    auto section = plant::read_fault(text);
    if (!section) return wrong(section.error());
    const bool is_on = !one.contains("on") || one["on"] != false;
    const bool is_of_file =
        std::ranges::any_of(plant_.bus_section(number).faults,
                            [&](const plant::FaultSection& known) { return known.text == section->text; });
    if (is_on) faults.push_back(section->fault);
    rules.push_back({.section = std::move(*section), .is_on = is_on, .is_of_file = is_of_file});
  }
  (void)clock_.now();
  if (const auto set = bus->set_faults(faults, seed); !set) return std::unexpected(set.error());
  clock_.touched();
  rules_[number] = std::move(rules);
  seeds_[number] = seed;
  return this->list();
}

}  // namespace canopus::web
