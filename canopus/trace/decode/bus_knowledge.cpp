#include "canopus/trace/decode/bus_knowledge.hpp"

#include <algorithm>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/nmt.hpp"

namespace canopus::trace {
namespace {

/// A trace can hold values without end; no real network has more.
constexpr std::size_t most_settings = 200'000;
constexpr std::size_t most_sdo_identifiers = 1000;

constexpr std::uint32_t place(std::uint8_t node, std::uint16_t index, std::uint8_t sub) noexcept {
  return std::uint32_t{node} << 24 | std::uint32_t{index} << 8 | sub;
}

/// Identifier of a PDO in the pre-defined connection set; 0: it has none.
constexpr std::uint32_t default_identifier(std::uint8_t node, bool transmit, std::uint16_t number) noexcept {
  if (number < 1 || number > 4) return 0;
  return (transmit ? 0x180U : 0x200U) + 0x100U * (number - 1U) + node;
}

}  // namespace

BusKnowledge::BusKnowledge(const std::vector<const NodeDescription*>& nodes) {
  for (const NodeDescription* node : nodes) {
    if (node->node_id < 1 || node->node_id > 127) continue;
    nodes_[node->node_id] = node;
    for (const Setting& setting : node->settings) {
      settings_[place(node->node_id, setting.index, setting.sub)] = setting.value;
    }
    std::uint16_t last = 0;
    for (const Setting& setting : node->settings) {
      if (setting.index != last) use(node->node_id, setting.index);
      last = setting.index;
    }
  }
}

const NodeDescription* BusKnowledge::node(std::uint8_t node_id) const noexcept {
  return node_id < nodes_.size() ? nodes_[node_id] : nullptr;
}

void BusKnowledge::learn(std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
  if (!is_service_setting(index) || settings_.size() > most_settings) return;
  settings_[place(node, index, sub)] = value;
  use(node, index);
}

std::optional<std::uint32_t> BusKnowledge::setting(std::uint8_t node, std::uint16_t index,
                                                   std::uint8_t sub) const {
  const auto found = settings_.find(place(node, index, sub));
  return found == settings_.end() ? std::nullopt : std::optional(found->second);
}

std::uint8_t BusKnowledge::emcy_producer(FrameKey key) const {
  if (const auto found = emcy_.find(key); found != emcy_.end()) return found->second;
  return key > 0x80 && key <= 0xFF ? static_cast<std::uint8_t>(key & 0x7FU) : std::uint8_t{0};
}

std::optional<SdoSide> BusKnowledge::sdo(FrameKey key) const {
  if (const auto found = sdo_.find(key); found != sdo_.end()) return found->second;
  const auto node = static_cast<std::uint8_t>(key & 0x7FU);
  const FrameKey base = key & ~FrameKey{0x7F};
  if (node == 0 || (base != canopen::cob_id::sdo_request && base != canopen::cob_id::sdo_response))
    return std::nullopt;
  return SdoSide{.server = node, .from_client = base == canopen::cob_id::sdo_request};
}

const std::vector<PdoFacts>& BusKnowledge::pdos(FrameKey key) const {
  static const std::vector<PdoFacts> none;
  const auto found = pdos_.find(key);
  return found == pdos_.end() ? none : found->second;
}

std::vector<FrameKey> BusKnowledge::pdo_identifiers() const {
  std::vector<FrameKey> keys;
  for (const auto& [key, pdos] : pdos_) keys.push_back(key);
  std::ranges::sort(keys);
  return keys;
}

const PdoFacts* BusKnowledge::pdo(FrameKey key) const {
  const std::vector<PdoFacts>& all = pdos(key);
  if (all.empty()) return nullptr;
  const auto usual = std::ranges::find_if(all, [&](const PdoFacts& pdo) {
    return default_identifier(pdo.node, pdo.transmit, pdo.number) == key;
  });
  if (usual != all.end()) return &*usual;
  const auto sent = std::ranges::find(all, true, &PdoFacts::transmit);
  return sent != all.end() ? &*sent : &all.front();
}

void BusKnowledge::use(std::uint8_t node, std::uint16_t index) {
  if (index == 0x1005) return use_identifier(sync_, node, index, false);
  if (index == 0x1012) return use_identifier(time_, node, index, false);
  if (index == 0x1014) return use_identifier(emcy_, node, index, true);
  if (index >= 0x1200 && index <= 0x12FF) return use_sdo(node, index);
  if (index >= 0x1400 && index <= 0x1BFF)
    use_pdo(node, static_cast<std::uint16_t>(index & ~std::uint16_t{0x200}));
}

void BusKnowledge::use_identifier(std::unordered_map<FrameKey, std::uint8_t>& table, std::uint8_t node,
                                  std::uint16_t index, bool has_invalid_bit) {
  std::erase_if(table, [&](const auto& entry) { return entry.second == node; });
  const auto value = setting(node, index, 0);
  if (!value) return;
  const canopen::CobId cob_id{*value};
  if (has_invalid_bit && !cob_id.is_valid()) return;
  if (!cob_id.is_extended() && (cob_id.identifier() == 0 || canopen::is_restricted(cob_id))) return;
  table.emplace(cob_id.key(), node);
}

void BusKnowledge::use_sdo(std::uint8_t node, std::uint16_t index) {
  const bool is_client = index >= 0x1280;
  std::uint8_t server = node;
  std::uint16_t channel = index;
  if (index == 0x1200) return;  // the default channel is fixed, a file cannot change it
  if (is_client) {
    server = static_cast<std::uint8_t>(setting(node, index, 3).value_or(0) & 0x7FU);
    channel = static_cast<std::uint16_t>(index | node << 8);
  }
  std::erase_if(sdo_, [&](const auto& entry) {
    return entry.second.channel == channel && (is_client || entry.second.server == node);
  });
  const auto request = setting(node, index, 1), response = setting(node, index, 2);
  if (!request || !response || server == 0) return;
  const canopen::CobId asks{*request}, answers{*response};
  if (!asks.is_valid() || !answers.is_valid() || asks.identifier() == 0 || answers.identifier() == 0) return;
  const auto is_default = [&](canopen::CobId cob_id, std::uint32_t base) {
    return cob_id.key() == base + server;
  };
  if (is_default(asks, canopen::cob_id::sdo_request) && is_default(answers, canopen::cob_id::sdo_response))
    return;
  if (sdo_.size() >= most_sdo_identifiers) return;
  sdo_.insert_or_assign(asks.key(), SdoSide{server, true, channel});
  sdo_.insert_or_assign(answers.key(), SdoSide{server, false, channel});
}

void BusKnowledge::use_pdo(std::uint8_t node, std::uint16_t communication) {
  const std::uint32_t record = place(node, communication, 0);
  if (const auto old = pdo_keys_.find(record); old != pdo_keys_.end()) {
    auto& others = pdos_[old->second];
    std::erase_if(others, [&](const PdoFacts& pdo) {
      return pdo.node == node && pdo.transmit == (communication >= 0x1800) &&
             pdo.number == (communication & 0x1FFU) + 1;
    });
    if (others.empty()) pdos_.erase(old->second);
    pdo_keys_.erase(old);
  }
  PdoFacts pdo{.node = node,
               .transmit = communication >= 0x1800,
               .number = static_cast<std::uint16_t>((communication & 0x1FFU) + 1)};
  const auto entry = setting(node, communication, 1);
  canopen::CobId cob_id{entry.value_or(default_identifier(node, pdo.transmit, pdo.number))};
  if (!cob_id.is_valid() || cob_id.identifier() == 0) return;
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200U);
  const std::uint32_t count = setting(node, mapping, 0).value_or(0) & 0xFFU;
  if (count >= 0xFE) pdo.mpdo = static_cast<std::uint8_t>(count);
  for (std::uint8_t sub = 1; count <= 64 && sub <= count; ++sub) {
    const auto mapped = setting(node, mapping, sub);
    if (!mapped) {
      pdo.mapping.clear();
      break;
    }
    pdo.mapping.push_back(*mapped);
  }
  pdos_[cob_id.key()].push_back(std::move(pdo));
  pdo_keys_[record] = cob_id.key();
}

}  // namespace canopus::trace
