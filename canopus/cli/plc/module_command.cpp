#include "canopus/cli/plc/module_command.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

#include <fmt/format.h>

#include "canopus/cli/options/command.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/module/storage/flash_memory.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plant/plant_loading.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/store/file_memory.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::cli {

namespace {

using Json = text::Json;
using module::DataSheet;

const plant::CatalogueEntry* known_module(const std::string& model, Output& err) {
  const plant::CatalogueEntry* entry = plant::find_module(model);
  if (entry == nullptr) {
    std::vector<std::string_view> models;
    for (const plant::CatalogueEntry& known : plant::module_catalogue())
      models.push_back(known.data_sheet->model);
    err.line("canopus: {}: no such module{}", model, text::suggestion(model, models));
  }
  return entry;
}

std::uint32_t flash_writes(const plant::CatalogueEntry& entry, const std::filesystem::path& folder) {
  store::FileMemory memory(folder);
  std::uint32_t most = 0;
  for (const std::string_view name : entry.stored) {
    module::FlashMemory flash(memory, {name});
    flash.load();
    most = std::max(most, flash.writes());
  }
  return most;
}

void print_text(const DataSheet& sheet, std::optional<std::uint32_t> writes, Output& out) {
  const auto row = [&](std::string_view name, std::string_view value) { out.line("{:<26}{}", name, value); };
  row("Model", fmt::format("{}, {}", sheet.model, sheet.maker));
  row("Manual", sheet.manual);
  row("Type, series", fmt::format("{} {}", sheet.type, sheet.series));
  row("I/O points", fmt::format("{} ({})", sheet.points, sheet.io_assignment));
  row("Online module change", sheet.online_module_change ? "supported" : "not supported");
  row("Multiple CPU system", sheet.multiple_cpu);
  // A manual need not state the write endurance.
  const std::string endurance =
      sheet.flash_writes == 0 ? "not stated" : fmt::format("{} writes", sheet.flash_writes);
  row("Flash memory", !writes                   ? endurance
                      : sheet.flash_writes == 0 ? fmt::format("{} writes used", *writes)
                                                : fmt::format("{} of {} used", *writes, endurance));
  for (const module::Property& property : sheet.properties) row(property.name, property.value);
  out.line("");
  out.line("Function modes");
  for (const auto& mode : sheet.modes) out.line("  {:<6}{}", mode.value, mode.name);
  if (!sheet.standards.empty()) out.line("\nStandards");
  for (const auto& standard : sheet.standards) {
    out.line("  {:<10} V{:<5}{}", standard.name, standard.version, standard.about);
  }
  out.line("");
  out.line("Connector: {}", sheet.connector);
  for (const auto& pin : sheet.pins) {
    out.line("  {}  {:<10}{}", pin.number, pin.signal.empty() ? "reserved" : pin.signal, pin.meaning);
  }
  out.line("");
  out.line("Longest bus");
  for (const auto& length : sheet.bus_lengths) {
    out.line("  {:>4} kbps {:>7}", length.kbps,
             length.metres == 0 ? "-" : fmt::format("{} m", length.metres));
  }
  if (sheet.modules_per_cpu.empty()) return;
  out.line("");
  out.line("Modules per CPU, within its I/O points and the power supply's capacity");
  for (const auto& cpu : sheet.modules_per_cpu) {
    out.line("  {:<30}{:<50}{}", cpu.kind, cpu.models,
             cpu.modules == 0 ? "not applicable" : fmt::format("up to {}", cpu.modules));
  }
}

Json as_json(const DataSheet& sheet, std::optional<std::uint32_t> writes) {
  Json json;
  json["model"] = sheet.model;
  json["maker"] = sheet.maker;
  json["manual"] = sheet.manual;
  json["type"] = sheet.type;
  json["series"] = sheet.series;
  json["points"] = sheet.points;
  json["io_assignment"] = sheet.io_assignment;
  json["online_module_change"] = sheet.online_module_change;
  json["multiple_cpu"] = sheet.multiple_cpu;
  json["flash_endurance"] = sheet.flash_writes == 0 ? Json() : Json(sheet.flash_writes);
  if (writes) json["flash_writes"] = *writes;
  for (const auto& mode : sheet.modes) json["modes"].push_back({{"value", mode.value}, {"name", mode.name}});
  for (const auto& standard : sheet.standards) {
    json["standards"].push_back(
        {{"name", standard.name}, {"version", standard.version}, {"about", standard.about}});
  }
  json["connector"] = sheet.connector;
  for (const auto& pin : sheet.pins) {
    json["pins"].push_back(
        {{"number", pin.number}, {"signal", pin.signal.empty() ? Json() : Json(pin.signal)}});
  }
  for (const auto& length : sheet.bus_lengths) {
    json["bus_lengths"].push_back(
        {{"kbps", length.kbps}, {"metres", length.metres == 0 ? Json() : Json(length.metres)}});
  }
  for (const auto& cpu : sheet.modules_per_cpu) {
    json["modules_per_cpu"].push_back({{"kind", cpu.kind},
                                       {"models", cpu.models},
                                       {"modules", cpu.modules == 0 ? Json() : Json(cpu.modules)}});
  }
  for (const auto& property : sheet.properties)
    json["properties"][std::string(property.name)] = property.value;
  return json;
}

int product_lists(const std::string& path, bool json, Output& out, Output& err) {
  class Nobody final : public plant::PlantObserver {
  } no_observer;
  const std::unique_ptr<plant::Plant> plant = plant::load_plant(path, no_observer, err);
  if (!plant) return 2;
  if (!json)
    out.line("plc       slot  type      series  model        points  I/O No.  serial No         ver.");
  for (std::size_t number = 0; number < plant->plc_count(); ++number) {
    const std::string& name = plant->plc_section(number).name;
    for (const auto& [slot, io_number, product] : plant->rack(number).product_list()) {
      if (json) {
        out.json(Json{{"plc", name},
                      {"slot", slot},
                      {"type", product.type},
                      {"series", product.series},
                      {"model", product.model},
                      {"points", product.points},
                      {"io_number", io_number},
                      {"serial_number", product.serial_number},
                      {"version", product.version}});
      } else {
        out.line("{:<9} 0-{:<3} {:<9} {:<7} {:<12} {:<7} {:04X}     {:<17} {}", name, slot, product.type,
                 product.series, product.model, fmt::format("{}pt", product.points), io_number,
                 product.serial_number, product.version);
      }
    }
  }
  return 0;
}

}  // namespace

