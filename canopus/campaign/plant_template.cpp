#include "canopus/campaign/plant_template.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "canopus/campaign/plant_access.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::campaign {
namespace {

namespace fs = std::filesystem;
using Result = std::expected<void, std::string>;

/// A library that the program has, "lib:canopen": no file.
bool is_library(std::string_view path) { return path.starts_with(plant::ProgramFile::library); }

std::string path_beside(const std::string& file, const std::string& path) {
  return (fs::path(file).parent_path() / path).lexically_normal().string();
}

/// The tables of [[key]] in `table`.
std::vector<toml::table*> tables_in(toml::table& table, std::string_view key) {
  std::vector<toml::table*> found;
  if (toml::array* const array = table[key].as_array()) {
    for (toml::node& node : *array) {
      if (toml::table* const each = node.as_table()) found.push_back(each);
    }
  }
  return found;
}

std::vector<toml::table*> modules_in(toml::table& plant) {
  std::vector<toml::table*> found;
  for (toml::table* const plc : tables_in(plant, "plc")) {
    for (toml::table* const module : tables_in(*plc, "module")) found.push_back(module);
  }
  return found;
}

/// The table with this name; with an empty one, the only table there is.
std::expected<toml::table*, std::string> table_named(const std::vector<toml::table*>& tables,
                                                     std::string_view name, std::string_view what,
                                                     std::string_view other_key = "name") {
  std::vector<toml::table*> found;
  for (toml::table* const table : tables) {
    const bool is_it = (*table)["name"].value_or(std::string_view{}) == name ||
                       (*table)[other_key].value_or(std::string_view{}) == name;
    if (name.empty() || is_it) found.push_back(table);
  }
  if (found.size() == 1) return found.front();
  if (name.empty()) {
    return std::unexpected(fmt::format(
        "{} is missing; the plant file has {} of them, expected the name of one", what, tables.size()));
  }
  if (!found.empty())
    return std::unexpected(fmt::format("{} = \"{}\": the plant file has {} of this name, expected one", what,
                                       name, found.size()));
  std::vector<std::string> names;
  for (const toml::table* const table : tables)
    names.push_back((*table)["name"].value_or((*table)[other_key].value_or(std::string{})));
  return std::unexpected(fmt::format("{} = \"{}\": the plant file has no {} of this name{}", what, name, what,
                                     names_there_are(name, names)));
}

std::expected<toml::table*, std::string> table_of(toml::table& plant, const Target& target) {
  if (!target.device.empty()) return table_named(tables_in(plant, "device"), target.device, "device");
  if (!target.module.empty()) return table_named(modules_in(plant), target.module, "module", "model");
  if (!target.plc.empty()) return table_named(tables_in(plant, "plc"), target.plc, "plc");
  return table_named(tables_in(plant, "bus"), target.bus, "bus");
}

void merge(toml::table& into, const toml::table& from) {
  for (const auto& [key, value] : from) {
    toml::table* const inner = into[key.str()].as_table();
    if (inner != nullptr && value.is_table()) {
      merge(*inner, *value.as_table());
    } else {
      into.insert_or_assign(key.str(), value);
    }
  }
}

void append(toml::table& table, std::string_view key, toml::table element) {
  if (table.get(key) == nullptr) table.insert(key, toml::array{});
  if (toml::array* const array = table[key].as_array()) array->push_back(std::move(element));
}

Result add(toml::table& plant, const ChosenRule& chosen) {
  const Rule& rule = *chosen.rule;
  if (rule.kind != RuleKind::fault && rule.kind != RuleKind::set && rule.kind != RuleKind::script) return {};
  const auto table = table_of(plant, rule.target);
  if (!table) return std::unexpected(table.error());
  if (rule.kind == RuleKind::set) {
    merge(**table, chosen.values);
  } else {
    append(**table, key_of(rule.kind), chosen.values);
  }
  return {};
}

/// Without the device, and what masters of the plant know of it.
void remove_device(toml::table& plant, const std::string& name) {
  toml::array* const devices = plant["device"].as_array();
  if (devices == nullptr) return;
  std::int64_t node_id = 0;
  for (auto place = devices->begin(); place != devices->end(); ++place) {
    const toml::table* const device = place->as_table();
    if (device == nullptr || (*device)["name"].value_or(std::string_view{}) != name) continue;
    node_id = (*device)["node"].value_or(std::int64_t{0});
    devices->erase(place);
    break;
  }
  for (toml::table* const module : modules_in(plant)) {
    toml::array* const slaves = (*module)["slave"].as_array();
    for (std::size_t i = slaves == nullptr ? 0 : slaves->size(); i-- > 0;) {
      const toml::table* const slave = (*slaves)[i].as_table();
      if (slave == nullptr) continue;
      const bool is_it = (*slave)["name"].value_or(std::string_view{}) == name ||
                         (node_id != 0 && (*slave)["node"].value_or(std::int64_t{0}) == node_id);
      if (is_it) slaves->erase(slaves->begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (slaves != nullptr && slaves->empty()) module->erase("slave");
  }
}

/// Runs keep nothing, and leave nothing: every one begins with the plant file.
void remove_stores(toml::table& plant) {
  for (const std::string_view key : {"device", "plc"}) {
    for (toml::table* const table : tables_in(plant, key)) table->erase("store");
  }
}

void change_path(toml::table& table, std::string_view key, const std::function<void(std::string&)>& each) {
  const auto change = [&](toml::node& node) {
    toml::value<std::string>* const text = node.as_string();
    if (text != nullptr && !is_library(text->get())) each(text->get());
  };
  toml::node* const node = table.get(key);
  if (node == nullptr) return;
  change(*node);
  if (toml::array* const array = node->as_array()) {
    for (toml::node& element : *array) change(element);
  }
}

}  // namespace

void each_path(toml::table& plant, const std::function<void(std::string&)>& each) {
  for (toml::table* const bus : tables_in(plant, "bus")) change_path(*bus, "project", each);
  for (toml::table* const device : tables_in(plant, "device")) {
    change_path(*device, "eds", each);
    for (toml::table* const playback : tables_in(*device, "playback")) change_path(*playback, "file", each);
  }
  for (toml::table* const plc : tables_in(plant, "plc")) {
    if (!(*plc)["program"].is_array_of_tables()) change_path(*plc, "program", each);
    change_path(*plc, "labels", each);
  }
  for (toml::table* const module : modules_in(plant)) {
    for (toml::table* const slave : tables_in(*module, "slave")) change_path(*slave, "eds", each);
    if (toml::table* const parameters = (*module)["parameters"].as_table()) {
      for (toml::table* const node : tables_in(*parameters, "node")) change_path(*node, "eds", each);
    }
    if (toml::table* const download = (*module)["download"].as_table()) {
      for (toml::table* const slave : tables_in(*download, "slave")) change_path(*slave, "eds", each);
    }
  }
}

std::string text_of(const toml::table& table) {
  std::ostringstream text;
  text << toml::toml_formatter(table) << '\n';
  return text.str();
}

Result PlantTemplate::apply(toml::table& plant, const Variant& variant, const CampaignFile& campaign) const {
  for (const Change& change : variant.changes) {
    const auto table = table_of(plant, change.target);
    if (!table) return std::unexpected(table.error());
    merge(**table, change.set);
  }
  if (variant.program.empty()) return {};
  const auto plc = table_named(tables_in(plant, "plc"), variant.plc, "plc");
  if (!plc) return std::unexpected(plc.error());
  toml::array files;
  for (const std::string& file : variant.program) {
    files.push_back(
        is_library(file) ? file : fs::absolute(path_beside(campaign.path, file)).lexically_normal().string());
  }
  (*plc)->insert_or_assign("program", std::move(files));
  return {};
}

bool PlantTemplate::load(const CampaignFile& campaign, const Variant& variant, text::Output& err) {
  path_ = path_beside(campaign.path, variant.plant);
  const auto text = text::read_file(path_);
  if (!text) {
    err.line("{}", text::describe(text::FileError{variant.place, text.error()}, campaign.path));
    return false;
  }
  class : public plant::PlantObserver {
  } no_observer;
  plant::PlantUse use{.text = *text};
  if (auto plant = plant::load_plant(path_, no_observer, err, {}); plant == nullptr) {
    return false;
  } else {
    for (std::size_t i = 0; i < plant->bus_count(); ++i) {
      if (!plant->bus_section(i).is_linked()) continue;
      err.line("{}", text::describe(text::FileError{plant->bus_section(i).place,
                                                    "link: a campaign needs simulated buses"},
                                    path_));
      return false;
    }
  }
  auto table = text::parse_toml(*text);
  if (!table) return false;  // it was read before
  plant_ = std::move(*table);
  remove_stores(plant_);
  if (const auto applied = apply(plant_, variant, campaign); !applied) {
    err.line("{}", text::describe(text::FileError{variant.place, applied.error()}, campaign.path));
    return false;
  }
  if (variant.changes.empty() && variant.program.empty()) return true;
  use.text = text_of(plant_);
  text::TextOutput mistakes;
  if (plant::load_plant(path_, no_observer, mistakes, use) != nullptr) return true;
  err.line("{}", text::describe(
                     text::FileError{variant.place,
                                     fmt::format("variant \"{}\": the plant has mistakes:", variant.name)},
                     campaign.path));
  err.content(mistakes.text());
  return false;
}

std::vector<std::string> PlantTemplate::device_names() const {
  std::vector<std::string> names;
  if (const toml::array* const devices = plant_["device"].as_array()) {
    for (const toml::node& node : *devices) {
      if (!node.is_table()) continue;
      if (const auto name = (*node.as_table())["name"].value<std::string>()) names.push_back(*name);
    }
  }
  return names;
}

std::expected<toml::table, std::string> PlantTemplate::with(
    std::span<const ChosenRule> rules, std::span<const std::string> without_devices) const {
  toml::table plant = plant_;
  for (const ChosenRule& chosen : rules) {
    if (const auto added = add(plant, chosen); !added) return std::unexpected(added.error());
  }
  for (const std::string& name : without_devices) remove_device(plant, name);
  return plant;
}

}  // namespace canopus::campaign
