#pragma once
// All soft modules, with the facts about each.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/interface/configuration_tool.hpp"
#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/module/interface/download.hpp"
#include "canopus/module/interface/error_words.hpp"
#include "canopus/module/interface/non_volatile_memory.hpp"
#include "canopus/module/interface/reset_procedure.hpp"
#include "canopus/module/memory/buffer_memory.hpp"
#include "canopus/plc/cpu/device.hpp"

namespace canopus::plant {

/// Settings of a plant in place of the module's defaults.
struct ModuleTuning {
  std::optional<can::Duration> restart_time{};
};

inline constexpr std::array racks_with_head_addresses = {plc::CpuFamily::q, plc::CpuFamily::iqr};

/// The object dictionary of a function mode.
struct ModeObjects {
  std::uint16_t mode = 0;
  std::shared_ptr<const canopen::DictionaryDescription> (*objects)() = nullptr;
};

struct CatalogueEntry {
  const module::DataSheet* data_sheet;
  /// Its object dictionary; nullptr for a module that has none.
  std::shared_ptr<const canopen::DictionaryDescription> (*objects)();
  /// Names of what it stores, as files of its folder in a plant's store.
  std::span<const std::string_view> stored;
  /// One with factory settings. Controller and memory must outlive it.
  std::unique_ptr<module::CommunicationModule> (*make)(can::Controller& controller,
                                                       module::NonVolatileMemory& memory,
                                                       const ModuleTuning& tuning);
  /// Its buffer memory, as its manual names the words; left out, the words have no names.
  std::span<const module::BufferRow> buffer_rows{};
  /// Racks that it fits into; left out, MELSEC Q and iQ-R.
  std::span<const plc::CpuFamily> families = racks_with_head_addresses;
  /// Function modes whose objects are not those above.
  std::span<const ModeObjects> more_modes{};
  /// Of a module whose tool downloads a node list: does so, or changes nothing and returns what is wrong with it, a sentence
  /// each. nullptr: it is another module. Without supply the download is there at once.
  std::vector<std::string> (*download)(module::CommunicationModule& module, module::Download download,
                                       can::Time now) = nullptr;
  /// The one place of the rack that it fits into; 0: any.
  std::uint16_t only_place = 0;
  /// The errors that its words show; never null.
  const module::ErrorTables* errors = nullptr;
  /// A program's procedure to clear them and restart the module; never null.
  const module::ResetProcedure* reset_procedure = nullptr;
  /// The settings of its configuration tool; nullptr: `canopus configure` is not for it.
  const module::ConfigurationTool* configuration_tool = nullptr;
};

[[nodiscard]] std::span<const CatalogueEntry> module_catalogue() noexcept;
/// By model name in any case; nullptr when there is no such module.
[[nodiscard]] const CatalogueEntry* find_module(std::string_view model) noexcept;
/// Those of the modules that have one, by model.
[[nodiscard]] std::span<const module::ConfigurationTool* const> configuration_tools() noexcept;
/// The models there are, each between quotes: "A", "B".
[[nodiscard]] std::string quoted_models();

/// The text of an EDS file that describes the module in its first CANopen function mode, or in another one.
[[nodiscard]] std::string module_eds(const CatalogueEntry& entry, const ModeObjects* mode = nullptr);

}  // namespace canopus::plant
