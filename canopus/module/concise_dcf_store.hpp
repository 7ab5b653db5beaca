#pragma once
// Concise DCFs of the NMT slaves, as the configuration manager keeps them [CiA 302-3; ME3CAN1-Q 4.8.12]:
// 1F22H:n holds the one of node n. What is written there goes to the non-volatile memory at once; a used
// sub-index has to be deleted (one byte 0) before it takes another; while a deletion runs nothing is taken.
// 1F25H asks for a download.

#include <cstdint>
#include <span>
#include <string_view>

#include "canopus/canopen/node.hpp"
#include "canopus/manager/nmt_master.hpp"
#include "canopus/module/non_volatile_memory.hpp"

namespace canopus::module {

struct ConciseDcfLimits {
  std::size_t files = 60;
  std::size_t bytes = 65531;  ///< of one file; at most 65535
  can::Duration erase_time = std::chrono::seconds(2);
};

class ConciseDcfStore final : public canopen::ObjectHandler, public manager::ConfigurationSource {
 public:
  /// Attaches itself to 1F22H and 1F25H of the node's dictionary and to the master. `name` is the blob's in
  /// `memory`.
  ConciseDcfStore(canopen::Node& node, manager::NmtMaster& master, NonVolatileMemory& memory,
                  std::string_view name, const ConciseDcfLimits& limits);

  /// Puts what is stored into 1F22H: after each reset of the node's dictionary. False when it is damaged.
  bool load();
  /// Deletes all of them, in the dictionary too.
  void clear();

  std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) override;
  canopen::AbortCode before_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                  std::span<const std::uint8_t> value, can::Time now) override;
  void after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                   can::Time now) override;

 private:
  [[nodiscard]] std::span<const std::uint8_t> file(std::uint8_t node_id) const;
  [[nodiscard]] std::size_t count() const;
  canopen::AbortCode check_file(std::uint8_t node_id, std::span<const std::uint8_t> value, can::Time now);
  canopen::AbortCode request(std::uint8_t sub, std::span<const std::uint8_t> value, can::Time now);
  [[nodiscard]] bool save(std::uint8_t changed, std::span<const std::uint8_t> value);

  canopen::Node* node_;
  manager::NmtMaster* master_;
  NonVolatileMemory* memory_;
  std::string_view name_;
  ConciseDcfLimits limits_;
  can::Time busy_until_{};
};

}  // namespace canopus::module
