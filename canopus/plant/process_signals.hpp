#pragma once
// The signals that the modules of a plant exchange by PDO: objects of other nodes, and their bits in the buffer memory of the
// module, or in the devices of the CPU that its refresh copies.

#include <cstdint>
#include <string>
#include <vector>

#include "canopus/plant/plant.hpp"
#include "canopus/plc/rack/rack_address.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/trace/decode/names.hpp"

namespace canopus::plant {

/// An object of a node in a PDO that a module receives or sends.
struct ProcessSignal {
  struct Bit {
    plc::RackAddress word{};
    std::uint8_t bit = 0;  ///< 0..15
  };
  std::string bus{};
  std::uint8_t node_id = 0;
  text::ObjectName object{};
  bool is_output = false;   ///< the PLC writes it, in an RPDO of the node; else it is in a TPDO of the node
  std::string pdo{};        ///< of the node: "TPDO1"
  std::size_t plc = 0;      ///< number in the plant file
  std::vector<Bit> bits{};  ///< the lowest first
};

struct ProcessSignals {
  trace::Names nodes{};  ///< of the whole plant
  std::vector<ProcessSignal> signals{};
};

/// As power-on sets the PDOs. The plant must not have been switched on.
[[nodiscard]] ProcessSignals process_signals(Plant& plant);

}  // namespace canopus::plant
