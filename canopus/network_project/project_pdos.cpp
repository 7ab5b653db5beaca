// PDOs of a project, written into DCFs.

#include <algorithm>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/network_project/network_project.hpp"

namespace canopus::network_project {
namespace {

using Done = NetworkProject::Done;

/// The COB-ID of the pre-defined connection set follows the node-ID.
std::string cob_id_text(const Pdo& pdo, std::uint8_t node_id) {
  const std::uint32_t base = (pdo.transmit ? 0x80U : 0x100U) + 0x100U * pdo.number;
  const bool is_predefined =
      pdo.number <= 4 && !pdo.cob_id.is_extended() && pdo.cob_id.identifier() == base + node_id;
  return is_predefined ? fmt::format("$NODEID+0x{:08X}", pdo.cob_id.raw - node_id)
                       : fmt::format("0x{:08X}", pdo.cob_id.raw);
}

}  // namespace

Done NetworkProject::set_pdo(std::uint8_t node_id, const Pdo& pdo) {
  const auto node = editable(node_id);
  if (!node) return std::unexpected(node.error());
  const auto& pdos = (*node)->pdos;
  const auto own = std::ranges::find_if(
      pdos, [&](const Pdo& one) { return one.transmit == pdo.transmit && one.number == pdo.number; });
  if (own == pdos.end())
    return std::unexpected(fmt::format("{} has no {}", (*node)->shown_name(), pdo.name()));
  const auto refuse = [&](std::string_view why) {
    return std::unexpected(fmt::format("{}: {} {}", (*node)->shown_name(), pdo.name(), why));
  };
  if (pdo.mapping != own->mapping && !own->can_change_mapping) return refuse("has a fixed mapping");
  if (pdo.mapping.size() > own->most_objects && pdo.mapping != own->mapping) {
    return refuse(fmt::format("maps at most {}", ascii::counted(own->most_objects, "object")));
  }
  if (pdo.bits() > 64) return refuse(fmt::format("would have {} bits; 64 at most", pdo.bits()));
  eds::DeviceText text = *(*node)->text;
  const auto set = [&](std::uint16_t index, std::size_t sub, const std::string& value) {
    return text.set_parameter_value(index, static_cast<std::uint8_t>(sub), value);
  };
  const std::uint16_t index = pdo.communication_index();
  if (pdo.cob_id.raw != own->cob_id.raw) {
    if (!own->can_change_cob_id) return refuse("has a fixed COB-ID");
    if (auto done = set(index, 1, cob_id_text(pdo, node_id)); !done) return done;
  }
  if (pdo.transmission_type != own->transmission_type) {
    if (auto done = set(index, 2, fmt::format("{}", pdo.transmission_type)); !done) return done;
  }
  if (pdo.inhibit_time != own->inhibit_time && pdo.inhibit_time) {
    if (auto done = set(index, 3, fmt::format("{}", *pdo.inhibit_time)); !done) return done;
  }
  if (pdo.event_timer != own->event_timer && pdo.event_timer) {
    if (auto done = set(index, 5, fmt::format("{}", *pdo.event_timer)); !done) return done;
  }
  if (pdo.mapping != own->mapping) {
    for (std::size_t i = 0; i < pdo.mapping.size(); ++i) {
      if (i < own->mapping.size() && own->mapping[i] == pdo.mapping[i]) continue;
      auto done = set(pdo.mapping_index(), i + 1, fmt::format("0x{:08X}", pdo.mapping[i].value()));
      if (!done) return done;
    }
    if (pdo.mapping.size() != own->mapping.size()) {
      auto done = set(pdo.mapping_index(), 0, fmt::format("{}", pdo.mapping.size()));
      if (!done) return done;
    }
  }
  put(**node, std::move(text));
  return {};
}

}  // namespace canopus::network_project
