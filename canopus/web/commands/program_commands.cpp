#include "canopus/web/commands/program_commands.hpp"

#include <string_view>
#include <utility>

#include "canopus/can/bus.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/serve/control_message.hpp"
#include "canopus/serve/program_control.hpp"

namespace canopus::web {
namespace {

std::expected<text::Json, std::string> carry_out(plant::Plant& plant, link::LoopClock& clock,
                                                 const text::Json& wish, std::string_view request) {
  text::Json fields = text::Json::object();
  for (const auto& [key, value] : wish.items())
    if (key != "command") fields[key] = value;
  (void)clock.now();
  auto result = serve::program_request(plant, serve::ControlFields(fields), request);
  clock.touched();
  return result;
}

/// A real bus that a module of the PLC is on; empty: there is none.
std::string live_bus(plant::Plant& plant, const text::Json& wish) {
  const std::string wanted = wish.value("plc", "");
  for (std::size_t i = 0; i < plant.plc_count(); ++i) {
    const plant::PlcSection& plc = plant.plc_section(i);
    if (plant.program(i) == nullptr || (!wanted.empty() && plc.name != wanted)) continue;
    for (const plant::ModuleSection& module : plc.modules) {
      for (std::size_t bus = 0; bus < plant.bus_count(); ++bus) {
        const plant::BusSection& section = plant.bus_section(bus);
        if (section.is_linked() && section.replay.empty() && plant.bus(bus).name() == module.bus)
          return module.bus;
      }
    }
  }
  return {};
}

}  // namespace

void add_program_commands(std::map<std::string, WebCommands::Own, std::less<>>& own, plant::Plant& plant,
                          link::LoopClock& clock) {
  for (const serve::ProgramRequest& request : serve::program_requests()) {
    if (request.is_read_only) continue;  // those are views
    std::vector<std::string_view> fields(request.fields.begin(), request.fields.end());
    fields.emplace_back("plc");
    own[std::string(request.name)] = {
        .role = request.name == "change program" ? WebRole::configure : WebRole::operate,
        .fields = std::move(fields),
        .run = [&plant, &clock, name = request.name](
                   const text::Json& wish,
                   const WebCommands::Own::Done& done) { done(carry_out(plant, clock, wish, name)); },
        .live_bus = [&plant](const text::Json& wish) { return live_bus(plant, wish); }};
  }
}

}  // namespace canopus::web
