#pragma once
// PDO mapping modes of a module: all its PDOs at once [FX3U-CAN 7.2].

#include <cstdint>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/module/areas/command_interface.hpp"

namespace canopus::module {

/// Writes the communication and mapping parameters of `pdos` PDOs each way: those of `factory`, with the
/// COB-IDs of the mode.
void set_pdo_mapping(canopen::ObjectDictionary& dictionary, const canopen::ObjectDictionary& factory,
                     std::uint16_t pdos, PdoMapping mapping, can::Time now);

}  // namespace canopus::module
