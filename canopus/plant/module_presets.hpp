#pragma once
// Gives a module the settings that its section of the plant file names, as factory settings. What it does
// not take is reported with its place in the file; the module's rules are its own.

#include <vector>

#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/plant/plant_file.hpp"

namespace canopus::plant {

/// Bit rate of the bus, node-ID and words; and whether the built-in PLC program can do what it is asked for.
[[nodiscard]] std::vector<text::FileError> preset_words(module::CommunicationModule& module,
                                                        const module::DataSheet& data_sheet,
                                                        const ModuleSection& section, const BusSection& bus);
/// Its objects, over whatever set some of them before.
[[nodiscard]] std::vector<text::FileError> preset_objects(module::CommunicationModule& module,
                                                          const ModuleSection& section);

}  // namespace canopus::plant
