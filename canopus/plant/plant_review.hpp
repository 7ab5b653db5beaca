#pragma once
// Checks across the sections of a plant file: how the nodes of a bus fit together at power-on, by their
// device files, the plant file and their stores. No finding prevents the start of a plant; each one is
// certain for this plant, and states what will not work, and why.

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/file/plant_file.hpp"

namespace canopus::plant {

/// A PDO that a node sends or takes: valid, with a CAN-ID it may have, and something mapped.
struct ReviewedPdo {
  bool transmit = false;
  std::uint16_t index = 0;  ///< of its communication record, 1400H or 1800H on
  unsigned number = 0;      ///< from 1
  canopen::CobId cob_id{};
  std::uint8_t transmission_type = 0;
};

/// A node as it will be when it is switched on.
struct ReviewedNode {
  text::Place place{};
  std::string name;                   ///< "node 3 (encoder)"
  std::uint8_t node_id = 0;           ///< FFH: none yet
  canopen::ObjectDictionary objects;  ///< its values
  bool produces_sync = false;
  bool drives = true;                                          ///< false: it only listens
  const std::vector<text::ObjectSetting>* settings = nullptr;  ///< `objects` of its section
  const DeviceSection* device = nullptr;                       ///< of a device: its section,
  const eds::DeviceFile* file = nullptr;                       ///< its file,
  bool is_lss_slave = false;                                   ///< and whether LSS can set it
  std::vector<ReviewedPdo> pdos{};                             ///< active_pdos()
  std::uint32_t bit_rate = 0;                                  ///< bit/s; 0: that of its bus
};
[[nodiscard]] ReviewedNode reviewed(const DeviceSection& section, DeviceOnBus& seat);
[[nodiscard]] ReviewedNode reviewed(const ModuleSection& section, std::string_view name,
                                    module::CommunicationModule::InitialNode node);

/// The CANopen nodes of a bus.
struct ReviewedBus {
  std::string_view name;
  std::uint32_t bit_rate = 0;  ///< bit/s; 0: not known
  std::vector<ReviewedNode> nodes{};
  bool may_have_others = false;         ///< other programs can be nodes of it, too
  bool has_plain_can = false;           ///< a module in a Layer 2 mode may send any frame
  std::set<std::uint8_t> configured{};  ///< nodes whose objects a master writes before they start
};

/// The PDO with this communication record (1400H or 1800H on) carries something.
[[nodiscard]] bool maps_something(const ReviewedNode& node, std::uint16_t communication) noexcept;
/// Those of its objects, which ReviewedNode::pdos holds.
[[nodiscard]] std::vector<ReviewedPdo> active_pdos(const ReviewedNode& node);
/// "TPDO3"
[[nodiscard]] std::string name(const ReviewedPdo& pdo);
/// The node with this node-ID, or nullptr.
[[nodiscard]] const ReviewedNode* find(const ReviewedBus& bus, std::uint8_t node_id) noexcept;
/// A device waits for its node-ID, which may be any.
[[nodiscard]] bool has_unconfigured(const ReviewedBus& bus) noexcept;
/// A program outside of the plant is probably the NMT master here, or a module's program sends frames: its
/// frames and settings are unknown.
[[nodiscard]] bool has_unknown_senders(const ReviewedBus& bus) noexcept;
/// 1F80H. A device's is 0: a device is always a slave, only modules become masters.
[[nodiscard]] std::uint32_t start_up_of(const ReviewedNode& node) noexcept;
/// `objects` of its section has this one.
[[nodiscard]] bool is_set_by_plant_file(const ReviewedNode& node, std::uint16_t index,
                                        std::uint8_t sub) noexcept;
/// Its file is a DCF that was made for its node-ID.
[[nodiscard]] bool is_dcf_for(const ReviewedNode& node) noexcept;
/// The place where the plant file sets the object; else the node's.
[[nodiscard]] text::Place place_of(const ReviewedNode& node, std::uint16_t index, std::uint8_t sub) noexcept;

using Warnings = std::vector<text::FileWarning>;

// --- one finding each

/// COB-IDs that no node uses, because CiA 301 restricts their CAN-ID.
void find_restricted_identifiers(const ReviewedBus& bus, Warnings& warnings);
/// Synchronous PDOs of a node without SYNC: no node produces it, or the node has no 1005H.
void find_missing_sync(const ReviewedBus& bus, Warnings& warnings);
/// Two nodes that send one CAN-ID.
void find_two_senders(const ReviewedBus& bus, Warnings& warnings);
/// COB-IDs of the pre-defined connection set that a device file has for another node-ID than the device's.
void find_cob_ids_of_another_node(const ReviewedBus& bus, Warnings& warnings);
/// Heartbeat consumers (1016H) whose producer is missing, sends no heartbeat, or too seldom.
void find_missing_heartbeats(const ReviewedBus& bus, Warnings& warnings);
/// Slaves of a master (1F81H) that are not on the bus.
void find_missing_slaves(const ReviewedBus& bus, Warnings& warnings);
/// Two NMT masters that do not compete as flying masters.
void find_two_masters(const ReviewedBus& bus, Warnings& warnings);
/// Nodes with another bit rate than their bus.
void find_other_bit_rates(const ReviewedBus& bus, Warnings& warnings);
/// Drives ([device.drive]) whose 6502H has no mode that is simulated: they do not move.
void find_drives_without_modes(const ReviewedBus& bus, Warnings& warnings);
/// PDOs that map an object which the node does not have or that no such PDO can carry [CiA 301 7.5.2.36].
void find_unmappable_objects(const ReviewedBus& bus, Warnings& warnings);
/// LSS slaves that LSS cannot distinguish.
void find_equal_lss_addresses(const ReviewedBus& bus, Warnings& warnings);

/// Reasons why a bus with a [bus.line] cannot work: its length and bit rate, or its clocks [ISO 11898-1 bit
/// timing].
void find_line_troubles(const BusSection& bus, Warnings& warnings);

/// All of them but find_line_troubles().
void review(const ReviewedBus& bus, Warnings& warnings);

}  // namespace canopus::plant
