#include "canopus/plant/catalogue/module_catalogue.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/eds/writer.hpp"
#include "canopus/module/models/as_fcopm/as_fcopm.hpp"
#include "canopus/module/models/as_fcopm/data_sheet.hpp"
#include "canopus/module/models/as_fcopm/error_table.hpp"
#include "canopus/module/models/as_fcopm/object_table.hpp"
#include "canopus/module/models/fx2n_32can/buffer_table.hpp"
#include "canopus/module/models/fx2n_32can/data_sheet.hpp"
#include "canopus/module/models/fx2n_32can/error_table.hpp"
#include "canopus/module/models/fx2n_32can/fx2n_32can.hpp"
#include "canopus/module/models/fx3u_can/buffer_table.hpp"
#include "canopus/module/models/fx3u_can/configuration_tool.hpp"
#include "canopus/module/models/fx3u_can/data_sheet.hpp"
#include "canopus/module/models/fx3u_can/error_table.hpp"
#include "canopus/module/models/fx3u_can/fx3u_can.hpp"
#include "canopus/module/models/fx3u_can/object_table.hpp"
#include "canopus/module/models/me3can1_q/buffer_table.hpp"
#include "canopus/module/models/me3can1_q/data_sheet.hpp"
#include "canopus/module/models/me3can1_q/error_table.hpp"
#include "canopus/module/models/me3can1_q/me3can1_q.hpp"
#include "canopus/module/models/rj71cn91/buffer_table.hpp"
#include "canopus/module/models/rj71cn91/configuration_tool.hpp"
#include "canopus/module/models/rj71cn91/data_sheet.hpp"
#include "canopus/module/models/rj71cn91/error_table.hpp"
#include "canopus/module/models/rj71cn91/rj71cn91.hpp"

