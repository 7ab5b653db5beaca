#pragma once
// The nodes on the buses of a trace: their names, their device files, and how their services are set. A
// decoder works without; with it, lines carry names and PDOs their values.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/object_dictionary.hpp"

namespace canopus::trace {

/// A value of an object that sets services of a node up.
struct Setting {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint32_t value = 0;
  friend bool operator==(const Setting&, const Setting&) = default;
};

/// Objects that a decoder follows: COB-IDs, heartbeat and guarding times, SDO channels, PDO communication and
/// mapping.
[[nodiscard]] constexpr bool is_service_setting(std::uint16_t index) noexcept {
  return index == 0x1005 || index == 0x100C || index == 0x100D || index == 0x1012 || index == 0x1014 ||
         index == 0x1017 || (index >= 0x1200 && index <= 0x12FF) || (index >= 0x1400 && index <= 0x1BFF);
}

/// A node of a bus.
struct NodeDescription {
  std::string bus{};                                                   ///< empty: any channel
  std::uint8_t node_id = 0;                                            ///< 1..127
  std::string name{};                                                  ///< for people; may be empty
  std::shared_ptr<const canopen::DictionaryDescription> dictionary{};  ///< nullptr: not known
  std::vector<Setting> settings{};
};

/// The settings of a node as it stands.
[[nodiscard]] std::vector<Setting> settings_of(const canopen::ObjectDictionary& objects);

/// A node of a device file: its settings are the file's.
[[nodiscard]] NodeDescription describe_node(std::string bus, std::uint8_t node_id, std::string name,
                                            std::shared_ptr<const canopen::DictionaryDescription> dictionary);
/// A node as it stands.
[[nodiscard]] NodeDescription describe_node(std::string bus, std::uint8_t node_id, std::string name,
                                            canopen::ObjectDictionary objects);

class Names {
 public:
  /// A second node of the same bus and node-ID takes the place of the first.
  void add(NodeDescription node);
  [[nodiscard]] const std::vector<NodeDescription>& nodes() const noexcept { return nodes_; }
  /// The nodes that a channel of this name may have: those of the bus of that name and those of any bus. A
  /// channel that no bus is named after (a pcap has no names) has those node-IDs that are in but one bus.
  [[nodiscard]] std::vector<const NodeDescription*> on_channel(std::string_view channel) const;

 private:
  std::vector<NodeDescription> nodes_;
};

}  // namespace canopus::trace
