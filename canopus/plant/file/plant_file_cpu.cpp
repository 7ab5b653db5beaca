// The CPU of a PLC in a plant file: its type, and how many points its devices have.

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/plc/cpu/device_points.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

namespace {

std::vector<std::string_view> family_names() {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < plc::family_count; ++i) {
    names.push_back(plc::family_info(static_cast<plc::CpuFamily>(i)).name);
  }
  return names;
}

std::string expected_one_of(std::span<const std::string_view> names) {
  std::string text = "expected one of";
  for (const std::string_view& name : names)
    text += fmt::format("{} \"{}\"", &name == &names.front() ? "" : ",", name);
  return text;
}

}  // namespace

void read_place(text::TableReader& table, const plc::CpuModel& cpu, ModuleSection& module) {
  const plc::FamilyInfo& family = plc::family_info(cpu.family);
  const plc::ModulePlace& place = family.place;
  const CatalogueEntry* entry = find_module(module.model);
  const bool fits =
      entry != nullptr && std::ranges::find(entry->families, cpu.family) != entry->families.end();
  const std::uint16_t only_place = fits ? entry->only_place : std::uint16_t{0};
  const std::int64_t number = table.integer(place.key, place.first, place.last, place.words)
                                  .value_or(only_place != 0 ? only_place : place.first);
  if (number % place.step != 0) table.error(place.key, place.words);
  if (only_place != 0 && number != only_place) {
    table.error(place.key, fmt::format("the {} fits into {} {} alone", module.model, place.key, only_place));
  }
  module.head = static_cast<std::uint16_t>(family.modules_have_points ? number : 16 * number);
  if (table.is_wrong(place.key)) module.usable = false;
  if (entry == nullptr || fits) return;
  std::string families;
  for (const plc::CpuFamily each : entry->families) {
    table.find(plc::family_info(each).place.key);  // right with the right family
    families += fmt::format("{}\"{}\"", families.empty() ? "" : " or ", plc::family_info(each).name);
  }
  table.error("model",
              fmt::format("its [[plc]] needs family = {}; this one has \"{}\"", families, family.name));
}

plc::CpuModel read_cpu_model(text::TableReader& table) {
  plc::CpuModel model = plc::r04cpu();
  std::optional<plc::CpuFamily> family;
  if (const auto name = table.text("family")) {
    family = plc::family_named(*name);
    if (family) model = plc::default_model(*family);
    if (!family) table.error("family", expected_one_of(family_names()));
  }
  if (const auto name = table.text("cpu_model")) {
    const plc::CpuModel* known = plc::cpu_model_named(*name);
    if (known == nullptr) {
      table.error("cpu_model", expected_one_of(plc::cpu_model_names()));
    } else if (family && known->family != *family) {
      table.error("cpu_model",
                  fmt::format("is a CPU of the family {}, and family says {}",
                              plc::family_info(known->family).name, plc::family_info(*family).name));
    } else {
      model = *known;
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
