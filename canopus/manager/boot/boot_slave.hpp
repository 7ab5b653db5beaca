#pragma once
// "Boot slave": the way of one slave from its reset to its start [CiA 302-2; ME3CAN1-Q 4.8.6, notes B8]:
//
//   (wait after reset) - presence: 1000H - identity: 1018H - [keep alive: its state]
//   - [software: 1F56H compared, program downloaded; then from presence on once more: software_update.hpp]
//   - [restore: 1011H, its boot-up] - [configuration: 1020H compared, concise DCF: slave_configuration.hpp]
//   - error control: heartbeat or guarding - booted
//
// One SDO transfer at a time on the slave's default channel (boot_transfer.hpp). A slave that does not answer
// is asked again without end; whether that is too long is decided by the host (boot time). The start command
// itself is the host's as well: it depends on what the other slaves do.

#include <cstdint>

#include "canopus/manager/boot/boot_context.hpp"
#include "canopus/manager/boot/slave_configuration.hpp"
#include "canopus/manager/boot/software_update.hpp"

namespace canopus::manager {

class BootSlave final : private BootTransferListener {
 public:
  BootSlave(std::uint8_t node_id, BootHost& host, can::Sink& sink) : boot_(node_id, host, sink, *this) {
    alarm_.add_part(boot_.step_end);
    alarm_.add_part(boot_.transfer.alarm());
  }

  /// Begins from the first step; a running boot is given up. `after_reset`: the slave was just commanded to
  /// reset.
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
  /// The boot of this mandatory slave failed, and no slave is started.
  void start_up_halted_by(std::uint8_t node_id) noexcept { boot_.record.halted_by = node_id; }
  /// The SDO channel, which was not free, is so now.
  void channel_freed(can::Time now) { boot_.transfer.channel_freed(now); }
  /// Only writes the concise DCF; the step is afterwards what it was. Not while running().
  void configure(can::Time now);

  [[nodiscard]] bool running() const noexcept;
  [[nodiscard]] bool booted() const noexcept { return boot_.record.step == BootStep::booted; }
  [[nodiscard]] bool configuring() const noexcept { return boot_.record.step == BootStep::configuration; }
  /// It answered an SDO since it was reset.
  [[nodiscard]] bool answered() const noexcept { return boot_.answered; }
  /// The slave was commanded to reset: what it answered before no longer counts.
  void was_reset() noexcept { boot_.answered = false; }
  [[nodiscard]] bool sdo_busy() const noexcept { return boot_.transfer.busy(); }
  /// A block download goes on.
  [[nodiscard]] bool downloads_block() const noexcept { return boot_.transfer.downloads_block(); }
  [[nodiscard]] const BootRecord& record() const noexcept { return boot_.record; }

  void receive(const can::Frame& frame, can::Time now) { boot_.transfer.receive(frame, now); }
  /// Its request got out on the bus.
  void transmitted(can::Time now) { boot_.transfer.transmitted(now); }
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  void transfer_ended(can::Time now) override;
  void on_software_step(const BootOutcome& outcome, can::Time now);
  void follow_configuration(const BootOutcome& outcome, can::Time now);

  void begin(can::Time now);
  void request_presence(can::Time now);
  void presence_answered(can::Time now);
  [[nodiscard]] can::Duration pause_before_retry(can::Time now) const;
  void request_identity(std::uint8_t sub, can::Time now);
  void identity_answered(can::Time now);
  void check_state(can::Time now);
  void configured(can::Time now);
  void start_error_control(can::Time now);
  void fail(BootError error, can::Time now);
  void finish(can::Time now);
  [[nodiscard]] BootError error_of_step() const noexcept;

  BootContext boot_;
  SoftwareUpdate software_{boot_};
  SlaveConfiguration configuration_{boot_};
  BootStep step_before_configuration_ = BootStep::idle;
  bool only_configure_ = false;
  bool rebooted_ = false;  // boot-up message while 1000H was asked
  bool found_operational_ = false;
  can::Alarm alarm_;
};

}  // namespace canopus::manager
