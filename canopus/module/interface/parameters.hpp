#pragma once
// What the engineering tools have written to the CPU for a module, and the CPU gives it at each start, before it evaluates what
// it has saved itself [RJ71CN91 2.2 to 2.4, App. 2 G22].

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "canopus/module/interface/module_types.hpp"

namespace canopus::module {

struct ModuleParameters {
  /// Words, over those that the module has saved.
  std::map<BufferAddress, std::uint16_t> words{};
  /// Objects of its own dictionary, over those that 1010H has stored: index and sub-index, value.
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::vector<std::uint8_t>> objects{};
  /// Concise DCFs of other nodes, by node-ID: into 1F22H when the supply comes.
  std::map<std::uint8_t, std::vector<std::uint8_t>> concise_dcfs{};
  /// Process data are exchanged by the CPU's refresh, not by the program's request.
  bool refresh = false;

  [[nodiscard]] bool empty() const noexcept {
    return words.empty() && objects.empty() && concise_dcfs.empty();
  }
};

}  // namespace canopus::module
