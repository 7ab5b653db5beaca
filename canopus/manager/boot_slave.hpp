#pragma once
// "Boot slave": the way of one slave from its reset to its start [CiA 302-2; ME3CAN1-Q 4.8.6, notes B8]:
//
//   (wait after reset) - presence: 1000H - identity: 1018H - [keep alive: its state]
//   - [software: 1F56H compared; if it differs: stop, clear, download, flash status, compared again, start;
//                then from presence on once more]
//   - [restore: 1011H, its boot-up] - [configuration: 1020H compared, concise DCF]
//   - error control: heartbeat or guarding - booted
//
// boot_slave.cpp has the frame of it, boot_slave_configuration.cpp and boot_slave_software.cpp the steps in
// the middle. One SDO transfer at a time on the slave's default channel. A slave that does not answer is
// asked again without end; whether that is too long is decided by the host (boot time). The start command
// itself is the host's as well: it depends on what the other slaves do.

#include <cstdint>
#include <expected>
#include <span>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/nmt.hpp"
#include "canopus/canopen/object_dictionary.hpp"
#include "canopus/canopen/sdo_client.hpp"
#include "canopus/manager/boot_record.hpp"
#include "canopus/manager/concise_dcf.hpp"
#include "canopus/manager/master_options.hpp"

namespace canopus::manager {

/// What a boot needs from its master.
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
  virtual void ask_state(std::uint8_t node_id) = 0;
  /// 1F81H has guarding for the node, and 1016H does not watch it.
  virtual bool guards(std::uint8_t node_id) const = 0;
  /// Begins guarding with its first remote frame, if it guards() the node.
  virtual void start_guarding(std::uint8_t node_id, can::Time now) = 0;
  virtual std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) = 0;
  virtual Program open_program(std::uint8_t node_id) = 0;
  /// False: somebody else has a transfer with this node, or has waited for one. The boot then asks again
  /// after MasterOptions::busy_retry, or when channel_freed() is called.
  virtual bool sdo_channel_free(std::uint8_t node_id, can::Time now) = 0;
  /// A request to this node is in line for the bus, and the line moves.
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

class BootSlave final : private canopen::SdoClientUser, private canopen::ByteSource {
 public:
  BootSlave(std::uint8_t node_id, BootHost& host, can::Sink& sink);

  /// Begins from the first step; a running boot is given up. `after_reset`: the slave was just told to reset.
  void start(bool after_reset, can::Time now);
  /// The slave's boot-up message.
  void boot_up(can::Time now);
  /// A heartbeat or guarding answer of the slave.
  void state_seen(canopen::NmtState state, can::Time now);
  /// The boot time is over: ends a running boot with the error of its present step.
  void give_up(can::Time now);
  /// Asks nothing more, until give_up() or start().
  void suspend();
  /// Ends without a result.
  void abandon();
  /// The SDO channel, which was not free, is so now.
  void channel_freed(can::Time now);
  /// Only writes the concise DCF; the step is afterwards what it was. Not while running().
  void configure(can::Time now);

  [[nodiscard]] bool running() const noexcept;
  [[nodiscard]] bool booted() const noexcept { return record_.step == BootStep::booted; }
  [[nodiscard]] bool configuring() const noexcept { return record_.step == BootStep::configuration; }
  /// It answered an SDO since it was reset.
  [[nodiscard]] bool answered() const noexcept { return answered_; }
  /// The slave was commanded to reset: what it answered before no longer counts.
  void was_reset() noexcept { answered_ = false; }
  [[nodiscard]] bool sdo_busy() const noexcept { return client_.busy(); }
  /// A block download goes on.
  [[nodiscard]] bool downloads_block() const noexcept { return client_.busy() && in_blocks_; }
  [[nodiscard]] const BootRecord& record() const noexcept { return record_; }

  void receive(const can::Frame& frame, can::Time now) { client_.receive(frame, now); }
  /// Its request got out on the bus.
  void transmitted(can::Time now) { client_.count_from(now); }
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept { return std::min(deadline_, client_.deadline()); }

 private:
  void sdo_finished(canopen::SdoClient& client, can::Time now) override;
  // The program, counted on its way.
  std::expected<std::size_t, canopen::AbortCode> read(std::span<std::uint8_t> into) override;

  void enter(BootStep step, can::Time now, can::Duration limit = {});
  void begin(can::Time now);
  void ask_presence(can::Time now);
  void presence_answered(can::Time now);
  void ask_identity(std::uint8_t sub, can::Time now);
  void identity_answered(can::Time now);
  void check_state(can::Time now);
  void check_software(can::Time now);
  void software_version_answered(can::Time now);
  void program_state_answered(can::Time now);
  void control_program(BootStep step, std::uint8_t command, can::Time now);
  void program_stopped(can::Time now);
  void program_cleared(can::Time now);
  void download_program(can::Time now);
  void program_downloaded(can::Time now);
  void flash_status_answered(can::Time now);
  void program_verified(can::Time now);
  void program_start_answered(can::Time now);
  void program_run_answered(can::Time now);
  void restore(can::Time now);
  void restore_answered(can::Time now);
  void check_configuration(can::Time now);
  void configuration_mark_answered(can::Time now);
  void start_configuration(can::Time now);
  void next_configuration_entry(can::Time now);
  void configuration_finished(can::Time now);
  void configuration_entry_answered(can::Time now);
  void start_error_control(can::Time now);
  /// Reads this object, as this step.
  void ask(BootStep step, std::uint16_t index, std::uint8_t sub, can::Time now);
  /// Writes this object in the present step; without data: reads it.
  void download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data, can::Time now);
  void request(can::Time now);
  bool start_transfer(can::Time now);
  /// The transfer that is to come is a block download.
  [[nodiscard]] bool takes_blocks() const;
  /// The last transfer was in blocks, and failed in a way that another without them may not.
  [[nodiscard]] bool blocks_refused() const noexcept;
  /// request() after a pause.
  void request_later(can::Duration pause, can::Time now);
  void fail(BootError error, can::Time now);
  void finish(can::Time now);
  [[nodiscard]] BootError error_of_step() const noexcept;
  [[nodiscard]] std::uint32_t received_value() const noexcept;

  std::uint8_t node_id_;
  BootHost* host_;
  canopen::SdoClient client_;
  BootRecord record_;
  BootStep step_before_configuration_ = BootStep::idle;
  can::Time deadline_ = can::never;
  ConciseDcfReader configuration_;
  std::span<const std::uint8_t> download_;  // what the present step writes; empty: it reads
  std::uint8_t program_command_ = 0;        // what download_ is while 1F51H is written
  Program program_;
  bool writes_program_ = false;  // instead of download_
  bool in_blocks_ = false;       // the present transfer
  bool no_blocks_ = false;       // the slave does not know them
  unsigned clear_attempts_ = 0;
  unsigned updates_ = 0;  // begun since the slave was booted last
  bool updated_ = false;  // since then, and the new program runs
  bool only_configure_ = false;
  bool request_pending_ = false;  // the SDO could not be started yet, or is to be after a pause
  bool wants_channel_ = false;    // of these the former
  bool rebooted_ = false;         // boot-up message while 1000H was asked, or the program downloaded
  bool found_operational_ = false;
  bool answered_ = false;
};

}  // namespace canopus::manager
