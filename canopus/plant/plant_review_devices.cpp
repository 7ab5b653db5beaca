// Findings about single nodes that cannot do what is asked of them.

#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/pdo/pdo_mapping.hpp"
#include "canopus/plant/plant_review.hpp"

namespace canopus::plant {

namespace {

constexpr std::uint16_t lowest_object = 0x20;  // below: dummy mapping of data types
constexpr std::uint8_t most_entries = 64;      // above: an MPDO

}  // namespace

void find_other_bit_rates(const ReviewedBus& bus, Warnings& warnings) {
  for (const ReviewedNode& node : bus.nodes) {
    if (bus.bit_rate == 0 || node.bit_rate == 0 || node.bit_rate == bus.bit_rate) continue;
    warnings.push_back(
        {node.place,
         fmt::format("{} has {:g} kbit/s, and bus \"{}\" has {:g} kbit/s: they destroy each other's frames, "
                     "until LSS or a restart gives it the bit rate of the bus",
                     node.name, node.bit_rate / 1000.0, bus.name, bus.bit_rate / 1000.0)});
  }
}

void find_drives_without_modes(const ReviewedBus& bus, Warnings& warnings) {
  // Profile position, profile velocity, homing [CiA 402-2].
  constexpr std::uint32_t simulated_modes = 0b10'0101;
  for (const ReviewedNode& node : bus.nodes) {
    if (node.device == nullptr || !node.device->drive) continue;
    const bool has_modes = node.objects.description().find(0x6502) != nullptr;
    const auto modes = node.objects.get<std::uint32_t>(0x6502, 0);
    if (!has_modes || (modes & simulated_modes) != 0) continue;
    warnings.push_back(
        {node.device->drive->place,
         fmt::format("{}: drive: its 6502H (supported drive modes) is {:08X}H, so 6060H selects no mode and "
                     "the axis does not move: bit 0 is profile position, bit 2 profile velocity, bit 5 "
                     "homing, for example objects = {{ \"6502:00\" = 0x25 }}",
                     node.name, modes)});
  }
}

void find_unmappable_objects(const ReviewedBus& bus, Warnings& warnings) {
  for (const ReviewedNode& node : bus.nodes) {
    if (bus.configured.contains(node.node_id)) continue;
    for (const ReviewedPdo& pdo : node.pdos) {
      const auto mapping = static_cast<std::uint16_t>(pdo.index + 0x200);
      const auto count = node.objects.get<std::uint8_t>(mapping, 0);
      for (std::uint8_t sub = 1; sub <= count && count <= most_entries; ++sub) {
        const auto entry = node.objects.get<std::uint32_t>(mapping, sub);
        const auto index = static_cast<std::uint16_t>(entry >> 16);
        if (index < lowest_object) continue;
        const canopen::AbortCode wrong = canopen::check_mapping_entry(
            node.objects, entry,
            pdo.transmit ? canopen::PdoDirection::transmit : canopen::PdoDirection::receive);
        if (wrong == canopen::AbortCode::none) continue;
        warnings.push_back(
            {place_of(node, mapping, sub),
             fmt::format("{}: {} maps {}, {} bit, which it cannot carry: {}; the PDO is not used", node.name,
                         name(pdo), canopen::object_text(index, static_cast<std::uint8_t>(entry >> 8)),
                         entry & 0xFF, canopen::describe(wrong))});
      }
    }
  }
}

}  // namespace canopus::plant
