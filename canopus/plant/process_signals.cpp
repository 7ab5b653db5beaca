#include "canopus/plant/process_signals.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canopus/module/canopen/network_variables.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/initial_nodes.hpp"
#include "canopus/plc/cpu/device.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plant {

namespace {

using Bit = ProcessSignal::Bit;
using trace::NodeDescription;

/// First communication parameter; the mapping parameters are 200H higher [CiA 301 7.5.2.35, 7.5.2.37].
constexpr std::uint16_t rpdo = 0x1400;
constexpr std::uint16_t tpdo = 0x1800;
constexpr unsigned most_bits = 64;

struct Pdo {
  struct Mapped {
    text::ObjectName object{};
    unsigned bits = 0;
  };
  unsigned number = 0;
  std::uint32_t can_id = 0;  ///< bit 29: 29 bits
  std::vector<Mapped> mapped{};
};

/// The PDOs of a node that exist, in one direction.
std::vector<Pdo> pdos_of(const NodeDescription& node, std::uint16_t direction) {
  constexpr std::uint32_t does_not_exist = 0x8000'0000;
  constexpr std::uint32_t can_id_and_format = 0x3FFF'FFFF;  // bit 30 is "no RTR"
  constexpr unsigned pdos = 0x200;
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t> values;
  for (const trace::Setting& setting : node.settings) values[{setting.index, setting.sub}] = setting.value;
  const auto value = [&](unsigned index, unsigned sub) -> std::uint32_t {
    const auto found = values.find({static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)});
    return found == values.end() ? 0 : found->second;
  };
  std::vector<Pdo> found;
  for (unsigned i = 0; i < pdos; ++i) {
    const std::uint32_t cob_id = value(direction + i, 1);
    const std::uint32_t count = value(direction + 0x200U + i, 0);
    if (cob_id == 0 || (cob_id & does_not_exist) != 0 || count == 0 || count > most_bits) continue;
    Pdo pdo{.number = i + 1, .can_id = cob_id & can_id_and_format};
    for (unsigned sub = 1; sub <= count; ++sub) {
      const std::uint32_t entry = value(direction + 0x200U + i, sub);
      pdo.mapped.push_back({{static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8)},
                            std::min(entry & 0xFF, most_bits)});
    }
    found.push_back(std::move(pdo));
  }
  return found;
}

/// The CPU's device that the refresh copies to or from a word of the buffer memory, if it is a word device.
plc::RackAddress refreshed(const ModuleSection& section, plc::RackAddress word) {
  constexpr std::uint32_t block_words = 64;
  if (!section.parameters || !section.parameters->refresh) return word;
  for (const ParametersSection::Block& block : section.parameters->blocks) {
    if (!block.device || plc::device_info(*block.device).is_bit || word.number < block.address ||
        word.number - block.address >= block_words)
      continue;
    return {.device = *block.device, .number = block.number + (word.number - block.address)};
  }
  return word;
}

/// Where each bit of a PDO of the module lies; nothing for bits of other objects.
std::vector<std::optional<Bit>> bits_of(const Pdo& pdo, const ModuleSection& section,
                                        const module::DataExchangeLayout& layout) {
  std::vector<std::optional<Bit>> bits;
  for (const Pdo::Mapped& mapped : pdo.mapped) {
    const auto place =
        module::variable_place(mapped.object.index, mapped.object.sub, layout.words * 2, layout.variables);
    for (unsigned i = 0; i < mapped.bits; ++i) {
      bits.emplace_back();
      if (!place) continue;
      const auto first =
          place->direction == module::VariableDirection::input ? layout.transmit_first : layout.receive_first;
      const unsigned at = place->offset * 8U + i;
      const plc::RackAddress word{
          .is_buffer = true, .head_address = section.head, .number = layout.address(first, at / 16)};
      bits.back() = Bit{refreshed(section, word), static_cast<std::uint8_t>(at % 16)};
    }
  }
  return bits;
}

/// The objects of the node's PDO whose bits the module has in words.
void add_signals(const NodeDescription& node, const Pdo& pdo, const std::vector<std::optional<Bit>>& bits,
                 const ProcessSignal& common, std::vector<ProcessSignal>& signals) {
  constexpr std::uint16_t last_dummy = 0x1F;
  std::size_t next = 0;
  for (const Pdo::Mapped& mapped : pdo.mapped) {
    const std::size_t first = std::exchange(next, next + mapped.bits);
    if (mapped.object.index <= last_dummy || mapped.bits == 0 || next > bits.size()) continue;
    ProcessSignal signal = common;
    signal.bus = node.bus;
    signal.node_id = node.node_id;
    signal.object = mapped.object;
    signal.pdo = fmt::format("{}{}", common.is_output ? "RPDO" : "TPDO", pdo.number);
    for (std::size_t i = first; i < next && bits[i]; ++i) signal.bits.push_back(*bits[i]);
    if (signal.bits.size() == mapped.bits) signals.push_back(std::move(signal));
  }
}

/// The signals of one module: `own` is its node.
void add_module(const NodeDescription& own, const ModuleSection& section,
                const module::DataExchangeLayout& layout, std::size_t plc, ProcessSignals& found) {
  for (const auto& [of_module, of_node] : {std::pair{rpdo, tpdo}, std::pair{tpdo, rpdo}}) {
    const ProcessSignal common{.is_output = of_module == tpdo, .plc = plc};
    for (const Pdo& pdo : pdos_of(own, of_module)) {
      const auto bits = bits_of(pdo, section, layout);
      for (const NodeDescription& node : found.nodes.nodes()) {
        if (&node == &own || node.bus != own.bus) continue;
        for (const Pdo& other : pdos_of(node, of_node)) {
          if (other.can_id == pdo.can_id) add_signals(node, other, bits, common, found.signals);
        }
      }
    }
  }
}

}  // namespace

ProcessSignals process_signals(Plant& plant) {
  ProcessSignals found;
  for (InitialPlantNode& node : initial_nodes(plant)) {
    found.nodes.add(trace::describe_node(std::move(node.bus), node.node_id, std::move(node.name),
                                         std::move(node.objects)));
  }
  for (std::size_t number = 0; number < plant.plc_count(); ++number) {
    for (const ModuleSection& section : plant.plc_section(number).modules) {
      auto* const module =
          dynamic_cast<module::CommunicationModule*>(plant.rack(number).module_at(section.head));
      const auto initial = module == nullptr ? std::nullopt : module->initial_node();
      if (!initial) continue;
      const auto own = std::ranges::find_if(found.nodes.nodes(), [&](const NodeDescription& node) {
        return node.bus == section.bus && node.node_id == initial->node_id;
      });
      if (own != found.nodes.nodes().end())
        add_module(*own, section, module->program_interface().process_data, number, found);
    }
  }
  return found;
}

}  // namespace canopus::plant
