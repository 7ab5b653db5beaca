// Findings about nodes that wait for each other.

#include <array>
#include <map>

#include <fmt/format.h>

#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/plant/plant_review.hpp"

namespace canopus::plant {

namespace {

namespace assignment = manager::assignment_bit;
using manager::start_up_bit::flying_master;
using manager::start_up_bit::nmt_master;

/// Calls visit(sub, value) for each sub-index from 01H on of an array of UNSIGNED32.
template <typename Visit>
void for_each_member(const ReviewedNode& node, std::uint16_t index, Visit visit) {
  const canopen::ObjectDescription* object = node.objects.description().find(index);
  if (object == nullptr) return;
  for (unsigned sub = 1; sub <= object->highest_sub; ++sub) {
    visit(sub, node.objects.get<std::uint32_t>(index, static_cast<std::uint8_t>(sub)));
  }
}

/// The value is not just a default of the device's file: the plant file has it, a DCF for this node, or it was
/// stored.
bool is_set_for_this_network(const ReviewedNode& node, std::uint16_t index, std::uint8_t sub) {
  if (node.file == nullptr || is_set_by_plant_file(node, index, sub) || is_dcf_for(node)) return true;
  return eds::default_value(*node.file->dictionary, index, sub, node.node_id) !=
         node.objects.get<std::uint32_t>(index, sub);
}

}  // namespace

void find_missing_heartbeats(const ReviewedBus& bus, Warnings& warnings) {
  if (has_unknown_senders(bus)) return;
  for (const ReviewedNode& node : bus.nodes) {
    if (bus.configured.contains(node.node_id)) continue;
    for_each_member(node, 0x1016, [&](unsigned sub, std::uint32_t value) {
      const auto watched = static_cast<std::uint8_t>(value >> 16);
      const unsigned consumer_time = value & 0xFFFF;
      if (watched == 0 || watched > 127 || consumer_time == 0 || watched == node.node_id) return;
      if (bus.configured.contains(watched)) return;
      const ReviewedNode* producer = find(bus, watched);
      const std::string who = producer != nullptr ? producer->name : fmt::format("node {}", watched);
      const unsigned time = producer == nullptr ? 0 : producer->objects.get<std::uint16_t>(0x1017, 0);
      std::string why;
      if (time >= consumer_time) {
        why = fmt::format("one in {} ms at least, but its 1017H is {} ms: set a shorter time there",
                          consumer_time, time);
      } else if (time != 0 || !is_set_for_this_network(node, 0x1016, static_cast<std::uint8_t>(sub))) {
        return;  // monitoring starts with the first heartbeat: a default of the device file does no harm
      } else if (producer != nullptr) {
        why = "whose 1017H is 0: it sends none";
      } else if (has_unconfigured(bus) || bus.may_have_others) {
        return;  // a node may get that node-ID
      } else {
        why = fmt::format("which is not on bus \"{}\"", bus.name);
      }
      warnings.push_back(
          {place_of(node, 0x1016, static_cast<std::uint8_t>(sub)),
           fmt::format("{}: 1016:{:02X} waits for heartbeats of {}, {}", node.name, sub, who, why)});
    });
  }
}

void find_missing_slaves(const ReviewedBus& bus, Warnings& warnings) {
  if (bus.may_have_others || has_unconfigured(bus)) return;  // a node may get that node-ID
  for (const ReviewedNode& node : bus.nodes) {
    if ((start_up_of(node) & nmt_master) == 0) continue;
    for_each_member(node, 0x1F81, [&](unsigned slave, std::uint32_t value) {
      if ((value & assignment::slave) == 0 || slave == node.node_id || slave > 127) return;
      if (find(bus, static_cast<std::uint8_t>(slave)) != nullptr) return;
      const bool is_mandatory = (value & assignment::mandatory) != 0;
      warnings.push_back(
          {place_of(node, 0x1F81, static_cast<std::uint8_t>(slave)),
           fmt::format("{}: 1F81:{:02X} assigns node {} as a slave, which is not on bus \"{}\"{}", node.name,
                       slave, slave, bus.name,
                       is_mandatory ? ": mandatory (bit 3), so the network does not start without it" : "")});
    });
  }
}

void find_two_masters(const ReviewedBus& bus, Warnings& warnings) {
  const ReviewedNode* first = nullptr;
  for (const ReviewedNode& node : bus.nodes) {
    const std::uint32_t start_up = start_up_of(node);
    if ((start_up & nmt_master) == 0) continue;
    if (first == nullptr) {
      first = &node;
      continue;
    }
    if ((start_up & flying_master) != 0 && (start_up_of(*first) & flying_master) != 0) continue;
    warnings.push_back({place_of(node, 0x1F80, 0),
                        fmt::format("{} is NMT master of bus \"{}\", and {} (line {}) is, too: make one a "
                                    "slave, or both flying masters (1F80H bit 5)",
                                    node.name, bus.name, first->name, first->place.line)});
  }
}

void find_equal_lss_addresses(const ReviewedBus& bus, Warnings& warnings) {
  std::map<std::array<std::uint32_t, 4>, const ReviewedNode*> addresses;
  for (const ReviewedNode& node : bus.nodes) {
    const bool uses_lss = node.is_lss_slave && node.device != nullptr &&
                          (node.node_id > 127 || node.device->lss.value_or(false));
    if (!uses_lss) continue;
    std::array<std::uint32_t, 4> address{};
    for (std::uint8_t part = 0; part < 4; ++part) {
      address[part] = node.objects.get<std::uint32_t>(0x1018, static_cast<std::uint8_t>(part + 1));
    }
    const auto [first, is_new] = addresses.try_emplace(address, &node);
    if (is_new) continue;
    warnings.push_back(
        {node.place,
         fmt::format(
             "{} has the LSS address of {} in line {} (1018H: {:08X}H {:08X}H {:08X}H {:08X}H): LSS "
             "cannot distinguish them; give each its serial number, for example objects = {{ \"1018:04\" "
             "= 7 }}",
             node.name, first->second->name, first->second->place.line, address[0], address[1], address[2],
             address[3])});
  }
}

}  // namespace canopus::plant
