#pragma once
// Gives a module the settings that its section of the plant file names, as it leaves the shelf. What it does
// not take is told with the place in the file; the module's rules are its own.

#include <vector>

#include "canopus/app/plant_file.hpp"
#include "canopus/module/communication_module.hpp"
#include "canopus/module/data_sheet.hpp"

namespace canopus::app {

/// Bit rate of the bus, node-ID and words; and whether the built-in PLC program can do what it is asked for.
[[nodiscard]] std::vector<FileError> preset_words(module::CommunicationModule& module,
                                                  const module::DataSheet& data_sheet,
                                                  const ModuleSection& section, const BusSection& bus);
/// Its objects, over whatever set some of them before.
[[nodiscard]] std::vector<FileError> preset_objects(module::CommunicationModule& module,
                                                    const ModuleSection& section);

}  // namespace canopus::app
