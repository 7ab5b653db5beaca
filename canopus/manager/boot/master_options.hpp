#pragma once
// How a master behaves where CiA 302 leaves a choice or a product's manual differs, and what it reports of
// itself. Every time has the manual's or the standard's default.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/object_stream.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/manager/boot/start_up_bits.hpp"

namespace canopus::manager {

/// When a slave's revision number satisfies 1F87H.
enum class RevisionRule : std::uint8_t {
  equal,                   ///< CiA 302-2
  same_major_newer_minor,  ///< high words equal, low word at least the expected one [RJ71CN91]
};

struct MasterOptions {
  /// Least pause between Reset communication all nodes and Start all nodes [ME3CAN1-Q G70].
  can::Duration start_all_delay = std::chrono::milliseconds(500);
  /// start_all_delay is the least pause before every reset and start of the start-up, whatever NMT command was sent before
  /// [RJ71CN91 App. 2 G70].
  bool delay_before_each_command = false;
  /// Where some slaves are to be kept alive, the other slaves are reset one by one; else every other node of the network is
  /// [RJ71CN91 1.2 NMT start-up].
  bool resets_slaves_alone = false;
  /// An SDO request of the start-up is given up after this [ME3CAN1-Q G71].
  can::Duration sdo_time_out = std::chrono::milliseconds(500);
  /// After a reset, a slave is first asked for 1000H when its boot-up message came or this is over.
  can::Duration wait_after_reset = std::chrono::seconds(1);
  /// Pause before a slave that did not answer is asked for 1000H again [ME3CAN1-Q 4.8.6].
  can::Duration presence_retry = std::chrono::seconds(1);
  /// The pause counts from the request, not from its time-out, which it does not shorten [FX3U-CAN 5.8.6].
  bool presence_retry_counts_from_request = false;
  /// A guarding remote frame of the start-up must be answered within this [ME3CAN1-Q 4.8.6].
  can::Duration guarding_probe = std::chrono::milliseconds(100);
  /// How long a slave that was reset in the middle of its boot may take to its boot-up message.
  can::Duration boot_up_time_out = std::chrono::seconds(1);
  /// On a full bus the boot-up message, which has the lowest priority of all, may come later than SDO
  /// answers. One that comes within this time after a reset, after the slave has answered, is taken for that
  /// reset's.
  can::Duration late_boot_up = std::chrono::seconds(10);
  /// Pause before an SDO channel that is in use is tried again (MasterListener::sdo_channel_free).
  can::Duration busy_retry = std::chrono::milliseconds(10);
  /// Values of the configuration of so many bytes and more go in SDO blocks, which is fewer frames from 22
  /// bytes on, and segmented if the slave does not know blocks; 0 = never in blocks. Programs always try.
  std::size_t block_from = 22;
  /// So many block downloads go on side by side: the segments of more would come so far apart on a slow bus
  /// that the slaves take them for lost.
  unsigned blocks_at_once = 16;
  /// Program download: clearing and writing a flash memory may take longer than other answers.
  can::Duration program_time_out = std::chrono::seconds(5);
  /// So often is the program cleared when no answer comes.
  unsigned program_clear_attempts = 4;
  /// Pause between two questions for 1F57H or 1F51H, and between two attempts to clear.
  can::Duration program_poll = std::chrono::milliseconds(100);
  /// The flash memory may be busy for so long after the download; 0 = no limit.
  can::Duration program_flash_limit = std::chrono::seconds(60);
  /// The new program may take so long to run; 0 = no limit.
  can::Duration program_start_limit = std::chrono::seconds(60);
  /// A slave that restarts in the middle of its update is updated again, so often until it succeeds.
  unsigned program_attempts = 3;
  /// The reset of a lost slave: 82H in the manuals of the modules, 81H in some other stacks.
  canopen::NmtCommand error_reset = canopen::NmtCommand::reset_communication;
  /// Of the own controller, bit/s. 0: missing slaves are not looked for by LSS.
  std::uint32_t bit_rate = 0;
  RevisionRule revision_rule = RevisionRule::equal;
  /// Bits of 1F80H and of the configuration byte of 1F81H that exist; others are refused with 06090030H.
  std::uint32_t start_up_bits = start_up_bit::all;
  std::uint8_t assignment_bits = assignment_bit::all;
  /// 1F82H of a node that is a slave, or a flying master that stands by, works for other nodes, too, and for itself
  /// [RJ71CN91 1.2 Node control]; else it is refused with not_master.
  bool slaves_request_nmt = false;
  /// 1F82H or 1F83H written while this node is not the active master.
  canopen::AbortCode not_master = canopen::AbortCode::device_state;
  /// A flying master without 1017H sends its heartbeat so often [ME3CAN1-Q 4.8.10].
  can::Duration flying_heartbeat = std::chrono::seconds(1);
  /// One that stands by and does not watch the active master by 1016H does so with this time, plus 10 ms x
  /// own node-ID [ME3CAN1-Q 4.8.10].
  can::Duration flying_consumer_time = std::chrono::milliseconds(1500);
  /// A guarding answer that was sent before a state change could take effect is not held against the slave
  /// for this long after the NMT command.
  can::Duration state_change_grace = std::chrono::milliseconds(50);
  /// error_control::guarding_active and heartbeat_active end with the time-out, until it is alive again
  /// [RJ71CN91 App. 2 G401].
  bool time_out_ends_activity = false;
  /// Heartbeats are compared with the state that this node has commanded, or with the first one: error_control::unexpected_state,
  /// and no error control event [RJ71CN91 1.9]. Without a command the first guarding answer is expected, too [RJ71CN91 1.8].
  bool heartbeat_state_is_checked = false;
  /// Bit 2 of 1F81H is about slaves that are lost or restart alone: without it nothing is done for them. The start-up starts
  /// every slave, and so does its assignment [CiA DS-302 V2; FX2N-32CAN 8.2.2].
  bool boot_bit_is_for_recovery = false;
  /// A guarding answer with the wrong toggle bit is error_control::toggle_error; else a missing one [FX2N-32CAN 8.2.7].
  bool toggle_error_is_shown = false;
  /// A command to all nodes is shown at those that were never seen, too [FX3U-CAN 6.22]. Decides besides which nodes
  /// are shown as missing.
  bool commands_show_all_nodes = false;
  /// The retry factor of 1F81H counts repetitions of a guarding request: a node is lost when neither the request nor that many
  /// repetitions were answered, each within the guard time [FX2N-32CAN 8.2.3]. Else it is lost after guard time x retry
  /// factor without an answer.
  bool guarding_is_repeated = false;
  /// An entry of the concise DCF that the slave refuses as read only (06010002H) is left out [ME3CAN1-Q 4.8.12;
  /// FX3U-CAN 5.8.13]. Else it ends the configuration, as any other abort does [CiA 302-2].
  bool configuration_skips_read_only = false;
};

/// Why an error control event happened.
enum class ErrorControlEvent : std::uint8_t {
  heartbeat_lost,    ///< the consumer time of 1016H elapsed
  node_lost,         ///< guarding: the node's life time elapsed
  unexpected_state,  ///< guarding: the node is not in the state it was commanded to
};

/// Bits of NmtMaster::error_control(), as the modules' NMT error control status words have them
/// [ME3CAN1-Q 3.5.15].
namespace error_control {
inline constexpr std::uint16_t guarding_active = 0x01;
inline constexpr std::uint16_t heartbeat_active = 0x02;  ///< since the first heartbeat
inline constexpr std::uint16_t guarding_miss = 0x04;     ///< an answer was missed or its toggle bit wrong
inline constexpr std::uint16_t node_lost = 0x08;         ///< life time elapsed
inline constexpr std::uint16_t start_up_failed = 0x10;
inline constexpr std::uint16_t unexpected_state = 0x20;
inline constexpr std::uint16_t life_guarding = 0x40;  ///< this node as slave misses its master's remote frame
inline constexpr std::uint16_t heartbeat_missing = 0x80;
inline constexpr std::uint16_t toggle_error = 0x100;  ///< MasterOptions::toggle_error_is_shown
inline constexpr std::uint16_t errors = 0x1FC;        ///< all but the two that say what is running
}  // namespace error_control

/// NMT state of a node as 1F82H reads it.
namespace node_state {
inline constexpr std::uint8_t unknown = 0x00;
inline constexpr std::uint8_t missing = 0x01;
inline constexpr std::uint8_t stopped = 0x04;
inline constexpr std::uint8_t operational = 0x05;
inline constexpr std::uint8_t reset_communication = 0x07;  ///< own node only
inline constexpr std::uint8_t pre_operational = 0x7F;
}  // namespace node_state

/// What a master reports to the application around it. Every function has an empty default. Functions of the
/// master may be called from inside.
class MasterListener {
 public:
  /// This node became the active NMT master, or is not any longer.
  virtual void active_changed(bool /*active*/, can::Time) {}
  /// The start-up of slaves is in progress, or has ended (NmtMaster::starting()).
  virtual void starting_changed(bool /*starting*/, can::Time) {}
  /// All mandatory slaves are booted, the slaves that are to be started were started.
  virtual void start_up_finished(can::Time) {}
  /// The start-up ended because of this mandatory slave, and is disabled until the next start().
  virtual void start_up_halted(std::uint8_t /*node_id*/, BootError, can::Time) {}
  /// The boot of a slave is at another step, or at another object of the same one; booted and failed are
  /// steps, too. explain() says it in words. The master must not be started or stopped from inside.
  virtual void boot_went_on(std::uint8_t /*node_id*/, const BootRecord&, can::Time) {}
  /// Missing slaves are being looked for by LSS (NmtMaster::lss_active()), or no longer.
  virtual void lss_active_changed(bool /*active*/, can::Time) {}
  /// The LSS search wants the own controller restarted with this bit rate (bit/s). While it is not
  /// MasterOptions::bit_rate, the own node is off its network and must not send.
  virtual void change_bit_rate(std::uint32_t /*bit_rate*/, can::Time) {}
  /// The search for this slave ended. `found`: it was given this node-ID and the network's bit rate.
  virtual void lss_search_ended(std::uint8_t /*node_id*/, bool /*found*/, can::Time) {}
  virtual void slave_booted(std::uint8_t /*node_id*/, can::Time) {}
  virtual void slave_failed(std::uint8_t /*node_id*/, BootError, can::Time) {}
  virtual void error_control_event(std::uint8_t /*node_id*/, ErrorControlEvent, can::Time) {}
  /// A node that had an error control event is alive again.
  virtual void error_control_resolved(std::uint8_t /*node_id*/, can::Time) {}
  /// NmtMaster::node_state(node_id) changed.
  virtual void node_state_changed(std::uint8_t /*node_id*/, std::uint8_t /*state*/, can::Time) {}
  /// NmtMaster::error_control(node_id) changed.
  virtual void error_control_changed(std::uint8_t /*node_id*/, std::uint16_t /*bits*/, can::Time) {}
  /// False while the application itself has an SDO transfer with this node on the default channel; the
  /// start-up then tries again a little later.
  virtual bool sdo_channel_free(std::uint8_t /*node_id*/) { return true; }

 protected:
  ~MasterListener() = default;
};

/// A program that is to be downloaded [CiA 302-3 1F58H].
struct Program {
  canopen::ByteSource* bytes = nullptr;  ///< from its first byte on; nullptr: there is none
  std::optional<std::uint32_t> size{};   ///< in bytes, if it is known
};

/// Where the configurations and programs of the slaves come from [CiA 302-3].
class ConfigurationSource {
 public:
  /// The concise DCF for this node, as 1F22H holds it; empty = none. The bytes must stay valid and unchanged
  /// while NmtMaster::configuring(node_id).
  virtual std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) = 0;
  /// The program for this node, from its beginning at each call. It is read piece by piece while
  /// NmtMaster::boot_record(node_id).step is program_download.
  virtual Program open_program(std::uint8_t /*node_id*/) { return {}; }

 protected:
  ~ConfigurationSource() = default;
};

}  // namespace canopus::manager
