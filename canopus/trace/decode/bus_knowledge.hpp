#pragma once
// Identifiers and PDO mappings of one bus: which identifier belongs to which node's service, and how PDOs are
// mapped. They come from the nodes' descriptions and are updated by SDO traffic. The default is the
// pre-defined connection set [CiA 301 7.3.5].

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "canopus/can/frame.hpp"
#include "canopus/trace/decode/names.hpp"

namespace canopus::trace {

/// A PDO of a node.
struct PdoFacts {
  std::uint8_t node = 0;
  bool transmit = false;
  std::uint16_t number = 0;              ///< from 1
  std::vector<std::uint32_t> mapping{};  ///< entries as 16xxH and 1AxxH have them; empty: not known
  std::uint8_t mpdo = 0;                 ///< mapping sub-index 00H FEH or FFH, else 0
};

/// One side of an SDO channel.
struct SdoSide {
  std::uint8_t server = 0;  ///< node-ID
  bool from_client = false;
  std::uint16_t channel = 0;  ///< number of the node's SDO channel; 0: the default one
};

/// Identifier of a frame, bit 29 set when it is an extended one.
using FrameKey = std::uint32_t;
[[nodiscard]] constexpr FrameKey key_of(const can::Frame& frame) noexcept {
  return frame.identifier | (frame.extended ? 1U << 29 : 0U);
}

class BusKnowledge {
 public:
  explicit BusKnowledge(const std::vector<const NodeDescription*>& nodes);

  [[nodiscard]] const NodeDescription* node(std::uint8_t node_id) const noexcept;
  /// A node's object has this value now. Others than service settings are ignored.
  void learn(std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t value);
  [[nodiscard]] std::optional<std::uint32_t> setting(std::uint8_t node, std::uint16_t index,
                                                     std::uint8_t sub) const;

  [[nodiscard]] bool is_sync(FrameKey key) const { return key == 0x80 || sync_.contains(key); }
  [[nodiscard]] bool is_time(FrameKey key) const { return key == 0x100 || time_.contains(key); }
  /// Node whose EMCY has this identifier; 0: none.
  [[nodiscard]] std::uint8_t emcy_producer(FrameKey key) const;
  [[nodiscard]] std::optional<SdoSide> sdo(FrameKey key) const;
  /// The PDO of this identifier. Of several the one that the pre-defined connection set would name, else one that is
  /// transmitted.
  [[nodiscard]] const PdoFacts* pdo(FrameKey key) const;
  /// Identifiers that PDOs have, in order.
  [[nodiscard]] std::vector<FrameKey> pdo_identifiers() const;
  /// All that share the identifier.
  [[nodiscard]] const std::vector<PdoFacts>& pdos(FrameKey key) const;

 private:
  void use(std::uint8_t node, std::uint16_t index);
  void use_pdo(std::uint8_t node, std::uint16_t communication);
  void use_sdo(std::uint8_t node, std::uint16_t index);
  void use_identifier(std::unordered_map<FrameKey, std::uint8_t>& table, std::uint8_t node,
                      std::uint16_t index, bool has_invalid_bit);

  std::array<const NodeDescription*, 128> nodes_{};
  std::map<std::uint32_t, std::uint32_t> settings_;  // node, index, sub-index
  std::unordered_map<FrameKey, std::uint8_t> sync_, time_, emcy_;
  std::unordered_map<FrameKey, SdoSide> sdo_;
  std::unordered_map<FrameKey, std::vector<PdoFacts>> pdos_;
  std::map<std::uint32_t, FrameKey> pdo_keys_;  // node, communication index
};

}  // namespace canopus::trace