namespace canopus::plant {

namespace {

template <typename Module>
std::unique_ptr<module::CommunicationModule> make(can::Controller& controller,
                                                  module::NonVolatileMemory& memory,
                                                  const ModuleTuning& tuning) {
  module::Profile profile;
  profile.restart_time = tuning.restart_time.value_or(profile.restart_time);
  return std::make_unique<Module>(controller, memory, profile);
}

/// A module of MELSEC iQ-R; plant files that leave the family out have a rack of MELSEC Q, which counts places alike.
constexpr std::array racks_of_iqr = {plc::CpuFamily::iqr, plc::CpuFamily::q};
constexpr std::array racks_of_blocks = {plc::CpuFamily::fx3, plc::CpuFamily::fx5};
constexpr std::array lift_mode = std::to_array<ModeObjects>({{417, module::fx3u_can::lift_dictionary}});
constexpr std::array racks_of_fx3 = {plc::CpuFamily::fx3};

constexpr std::array racks_of_as300 = {plc::CpuFamily::as300};

/// Of a module that this catalogue has made.
std::vector<std::string> download_to_card(module::CommunicationModule& card, module::Download download,
                                          can::Time now) {
  std::vector<std::string> errors = module::as_fcopm::check_download(download);
  if (errors.empty()) static_cast<module::as_fcopm::AsFcopm&>(card).download(std::move(download), now);
  return errors;
}

const std::array catalogue = std::to_array<CatalogueEntry>({
    {.data_sheet = &module::me3can1_q::data_sheet,
     .objects = module::me3can1_q::object_dictionary,
     .stored = module::ModuleSettings::stored_names,
     .make = make<module::me3can1_q::Me3can1Q>,
     .buffer_rows = module::me3can1_q::buffer_table,
     .errors = &module::me3can1_q::error_tables,
     .reset_procedure = &module::me3can1_q::reset_procedure},
    {.data_sheet = &module::rj71cn91::data_sheet,
     .objects = module::rj71cn91::object_dictionary,
     .stored = module::ModuleSettings::stored_names,
     .make = make<module::rj71cn91::Rj71cn91>,
     .buffer_rows = module::rj71cn91::buffer_table,
     .families = racks_of_iqr,
     .errors = &module::rj71cn91::error_tables,
     .reset_procedure = &module::rj71cn91::reset_procedure,
     .configuration_tool = &module::rj71cn91::configuration_tool},
    {.data_sheet = &module::fx3u_can::data_sheet,
     .objects = module::fx3u_can::object_dictionary,
     .stored = module::ModuleSettings::stored_names,
     .make = make<module::fx3u_can::Fx3uCan>,
     .buffer_rows = module::fx3u_can::buffer_table,
     .families = racks_of_blocks,
     .more_modes = lift_mode,
     .errors = &module::fx3u_can::error_tables,
     .reset_procedure = &module::fx3u_can::reset_procedure,
     .configuration_tool = &module::fx3u_can::configuration_tool},
    {.data_sheet = &module::fx2n_32can::data_sheet,
     .objects = module::fx2n_32can::object_dictionary,
     .stored = module::ModuleSettings::stored_names,
     .make = make<module::fx2n_32can::Fx2n32Can>,
     .buffer_rows = module::fx2n_32can::buffer_table,
     .families = racks_of_fx3,
     .errors = &module::fx2n_32can::error_tables,
     .reset_procedure = &module::fx2n_32can::reset_procedure},
    {.data_sheet = &module::as_fcopm::data_sheet,
     .objects = module::as_fcopm::object_dictionary,
     .stored = {},
     .make = make<module::as_fcopm::AsFcopm>,
     .families = racks_of_as300,
     .download = download_to_card,
     .only_place = 2,
     .errors = &module::as_fcopm::error_tables,
     .reset_procedure = &module::as_fcopm::reset_procedure},
});

std::uint16_t count_objects(const canopen::DictionaryDescription& objects, unsigned first, unsigned last) {
  return static_cast<std::uint16_t>(
      std::ranges::count_if(objects.objects(), [&](const canopen::ObjectDescription& object) {
        return object.index >= first && object.index <= last;
      }));
}

}  // namespace

std::span<const CatalogueEntry> module_catalogue() noexcept { return catalogue; }

std::span<const module::ConfigurationTool* const> configuration_tools() noexcept {
  static const auto tools = [] {
    std::vector<const module::ConfigurationTool*> found;
    for (const CatalogueEntry& entry : catalogue)
      if (entry.configuration_tool != nullptr) found.push_back(entry.configuration_tool);
    std::ranges::sort(found, {}, &module::ConfigurationTool::model);
    return found;
  }();
  return tools;
}

const CatalogueEntry* find_module(std::string_view model) noexcept {
  const auto found = std::ranges::find_if(catalogue, [&](const CatalogueEntry& e) {
    return ascii::equal_ignoring_case(e.data_sheet->model, model);
  });
  return found == catalogue.end() ? nullptr : &*found;
}

std::string quoted_models() {
  std::string models;
  for (const CatalogueEntry& entry : catalogue) {
    models += fmt::format("{}\"{}\"", models.empty() ? "" : ", ", entry.data_sheet->model);
  }
  return models;
}

std::string module_eds(const CatalogueEntry& entry, const ModeObjects* mode) {
  const module::DataSheet& sheet = *entry.data_sheet;
  const auto objects = mode != nullptr ? mode->objects() : entry.objects();
  canopen::ObjectDictionary values(objects, 1);
  eds::FileInfo file;
  file.file_name =
      ascii::lower(sheet.model) + (mode != nullptr ? fmt::format("-{}", mode->mode) : "") + ".eds";
  file.version = file.revision = 1;
  file.eds_version = "4.0";
  file.description = std::string(sheet.model) + " as the soft module of Canopus is; not the maker's file";
  file.creation_time = file.modification_time = "09:00AM";
  file.creation_date = file.modification_date = "11-21-2026";
  file.created_by = file.modified_by = "Canopus";
  eds::DeviceInfo device;
  device.vendor_name = sheet.maker;
  device.product_name = device.order_code = sheet.model;
  device.vendor_number = values.get<std::uint32_t>(0x1018, 1, 0);
  device.product_number = values.get<std::uint32_t>(0x1018, 2, 0);
  device.revision_number = values.get<std::uint32_t>(0x1018, 3, 0);
  for (const module::BusLength& rate : sheet.bus_lengths) device.bit_rates.push_back(rate.kbps * 1000);
  device.simple_boot_up_master = device.simple_boot_up_slave = true;
  device.rpdos = count_objects(*objects, 0x1400, 0x15FF);
  device.tpdos = count_objects(*objects, 0x1800, 0x19FF);
  return eds::write_device_file(file, device, *objects);
}

}  // namespace canopus::plant
