#include "canopus/web/commands/faults.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/plant/file/fault_text.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/web/commands/wish_fields.hpp"

namespace canopus::web {
WebFaults::WebFaults(plant::Plant& plant, link::LoopClock& clock) : plant_(plant), clock_(clock) {
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    auto& rules = rules_.emplace_back();
    seeds_.push_back(plant.file().seed);
    if (plant.simulated_bus(i) == nullptr) continue;
    for (const plant::FaultSection& section : plant.bus_section(i).faults) {
      rules.push_back({.section = section, .is_on = true, .is_of_file = true, .number = rules.size()});
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
    for (const Rule& rule : rules_[i]) {
      Json fault{{"text", rule.section.text}, {"on", rule.is_on}, {"from_file", rule.is_of_file}};
      if (rule.is_on && rule.number < states.size()) {
        fault["hits"] = states[rule.number].hits;
        fault["active"] = states[rule.number].is_active;
      }
      one["faults"].push_back(std::move(fault));
    }
    row["buses"].push_back(std::move(one));
  }
  return row;
}

std::expected<std::size_t, std::string> WebFaults::bus_of(const text::Json& wish) const {
  const std::string name = wish.value("bus", "");
  for (std::size_t number = 0; number < rules_.size(); ++number) {
    if (plant_.bus(number).name() == name && plant_.simulated_bus(number) != nullptr) return number;
  }
  return std::unexpected(
      fmt::format("there is no simulated bus \"{}\": faults are for simulated buses", text::printable(name)));
}

std::expected<WebFaults::Json, std::string> WebFaults::run(const text::Json& wish) {
  const auto found = bus_of(wish);
  if (!found) return std::unexpected(found.error());
  const std::size_t number = *found;
  const auto list = wish.find("faults");
  if (list == wish.end() || !list->is_array() || list->size() > most_faults) {
    return std::unexpected(fmt::format("\"faults\" is to be a list of up to {} faults", most_faults));
  }
  std::uint64_t seed = seeds_[number];
  if (const auto given = wish.find("seed"); given != wish.end()) {
    if (!given->is_number_unsigned()) return std::unexpected("\"seed\" is to be a number from 0 on");
    seed = given->get<std::uint64_t>();
  }
  std::vector<Rule> rules;
  std::vector<sim::Fault> faults;
  for (const text::Json& one : *list) {
    const std::string text = one.value("text", "");
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
    const std::size_t place = faults.size();
    if (is_on) faults.push_back(section->fault);
    rules.push_back(
        {.section = std::move(*section), .is_on = is_on, .is_of_file = is_of_file, .number = place});
  }
  (void)clock_.now();
  if (const auto set = plant_.simulated_bus(number)->set_faults(faults, seed); !set)
    return std::unexpected(set.error());
  clock_.touched();
  rules_[number] = std::move(rules);
  seeds_[number] = seed;
  return this->list();
}

std::expected<WebFaults::Json, std::string> WebFaults::end(const text::Json& wish) {
  const auto bus = bus_of(wish);
  if (!bus) return std::unexpected(bus.error());
  std::vector<Rule>& rules = rules_[*bus];
  if (rules.empty()) return std::unexpected("there is no fault");
  const auto number = number_field(wish, "number", 0, rules.size() - 1);
  if (!number) {
    return std::unexpected(
        fmt::format("number: expected that of a fault of the list, 0 to {}", rules.size() - 1));
  }
  const auto rule = rules.begin() + static_cast<std::ptrdiff_t>(*number);
  (void)clock_.now();
  if (rule->is_on && !plant_.simulated_bus(*bus)->end_fault(rule->number))
    return std::unexpected("raw levels that no frame begins do not end by themselves: run the others anew");
  clock_.touched();
  rules.erase(rule);
  return list();
}

}  // namespace canopus::web
