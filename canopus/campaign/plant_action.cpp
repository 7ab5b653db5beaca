#include "canopus/campaign/plant_action.hpp"

#include <chrono>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "canopus/campaign/plant_access.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::campaign {
namespace {

using Result = std::expected<void, std::string>;

/// When it begins, and when it ends.
struct Span {
  can::Time begin{};
  std::optional<can::Time> end{};
};

Span read_span(text::TableReader& table) {
  Span span{.begin = can::Time{} + table.parsed("at", text::parse_duration, true).value_or(can::Duration{})};
  if (const auto length = table.parsed("for", text::parse_duration))
    span.end = can::later(span.begin, *length);
  return span;
}

module::CpuState state_of(const plant::Plant& plant, std::size_t plc) {
  return plant.plc_section(plc).run ? module::CpuState::run : module::CpuState::stop;
}

Result cut_power(const ChosenRule& chosen, const Span& span, plant::Plant& plant,
                 std::vector<PlantAction>& actions) {
  const Target& target = chosen.rule->target;
  if (!target.device.empty()) {
    const FoundNumber device = find_device(plant, target.device);
    if (!device) return std::unexpected(device.error());
    actions.push_back(
        {span.begin, [number = *device](plant::Plant& of, can::Time) { of.device(number).unplug(); }});
    if (span.end) {
      actions.push_back({*span.end, [number = *device](plant::Plant& of, can::Time now) {
                           of.device(number).plug_in(now);
                         }});
    }
    return {};
  }
  const FoundNumber plc = find_plc(plant, target.plc);
  if (!plc) return std::unexpected(plc.error());
  actions.push_back(
      {span.begin, [number = *plc](plant::Plant& of, can::Time now) { of.rack(number).power_off(now); }});
  if (span.end) {
    actions.push_back({*span.end, [number = *plc](plant::Plant& of, can::Time now) {
                         of.rack(number).power_on(now, state_of(of, number));
                       }});
  }
  return {};
}

Result stop_cpu(const ChosenRule& chosen, const Span& span, plant::Plant& plant,
                std::vector<PlantAction>& actions) {
  const FoundNumber plc = find_plc(plant, chosen.rule->target.plc);
  if (!plc) return std::unexpected(plc.error());
  const auto set = [number = *plc](module::CpuState state) {
    return [number, state](plant::Plant& of, can::Time now) { of.rack(number).set_cpu_state(state, now); };
  };
  actions.push_back({span.begin, set(module::CpuState::stop)});
  if (span.end) actions.push_back({*span.end, set(module::CpuState::run)});
  return {};
}

Result write_variable(std::size_t plc, const std::string& variable, const std::string& value, can::Time at,
                      plant::Plant& plant, std::vector<PlantAction>& actions) {
  if (plant.program(plc) == nullptr) return std::unexpected("variable: the PLC has no program");
  program::Machine& machine = plant.program(plc)->machine();
  const auto before = machine.read(variable);
  if (!before) return std::unexpected("variable: " + before.error());
  const auto written = machine.write(variable, value);
  if (!written) return std::unexpected("value: " + written.error());
  if (const auto restored = machine.write(variable, *before); !restored) machine.cold_start();
  actions.push_back({at, [plc, variable, value](plant::Plant& of, can::Time) {
                       (void)of.program(plc)->machine().write(variable, value);
                     }});
  return {};
}

Result write_at(std::size_t plc, const std::string& word, std::int64_t value, can::Time at,
                plant::Plant& plant, std::vector<PlantAction>& actions) {
  const auto address = find_word(plant.rack(plc), word);
  if (!address) return std::unexpected(address.error());
  if (value < -32768 || value > 65535) return std::unexpected("value: expected -32768 to 65535");
  actions.push_back({at, [plc, address = *address, value](plant::Plant& of, can::Time now) {
                       write_word(of.rack(plc), address, static_cast<std::uint16_t>(value), now);
                     }});
  return {};
}

Result write(const ChosenRule& chosen, text::TableReader& table, plant::Plant& plant,
             std::vector<PlantAction>& actions) {
  const can::Time at = can::Time{} + table.parsed("at", text::parse_duration, true).value_or(can::Duration{});
  const auto word = table.text("word");
  const auto variable = table.text("variable");
  const toml::node* const value = table.find("value");
  if (word.has_value() == variable.has_value())
    return std::unexpected("expected word or variable, one of them");
  if (value == nullptr) return std::unexpected("value is missing");
  const FoundNumber plc = find_plc(plant, chosen.rule->target.plc);
  if (!plc) return std::unexpected(plc.error());
  if (variable) {
    const std::string text = value->is_string() ? value->as_string()->get() : text::describe_found(*value);
    return write_variable(*plc, *variable, text, at, plant, actions);
  }
  const auto number = value->is_boolean() ? std::optional<std::int64_t>(value->as_boolean()->get() ? 1 : 0)
                                          : value->value_exact<std::int64_t>();
  if (!number) return std::unexpected("value: expected a whole number, true or false");
  return write_at(*plc, *word, *number, at, plant, actions);
}

}  // namespace

Result add_actions(const ChosenRule& chosen, plant::Plant& plant, std::vector<PlantAction>& actions) {
  const RuleKind kind = chosen.rule->kind;
  if (kind != RuleKind::power_cut && kind != RuleKind::cpu_stop && kind != RuleKind::write) return {};
  std::vector<text::FileError> errors;
  text::TableReader table(chosen.values, std::string(key_of(kind)), errors);
  Result result;
  if (kind == RuleKind::write) {
    result = write(chosen, table, plant, actions);
  } else {
    const Span span = read_span(table);
    result = kind == RuleKind::power_cut ? cut_power(chosen, span, plant, actions)
                                         : stop_cpu(chosen, span, plant, actions);
  }
  table.finish();
  if (!errors.empty()) return std::unexpected(errors.front().message);
  return result;
}

}  // namespace canopus::campaign
