#pragma once
// Concise DCFs of the NMT slaves in a module: its configuration manager, whose files lie together as one
// content of the non-volatile memory. What is written to 1F22H goes there at once [ME3CAN1-Q 4.8.12].

#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/manager/configuration/configuration_manager.hpp"
#include "canopus/module/interface/non_volatile_memory.hpp"

namespace canopus::module {

class ConciseDcfStore final : private manager::ConfigurationStore {
 public:
  /// Attaches its configuration manager to the node's dictionary and to the master. `name` is the content's
  /// in `memory`. No file may be larger than 65535 bytes. All must outlive it.
  ConciseDcfStore(canopen::Node& node, manager::NmtMaster& master, NonVolatileMemory& memory,
                  std::string_view name, const manager::ConfigurationOptions& options);

  /// The files become what is stored: after each reset of the node. False when it is damaged; there are no
  /// files then.
  bool load();
  /// The nodes that the next load() finds a file of. Changes nothing.
  [[nodiscard]] std::vector<std::uint8_t> stored_nodes();
  /// The flash memory is busy with something else until then: 1F22H is refused with 06060000H.
  void occupy(can::Time until) noexcept { configurations_.occupy_store(until); }
  /// Puts these files among what is stored: one for a node that has one takes its place, the others stay. At the next
  /// load() they count. False: more than there is room for, one that is too long, or they could not be written; then
  /// nothing has changed. `changed`: something was written.
  [[nodiscard]] bool merge(const std::map<std::uint8_t, std::vector<std::uint8_t>>& files, bool& changed);
  [[nodiscard]] const manager::ConfigurationOptions& limits() noexcept { return configurations_.options(); }
  /// Of a node; empty: there is none.
  [[nodiscard]] std::span<const std::uint8_t> file(std::uint8_t node_id) const noexcept {
    return configurations_.file(node_id);
  }
  /// Deletes all of them.
  void clear();

 private:
  bool store(std::uint8_t node_id, std::span<const std::uint8_t> file) override;
  void forget_all();

  NonVolatileMemory* memory_;
  std::string_view name_;
  manager::ConfigurationManager configurations_;
};

}  // namespace canopus::module
