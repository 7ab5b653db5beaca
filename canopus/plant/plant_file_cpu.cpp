// The CPU of a PLC in a plant file: its type, and how many points its devices have.

#include "canopus/plant/plant_sections.hpp"
#include "canopus/plc/cpu/device_points.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

plc::CpuModel read_cpu_model(text::TableReader& table) {
  plc::CpuModel model = plc::r04cpu();
  if (const auto name = table.text("cpu_model")) {
    if (const plc::CpuModel* known = plc::cpu_model_named(*name)) {
      model = *known;
    } else {
      table.error("cpu_model", "expected \"R04CPU\" or \"Q03UDVCPU\"");
    }
  }
  const bool is_known = !table.is_wrong("cpu_model");  // otherwise the limits are not
  const auto set = [&](std::string_view device, const toml::node& node, text::Place place) {
    const auto wrong = [&](std::string_view expected) {
      table.error(place, fmt::format("devices: {} = {}: {}", device, text::describe_found(node), expected));
    };
    const auto* points = node.as_integer();
    if (points == nullptr) return wrong("expected a number of points");
    if (!is_known && plc::has_settable_points(device)) return;
    if (const auto done = plc::set_device_points(model, device, points->get()); !done) wrong(done.error());
  };
  table.entries("devices", set, "{ D = 20480, M = 16384 }");
  if (const auto fits = plc::check_device_points(model); !fits) {
    table.error(table.place("devices"), fmt::format("devices: {}", fits.error()));
  }
  return model;
}

}  // namespace canopus::plant
