#include "canopus/web/state/program_views.hpp"

#include <optional>
#include <utility>

#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/serve/program_view.hpp"
#include "canopus/web/state/view_fields.hpp"

namespace canopus::web {
namespace {

constexpr std::size_t last_line = 10'000'000;

std::optional<std::size_t> plc_of(plant::Plant& plant, const std::string& name) {
  for (std::size_t i = 0; i < plant.plc_count(); ++i)
    if (plant.program(i) != nullptr && plant.plc_section(i).name == name) return i;
  return std::nullopt;
}

void add(text::Json& event, const text::Json& fields) {
  for (const auto& [key, value] : fields.items()) event[key] = value;
}

}  // namespace

std::string program_event(plant::Plant& plant, const text::Json& wish) {
  const auto plc = plc_of(plant, wish.value("program", ""));
  if (!plc) return {};
  text::Json event = plant::event_line(plant.timeline().now(), "program");
  add(event, serve::program_status(plant, *plc));
  add(event, serve::program_lines(plant, *plc, view_number(wish, "file", SIZE_MAX),
                                  static_cast<std::uint32_t>(view_number(wish, "from", last_line)),
                                  static_cast<std::uint32_t>(view_number(wish, "count", last_line)),
                                  wish.value("block", "")));
  return view_event(event);
}

std::string variables_event(plant::Plant& plant, const text::Json& wish) {
  const std::string name = wish.value("variables", "");
  const auto plc = plc_of(plant, name);
  if (!plc) return {};
  text::Json event = plant::event_line(plant.timeline().now(), "variables");
  event["plc"] = name;
  add(event,
      serve::program_variables(plant, *plc, wish.value("find", ""), view_number(wish, "from", SIZE_MAX),
                               view_number(wish, "count", serve::most_variables)));
  return view_event(event);
}

text::Json programs_of(plant::Plant& plant) {
  text::Json list = text::Json::array();
  for (std::size_t i = 0; i < plant.plc_count(); ++i) {
    if (plant.program(i) == nullptr) continue;
    text::Json one{{"plc", plant.plc_section(i).name}, {"state", serve::program_state(plant, i)}};
    if (const auto& error = plant.program(i)->error()) one["error"] = serve::shown_file(plant, error->text);
    list.push_back(std::move(one));
  }
  return list;
}

}  // namespace canopus::web
