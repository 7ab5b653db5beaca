#pragma once
// One bus for export to other programs: its nodes by name, its PDOs with their signals.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/trace/decode/bus_knowledge.hpp"
#include "canopus/trace/decode/message.hpp"

namespace canopus::trace {

/// A PDO with an identifier of its own.
struct ModelPdo {
  FrameKey key = 0;
  std::uint8_t node = 0;
  bool transmit = false;
  std::uint16_t number = 0;
  unsigned length = 0;  ///< bytes, 0..8
  std::vector<std::uint8_t> producers{};
  std::vector<std::uint8_t> consumers{};
  std::vector<Signal> signals{};  ///< without value
};

struct BusModel {
  std::string bus{};
  std::vector<const NodeDescription*> nodes{};  ///< of the Names it was made of
  std::vector<ModelPdo> pdos{};                 ///< in order of identifier

  [[nodiscard]] std::string node_name(std::uint8_t node_id) const;
};

/// The nodes and PDOs of a bus; without a name those of all.
[[nodiscard]] BusModel model_of(const Names& names, std::string_view bus);

/// A DBC file: each PDO a message.
[[nodiscard]] std::string dbc_file(const BusModel& model);
/// A Lua script for Wireshark and tshark. `title`: what the tree calls it.
[[nodiscard]] std::string lua_dissector(const BusModel& model, std::string_view title);

}  // namespace canopus::trace
