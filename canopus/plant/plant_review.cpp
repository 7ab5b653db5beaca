#include "canopus/plant/plant_review.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/service/device_profile.hpp"
#include "canopus/lss/lss.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"

namespace canopus::plant {

namespace {

constexpr std::uint8_t most_mapped = 64;

using Finding = void (*)(const ReviewedBus&, Warnings&);
constexpr Finding findings[] = {
    find_restricted_identifiers,
    find_missing_sync,
    find_two_senders,
    find_cob_ids_of_another_node,
    find_missing_heartbeats,
    find_missing_slaves,
    find_two_masters,
    find_equal_lss_addresses,
    find_other_bit_rates,
    find_drives_without_modes,
    find_unmappable_objects,
};

}  // namespace

ReviewedNode reviewed(const DeviceSection& section, DeviceOnBus& seat) {
  DeviceOnBus::InitialNode begin = seat.initial_node();
  std::string name(seat.status().label.name);
  if (name.empty()) name = std::filesystem::path(section.eds).filename().string();
  if (begin.node_id != lss::unconfigured) name = fmt::format("node {} ({})", begin.node_id, name);
  ReviewedNode node{.place = section.place,
                    .name = std::move(name),
                    .node_id = begin.node_id,
                    .objects = std::move(begin.objects),
                    .drives = !section.listen_only,
                    .settings = &section.objects,
                    .device = &section,
                    .file = &seat.device().file(),
                    .is_lss_slave = seat.device().lss() != nullptr,
                    .bit_rate = section.bit_rate};
  const canopen::CobId sync{node.objects.get<std::uint32_t>(0x1005, 0)};
  node.produces_sync = node.drives && sync.has_bit_30() && !canopen::is_restricted(sync) &&
                       node.objects.get<std::uint32_t>(0x1006, 0) != 0;
  node.pdos = active_pdos(node);
  return node;
}

ReviewedNode reviewed(const ModuleSection& section, std::string_view name,
                      module::CommunicationModule::InitialNode node) {
  ReviewedNode all{.place = section.place,
                   .name = fmt::format("node {} ({})", node.node_id, name),
                   .node_id = node.node_id,
                   .objects = std::move(node.objects),
                   .produces_sync = node.produces_sync,
                   .settings = &section.objects,
                   .bit_rate = node.bit_rate};
  all.pdos = active_pdos(all);
  return all;
}

bool maps_something(const ReviewedNode& node, std::uint16_t communication) noexcept {
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  const auto count = node.objects.get<std::uint8_t>(mapping, 0);
  if (count > most_mapped) return true;  // an MPDO has always eight bytes
  for (unsigned sub = 1; sub <= count; ++sub) {
    if ((node.objects.get<std::uint32_t>(mapping, static_cast<std::uint8_t>(sub)) & 0xFF) != 0) return true;
  }
  return false;
}

std::vector<ReviewedPdo> active_pdos(const ReviewedNode& node) {
  std::vector<ReviewedPdo> pdos;
  const std::uint32_t permitted =
      canopen::permitted_pdo_identifier(node.objects.get<std::uint32_t>(0x1000, 0));
  for (const canopen::ObjectDescription& object : node.objects.description().objects(0x1400, 0x19FF)) {
    const bool transmit = object.index >= 0x1800 && object.index <= 0x19FF;
    if (!transmit && object.index > 0x15FF) continue;
    if (transmit && !node.drives) continue;
    const auto raw = node.objects.get<std::uint32_t>(object.index, 1, canopen::CobId::invalid_bit);
    const canopen::CobId cob_id = canopen::usable(canopen::CobId{raw}, permitted);
    if (!cob_id.is_valid() || !maps_something(node, object.index)) continue;
    pdos.push_back({.transmit = transmit,
                    .index = object.index,
                    .number = (object.index & 0x1FFU) + 1,
                    .cob_id = cob_id,
                    .transmission_type = node.objects.get<std::uint8_t>(object.index, 2, 0xFF)});
  }
  return pdos;
}

std::string name(const ReviewedPdo& pdo) {
  return fmt::format("{}PDO{}", pdo.transmit ? 'T' : 'R', pdo.number);
}

const ReviewedNode* find(const ReviewedBus& bus, std::uint8_t node_id) noexcept {
  const auto found = std::ranges::find(bus.nodes, node_id, &ReviewedNode::node_id);
  return found == bus.nodes.end() ? nullptr : &*found;
}

bool has_unconfigured(const ReviewedBus& bus) noexcept { return find(bus, lss::unconfigured) != nullptr; }

bool has_unknown_senders(const ReviewedBus& bus) noexcept {
  const auto is_master = [](const ReviewedNode& node) {
    return (start_up_of(node) & manager::start_up_bit::nmt_master) != 0;
  };
  return bus.has_plain_can || (bus.may_have_others && std::ranges::none_of(bus.nodes, is_master));
}

std::uint32_t start_up_of(const ReviewedNode& node) noexcept {
  return node.device != nullptr ? 0U : node.objects.get<std::uint32_t>(0x1F80, 0);
}

bool is_set_by_plant_file(const ReviewedNode& node, std::uint16_t index, std::uint8_t sub) noexcept {
  return std::ranges::find(*node.settings, text::ObjectName{index, sub}, &text::ObjectSetting::object) !=
         node.settings->end();
}

bool is_dcf_for(const ReviewedNode& node) noexcept {
  return node.file != nullptr && node.file->commissioning &&
         node.file->commissioning->node_id.value_or(0) == node.node_id;
}

text::Place place_of(const ReviewedNode& node, std::uint16_t index, std::uint8_t sub) noexcept {
  const auto setting =
      std::ranges::find(*node.settings, text::ObjectName{index, sub}, &text::ObjectSetting::object);
  return setting != node.settings->end() ? setting->place : node.place;
}

void review(const ReviewedBus& bus, Warnings& warnings) {
  for (const Finding finding : findings) finding(bus, warnings);
}

}  // namespace canopus::plant
