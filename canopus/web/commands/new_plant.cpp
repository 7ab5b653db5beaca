#include "canopus/web/commands/new_plant.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/words.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/new_plant.hpp"
#include "canopus/text/bit_rate.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::web {
namespace {

using text::Json;

constexpr std::uint8_t module_node = 1;
constexpr std::uint8_t last_node = 127;
constexpr std::size_t longest_name = 100;

/// The name of a file in the plant's folder, by that which the page's file has; `node` makes it another one than those before.
std::string file_name(const std::string& name, std::uint8_t node) {
  std::string shown;
  for (const char c : name)
    shown += ascii::is_letter(c) || ascii::is_digit(c) || std::string_view("._-").contains(c) ? c : '_';
  return fmt::format("node-{}-{}", node, shown);
}

std::expected<NewDevice, std::string> parse_device(const Json& one) {
  constexpr std::array<std::string_view, 4> endings{".eds", ".dcf", ".xdd", ".xdc"};
  const auto file = one.is_object() ? one.find("file") : one.end();
  if (!one.is_object() || file == one.end() || !file->is_object() || file->value("text", "").empty())
    return std::unexpected("expected \"file\" with its name and its text");
  NewDevice device{
      .file = file->value("name", ""), .text = file->value("text", ""), .name = one.value("name", "")};
  const std::string lower = ascii::lower(device.file);
  const bool has_ending =
      std::ranges::any_of(endings, [&](std::string_view ending) { return lower.ends_with(ending); });
  if (!has_ending || device.file.size() > longest_name)
    return std::unexpected("\"file\": expected a name that ends with .eds, .dcf, .xdd or .xdc");
  if (device.name.size() > longest_name || device.name != text::printable(device.name))
    return std::unexpected("\"name\": expected up to 100 characters");
  if (const auto node = one.find("node_id"); node != one.end()) {
    if (!node->is_number_unsigned() || node->get<std::uint64_t>() < 1 ||
        node->get<std::uint64_t>() > last_node)
      return std::unexpected("\"node_id\": expected 1 to 127");
    device.node = node->get<std::uint8_t>();
  }
  return device;
}

/// Devices without a node-ID get one. The error: two have the same.
std::expected<void, std::string> number_devices(std::vector<NewDevice>& devices, bool has_module) {
  std::array<bool, last_node + 1> taken{};
  taken[0] = true;
  taken[module_node] = has_module;
  for (const NewDevice& device : devices) {
    if (device.node == 0) continue;
    if (std::exchange(taken[device.node], true))
      return std::unexpected(
          fmt::format("node-ID {}: two nodes have it{}", device.node,
                      has_module && device.node == module_node ? ", the module is one of them" : ""));
  }
  for (NewDevice& device : devices) {
    if (device.node != 0) continue;
    const auto free = std::find(taken.begin(), taken.end(), false);
    if (free == taken.end()) return std::unexpected("there is no free node-ID for all devices");
    *free = true;
    device.node = static_cast<std::uint8_t>(free - taken.begin());
  }
  for (NewDevice& device : devices) device.file = file_name(device.file, device.node);
  return {};
}

}  // namespace

std::vector<std::string> module_models() {
  std::vector<std::string> models;
  for (const plant::CatalogueEntry& entry : plant::module_catalogue())
    models.emplace_back(entry.data_sheet->model);
  return models;
}

std::expected<NewPlant, std::string> NewPlant::parse(const Json& wish, bool has_module) {
  NewPlant made;
  if (has_module) {
    made.model = wish.value("model", "");
    const auto models = module_models();
    if (std::ranges::find(models, made.model) == models.end())
      return std::unexpected(fmt::format("model: expected one of {}", fmt::join(models, ", ")));
  }
  if (wish.contains("bit_rate")) {
    const auto bit_rate = text::parse_bit_rate(wish.value("bit_rate", ""));
    if (!bit_rate) return std::unexpected("bit_rate: " + bit_rate.error());
    made.bit_rate = *bit_rate;
  }
  const auto devices = wish.find("devices");
  if (devices == wish.end()) return made;
  if (!devices->is_array() || devices->size() > most_devices)
    return std::unexpected(fmt::format("devices: expected a list of up to {} devices", most_devices));
  for (const Json& one : *devices) {
    auto device = parse_device(one);
    if (!device)
      return std::unexpected(fmt::format("device {}: {}", made.devices.size() + 1, device.error()));
    made.devices.push_back(std::move(*device));
  }
  if (auto numbered = number_devices(made.devices, has_module); !numbered)
    return std::unexpected(numbered.error());
  return made;
}

std::expected<std::string, std::string> NewPlant::plant_text(std::string_view name) const {
  plant::NewPlant made{.name = text::printable(name),
                       .module = plant::find_module(model),
                       .module_node_id = module_node,
                       .bit_rate = bit_rate};
  for (const NewDevice& device : devices) {
    const eds::ReadResult read = eds::read_device_file(device.text);
    if (read.file == nullptr) {
      return std::unexpected(
          fmt::format("{}:{}: {}", device.file, read.problems[0].line, read.problems[0].message));
    }
    const std::string shown = device.name.empty() ? fmt::format("device {}", device.node) : device.name;
    made.devices.push_back({shown, device.node, device.file, read.file});
  }
  return plant::plant_text(made);
}

}  // namespace canopus::web
