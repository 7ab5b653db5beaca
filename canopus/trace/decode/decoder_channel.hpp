#pragma once
// The state of a decoder for one channel.

#include <array>
#include <bitset>
#include <deque>
#include <map>
#include <optional>

#include "canopus/trace/decode/decoder.hpp"

namespace canopus::trace {

struct Decoder::Channel {
  explicit Channel(const std::vector<const NodeDescription*>& nodes) : knowledge(nodes) {}

  [[nodiscard]] const ObjectFacts& facts(std::uint8_t node, std::uint16_t index, std::uint8_t sub) {
    const std::uint32_t place = std::uint32_t{node} << 24 | std::uint32_t{index} << 8 | sub;
    const auto known = known_facts.find(place);
    if (known != known_facts.end()) return known->second;
    if (known_facts.size() > 10'000) known_facts.clear();
    return known_facts.emplace(place, object_facts(dictionary(node), index, sub)).first->second;
  }
  [[nodiscard]] const canopen::DictionaryDescription* dictionary(std::uint8_t node) const {
    const NodeDescription* const description = knowledge.node(node);
    return description == nullptr ? nullptr : description->dictionary.get();
  }

  BusKnowledge knowledge;
  std::uint16_t number = 0;
  std::map<std::uint32_t, SdoChannel> sdo;         // server, channel
  std::bitset<128> guarded;                        // a guarding request is not answered yet
  std::array<std::optional<bool>, 128> toggles{};  // of the last error control message of each node
  std::deque<Message> sent;                        // by the recorder itself, not received yet
  std::map<std::uint32_t, ObjectFacts> known_facts;
  can::Time next_expiry{};
};

}  // namespace canopus::trace
