#pragma once
// PDO mapping modes of a module: all its PDOs at once [FX3U-CAN 7.2; FX2N-32CAN 7].

#include <cstdint>
#include <optional>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/module/commands/command_interface.hpp"

namespace canopus::module {

/// Writes the communication and mapping parameters of `pdos` PDOs each way: those of `factory`, with the
/// COB-IDs of the mode for this node-ID.
void set_pdo_mapping(canopen::ObjectDictionary& dictionary, const canopen::ObjectDictionary& factory,
                     std::uint8_t node_id, std::uint16_t pdos, PdoMapping mapping, can::Time now);
/// CAN-ID and length of the frames of RPDO `number` (from 0); nothing when it is not valid, or there is none.
struct PdoFrame {
  std::uint32_t identifier = 0;
  std::uint8_t length = 0;  ///< bytes
};
[[nodiscard]] std::optional<PdoFrame> rpdo_frame(const canopen::ObjectDictionary& dictionary,
                                                 std::uint16_t number);

}  // namespace canopus::module
