#pragma once
// The start-up of the network, as 1F80H, 1F81H and 1F89H say, and what becomes of slaves that come back or
// are lost later [CiA 302-2; ME3CAN1-Q 4.8.5 to 4.8.7, notes B7, B9]:
//
//   1  1F80H bit 0 is 0: no master
//   2  bit 5 is 1: the flying masters agree first
//   3  active master
//   4  reset of all nodes, but for those to be kept alive; where that takes its time, what follows waits for it
//   5  boot slave, all at once
//   6  all mandatory slaves are booted; boot time over: LSS, then the start-up has failed
//   7  own node Operational
//   8  slaves started, all by one command or each when it is booted
//
// A slave's own way through step 5 is in boot_slave.hpp.

#include <bitset>
#include <cstdint>

#include "canopus/manager/nmt/master_context.hpp"
#include "canopus/manager/nmt/nmt_command_queue.hpp"
#include "canopus/manager/nmt/slave_search.hpp"

namespace canopus::manager {

class StartUp {
 public:
  /// Slaves are asked through `sink`; LSS frames go to `wire`.
  StartUp(MasterContext& master, can::Sink& sink, can::Sink& wire)
      : master_(master), sink_(&sink), search_(master, *this, wire) {
    for (can::Alarm* part : {&phase_end_, &boot_end_, &assigned_due_, &search_.alarm()})
      alarm_.add_part(*part);
  }

  enum class Phase : std::uint8_t {
    off,
    slave,             ///< 1F80H bit 0 is 0, or another flying master is active
    resetting,         ///< step 4: the slaves, one by one
    booting,           ///< step 5, until all mandatory slaves are booted
    settling,          ///< nothing assigned: the pause between reset and start
    wait_operational,  ///< step 7: 1F80H bit 2, or the application forbids it
    wait_start_all,    ///< the pause between reset and Start all nodes
    searching,         ///< the boot time is over, missing slaves are looked for by LSS
    running,
    halted,
  };
  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  [[nodiscard]] bool active() const noexcept { return phase_ > Phase::slave; }
  [[nodiscard]] bool starting() const noexcept {
    return running_boots_ > 0 || (phase_ > Phase::slave && phase_ < Phase::running) ||
           master_.commands().start_up_waits();
  }
  /// See NmtMaster.
  [[nodiscard]] bool waits_for_own_start() const noexcept;
  /// The assigned slaves are booted, or being booted: another one that is assigned now joins them.
  [[nodiscard]] bool has_begun_boots() const noexcept {
    return phase_ > Phase::resetting && phase_ != Phase::halted && phase_ != Phase::searching;
  }
  /// Slaves may be booted now.
  [[nodiscard]] bool may_boot() const;

  // --- to be carried out in the next tick
  void request_begin(can::Time now);
  void own_state_changed(can::Time now);
  /// The own node obeys this command.
  void command_own_node(canopen::NmtCommand command, can::Time now);

  // --- what happens
  /// Steps 3 to 5. `network_was_reset`: step 4 is done.
  void start_network(bool network_was_reset, can::Time now);
  void reset_sent(std::uint8_t node_id, can::Time now);
  /// An NMT command has left the queue.
  void command_sent(can::Time now);
  /// The boot-up message of a reset that the slave has answered after already: it says nothing new.
  [[nodiscard]] bool is_late_boot_up(std::uint8_t node_id, can::Time now);
  void boot_up(std::uint8_t node_id, can::Time now);
  void state_seen(std::uint8_t node_id, canopen::NmtState state, can::Time now);
  void boot_ended(std::uint8_t node_id, BootError error, can::Time now);
  void slave_lost(std::uint8_t node_id, can::Time now);
  /// 1F81H was written after the boots have begun: the slave is booted in the next tick in which its SDO channel is free.
  void slave_assigned(std::uint8_t node_id, can::Time now) {
    assigned_.set(node_id);
    assigned_due_ = now;
  }
  /// The slave's boot, which is made if there is none yet.
  BootSlave& boot_of(std::uint8_t node_id);
  /// No mandatory slave was found in time, nor by LSS.
  void fail(can::Time now);
  void enter(Phase phase, can::Time until = can::never);

  // --- giving up, step by step
  void abandon_boots();
  /// No active master any longer: search and boots end.
  void withdraw(can::Time now);
  void turn_off() noexcept { phase_ = Phase::off; }
  void forget() noexcept;
  /// Notifies the node and the application of it.
  void show_active(bool active, can::Time now);
  void show_starting(can::Time now);

  [[nodiscard]] SlaveSearch& search() noexcept { return search_; }
  [[nodiscard]] const SlaveSearch& search() const noexcept { return search_; }

  /// What was to be carried out in this tick.
  void obey(can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  void begin(can::Time now);
  void reset_network(can::Time now);
  void boot_all(can::Time now);
  /// The boot is to begin with the boot-up message of the reset.
  [[nodiscard]] bool awaits_boot_up(std::uint8_t node_id) const;
  void start_boot(std::uint8_t node_id, bool after_reset, can::Time now);
  void boot_assigned(can::Time now);
  void boot_time_elapsed(can::Time now);
  void mandatory_done(can::Time now);
  void become_operational(can::Time now);
  void own_node_is_operational(can::Time now);
  void start_slaves(can::Time now);
  /// A slave that comes back by itself, or is lost, is left alone.
  [[nodiscard]] bool is_unmanaged(std::uint8_t node_id) const {
    return master_.options.boot_bit_is_for_recovery &&
           (master_.assignment(node_id) & assignment_bit::boot_slave) == 0 &&
           !master_.slaves[node_id].is_booting();
  }
  void finish(can::Time now);
  void halt(can::Time now);
  /// The boot of this mandatory slave failed.
  void halt_for(std::uint8_t node_id, BootError error, can::Time now);
  [[nodiscard]] bool all_booted(std::uint32_t assignment_bits) const;

  MasterContext& master_;
  can::Sink* sink_;
  SlaveSearch search_;
  Phase phase_ = Phase::off;
  std::uint32_t bits_ = 0;  // 1F80H as it was at begin()
  can::Alarm phase_end_;    // of settling, wait_start_all
  can::Alarm boot_end_;     // 1F89H
  can::Time reset_time_{};  // of the latest NMT reset of other nodes
  unsigned running_boots_ = 0;
  bool begin_pending_ = false;
  bool network_was_reset_ = false;  // the reset of step 4 was sent already
  bool all_were_reset_ = false;     // in step 4, not only those that need not be kept alive
  bool resets_took_time_ = false;   // in step 4
  bool giving_up_ = false;          // the boot time is over
  bool was_starting_ = false;
  bool own_state_changed_ = false;
  std::bitset<128> assigned_;  // to be booted
  can::Alarm assigned_due_;
  std::uint8_t own_command_ = 0;  // NmtCommand for the own node; 0 = none
  can::Alarm alarm_;              // itself: for obey()
};

}  // namespace canopus::manager
