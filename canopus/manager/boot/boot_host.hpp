#pragma once
// What the boot of a slave needs from its NMT master.

#include <cstdint>
#include <span>

#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/manager/boot/master_options.hpp"

namespace canopus::manager {

class BootHost {
 public:
  virtual const canopen::ObjectDictionary& dictionary() const = 0;
  virtual const MasterOptions& boot_options() const = 0;
  /// 1F81H of the node; 0 for the own node.
  virtual std::uint32_t assignment(std::uint8_t node_id) const = 0;
  /// Consumer time of 1016H for the node; 0 = not watched.
  virtual can::Duration heartbeat_time(std::uint8_t node_id) const = 0;
  virtual void send_nmt(canopen::NmtCommand command, std::uint8_t node_id, can::Time now) = 0;
  /// Sends one guarding remote frame.
  virtual void request_state(std::uint8_t node_id) = 0;
  /// 1F81H has guarding for the node, and 1016H does not watch it.
  virtual bool guards(std::uint8_t node_id) const = 0;
  /// Begins guarding with its first remote frame, if it guards() the node.
  virtual void start_guarding(std::uint8_t node_id, can::Time now) = 0;
  virtual std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) = 0;
  virtual Program open_program(std::uint8_t node_id) = 0;
  /// False: another user has a transfer with this node, or has waited for one. The boot then asks again
  /// after MasterOptions::busy_retry, or when channel_freed() is called.
  virtual bool sdo_channel_free(std::uint8_t node_id, can::Time now) = 0;
  /// A request to this node is in the queue, and the queue moves.
  virtual bool request_waits(std::uint8_t node_id, can::Time now) const = 0;
  /// Boots that have a block download going on.
  virtual unsigned blocks_running() const = 0;
  /// The slave answered 1000H, or did not.
  virtual void presence_known(std::uint8_t node_id, bool present, can::Time now) = 0;
  /// The boot is at another step, or at another object of the same one.
  virtual void boot_went_on(std::uint8_t node_id, const BootRecord& record, can::Time now) = 0;
  /// The boot ended; the record has the details.
  virtual void boot_ended(std::uint8_t node_id, BootError error, can::Time now) = 0;

 protected:
  ~BootHost() = default;
};

}  // namespace canopus::manager