int module_list(const std::optional<std::string>& plant, bool json, Output& out, Output& err) {
  if (plant) return product_lists(*plant, json, out, err);
  for (const plant::CatalogueEntry& entry : plant::module_catalogue()) {
    const DataSheet& sheet = *entry.data_sheet;
    if (json) {
      out.json(Json{{"model", sheet.model},
                    {"maker", sheet.maker},
                    {"series", sheet.series},
                    {"points", sheet.points}});
    } else {
      out.line("{:<12} {}, series {}, {} points", sheet.model, sheet.maker, sheet.series, sheet.points);
    }
  }
  return 0;
}

int module_info(const std::string& model, const std::optional<std::filesystem::path>& store, bool json,
                Output& out, Output& err) {
  const plant::CatalogueEntry* entry = known_module(model, err);
  if (entry == nullptr) return 2;
  std::optional<std::uint32_t> writes;
  if (store) {
    if (!std::filesystem::is_directory(*store)) {
      err.line(
          "canopus: {}: no such folder; expected the module's own in a plant's store, for example "
          "state/U000-ME3CAN1-Q",
          store->string());
      return 2;
    }
    writes = flash_writes(*entry, *store);
  }
  if (json) {
    out.json(as_json(*entry->data_sheet, writes));
  } else {
    print_text(*entry->data_sheet, writes, out);
  }
  return 0;
}

int module_eds_file(const std::string& model, const std::string& path, Output& out, Output& err,
                    std::optional<unsigned> mode) {
  const plant::CatalogueEntry* entry = known_module(model, err);
  if (entry == nullptr) return 2;
  const plant::ModeObjects* objects = nullptr;
  constexpr unsigned first_mode = 405;
  if (mode && *mode != first_mode) {
    const auto found = std::ranges::find(entry->more_modes, *mode, &plant::ModeObjects::mode);
    if (found == entry->more_modes.end()) {
      std::string modes = std::to_string(first_mode);
      for (const plant::ModeObjects& more : entry->more_modes) modes += fmt::format(", {}", more.mode);
      err.line("canopus: the {} has no objects in a function mode {}; expected {}", entry->data_sheet->model,
               *mode, modes);
      return 2;
    }
    objects = &*found;
  }
  const std::string text = plant::module_eds(*entry, objects);
  if (path.empty()) {
    out.content(text);
    return 0;
  }
  if (const auto written = write_new_file(path, text); !written) {
    err.line("canopus: {}", written.error());
    return 2;
  }
  return 0;
}

namespace {

void build_module_command(Command& command, int& exit_code) {
  command.require_subcommand(1);
  struct Words {
    std::string model, plant, store, output;
    std::optional<unsigned> mode;
    bool json = false;
  };
  const auto words = std::make_shared<Words>();

  Command* list = command.add_subcommand("list", "The modules there are, or those of a plant's PLCs");
  list->add_option("PLANT", words->plant,
                   "Plant file: its product lists, as the programming tool shows them");
  list->add_flag("--json", words->json, "One JSON object per line");
  list->callback([words, &exit_code] {
    exit_code = module_list(words->plant.empty() ? std::nullopt : std::optional(words->plant), words->json,
                            standard_output(), standard_error());
  });

  Command* info = command.add_subcommand("info", "Data of a module from its manual");
  info->add_option("MODEL", words->model, "for example me3can1-q")->required();
  info->add_option("--store", words->store,
                   "Its folder in a plant's store: how often its flash memory was written")
      ->type_name("FOLDER");
  info->add_flag("--json", words->json, "One JSON object");
  info->callback([words, &exit_code] {
    exit_code =
        module_info(words->model,
                    words->store.empty() ? std::nullopt : std::optional<std::filesystem::path>(words->store),
                    words->json, standard_output(), standard_error());
  });

  Command* eds = command.add_subcommand("eds", "An EDS file of the module, for configuration tools");
  eds->add_option("MODEL", words->model, "for example me3can1-q")->required();
  eds->add_option("--mode", words->mode, "Function mode of another object dictionary: 417 of an FX3U-CAN");
  eds->add_option("-o,--output", words->output, "Write it into this file")->type_name("FILE");
  eds->callback([words, &exit_code] {
    exit_code =
        module_eds_file(words->model, words->output, standard_output(), standard_error(), words->mode);
  });
  command.add_subcommand("compare", "A table that compares the modules, in Markdown")->callback([&exit_code] {
    exit_code = module_compare(standard_output());
  });
  add_module_status(command, exit_code);
  command.footer(
      "Exit codes: 0 done, 1 a running plant refused or could not be reached, 2 no such module, or a file "
      "that cannot be read or written.\n"
      "Example: canopus module eds me3can1-q -o me3can1-q.eds");
}

}  // namespace

void add_module_command(Command& app, int& exit_code) {
  app.add_subcommand("module", "List the supported modules, their data sheets, EDS files and status",
                     [&exit_code](Command& command) { build_module_command(command, exit_code); });
}

}  // namespace canopus::cli
