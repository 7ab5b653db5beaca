#pragma once
// The inside of NmtMaster. Everything that has a time lies in one tournament of 128 timers: number n for what
// concerns node n (its boot, its guarding), number 0 for the master itself.

#include <algorithm>
#include <array>
#include <bitset>
#include <cstdint>
#include <memory>
#include <vector>

#include "canopus/manager/boot_slave.hpp"
#include "canopus/manager/flying_master.hpp"
#include "canopus/manager/lss_search.hpp"
#include "canopus/manager/nmt_master.hpp"
#include "canopus/manager/node_guarding.hpp"
#include "canopus/manager/node_timers.hpp"
#include "canopus/manager/sdo_line.hpp"
#include "canopus/manager/sdo_requests.hpp"
#include "canopus/manager/start_up_bits.hpp"

namespace canopus::manager {

class NmtMaster::Engine final : public BootHost,
                                public canopen::ObjectHandler,
                                private can::Sink,
                                private SdoChannelGate,
                                private FlyingMasterUser,
                                private LssSearchUser {
 public:
  Engine(canopen::Node& node, can::Sink& sink, MasterOptions options);

  void start(can::Time now);
  void stop(can::Time now);
  void receive(const can::Frame& frame, can::Time now);
  void transmitted(const can::Frame& frame, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept {
    return std::min(timers_.earliest(), requests_.deadline());
  }
  void own_state_changed(can::Time now);
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now);
  void heartbeat_lost(std::uint8_t node_id, can::Time now);

  [[nodiscard]] bool active() const noexcept { return phase_ > Phase::slave; }
  [[nodiscard]] bool starting() const noexcept {
    return running_boots_ > 0 || (phase_ > Phase::slave && phase_ < Phase::running);
  }
  [[nodiscard]] bool halted() const noexcept { return phase_ == Phase::halted; }
  [[nodiscard]] bool waits_for_own_start() const noexcept;
  [[nodiscard]] std::uint8_t node_state(std::uint8_t node_id) const noexcept;
  [[nodiscard]] std::uint16_t error_control(std::uint8_t node_id) const noexcept;
  void clear_error_control(std::uint8_t node_id, can::Time now);
  [[nodiscard]] std::uint8_t active_master() const noexcept {
    return active() ? node_->node_id() : flying_.active_master();
  }
  [[nodiscard]] const BootSlave* boot(std::uint8_t node_id) const noexcept {
    return node_id < boots_.size() ? boots_[node_id].get() : nullptr;
  }
  [[nodiscard]] bool lss_configured(std::uint8_t node_id) const noexcept;
  [[nodiscard]] bool lss_active() const noexcept { return phase_ == Phase::searching; }
  [[nodiscard]] bool guarding(std::uint8_t node_id) const noexcept {
    return node_id < guarding_.size() && guarding_[node_id].running();
  }

  canopen::AbortCode check_nmt_request(std::uint8_t node_id, std::uint8_t value) const noexcept;
  void perform_nmt_request(std::uint8_t node_id, std::uint8_t value, can::Time now);
  canopen::AbortCode check_guarding_request(std::uint8_t node_id, std::uint8_t value) const noexcept;
  void perform_guarding_request(std::uint8_t node_id, std::uint8_t value, can::Time now);
  canopen::AbortCode request_configuration(std::uint8_t node_id, can::Time now);
  [[nodiscard]] canopen::AbortCode check_sdo_request(std::uint8_t node_id) const noexcept;

  MasterOptions options_;
  MasterListener* listener_;
  ConfigurationSource* source_ = nullptr;
  SdoRequests requests_;

 private:
  enum class Phase : std::uint8_t {
    off,
    slave,             ///< 1F80H bit 0 is 0
    booting,           ///< until all mandatory slaves are booted
    settling,          ///< nothing assigned: the pause between reset and start
    wait_operational,  ///< own node is not Operational yet: 1F80H bit 2, or the application forbids it
    wait_start_all,    ///< the pause between reset and Start all nodes
    searching,         ///< the boot time is over, missing slaves are looked for by LSS
    running,
    halted,
  };
  struct Command {
    canopen::NmtCommand command;
    std::uint8_t node_id;
  };
  static constexpr std::size_t queue_size = 256;

  /// The way to the bus. It knows when it is in use: on a bus that is a function call, answers come from
  /// inside send(), in the middle of whatever sends.
  class Wire final : public can::Sink {
   public:
    explicit Wire(can::Sink& sink) : sink_(&sink) {}
    bool send(const can::Frame& frame) override {
      ++depth_;
      const bool sent = sink_->send(frame);
      --depth_;
      return sent;
    }
    [[nodiscard]] bool is_sending() const noexcept { return depth_ != 0; }

   private:
    can::Sink* sink_;
    unsigned depth_ = 0;
  };

  // BootHost
  [[nodiscard]] const canopen::ObjectDictionary& dictionary() const override { return node_->dictionary(); }
  [[nodiscard]] const MasterOptions& boot_options() const override { return options_; }
  [[nodiscard]] std::uint32_t assignment(std::uint8_t node_id) const override;
  [[nodiscard]] can::Duration heartbeat_time(std::uint8_t node_id) const override;
  void send_nmt(canopen::NmtCommand command, std::uint8_t node_id, can::Time now) override;
  void ask_state(std::uint8_t node_id) override;
  [[nodiscard]] bool guards(std::uint8_t node_id) const override;
  void start_guarding(std::uint8_t node_id, can::Time now) override;
  std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) override;
  Program open_program(std::uint8_t node_id) override;
  bool sdo_channel_free(std::uint8_t node_id, can::Time now) override;
  bool request_waits(std::uint8_t node_id, can::Time now) const override {
    return line_.waits(canopen::cob_id::sdo_request + node_id, now);
  }
  [[nodiscard]] unsigned blocks_running() const override;
  void presence_known(std::uint8_t node_id, bool present, can::Time now) override;
  void boot_went_on(std::uint8_t node_id, const BootRecord& record, can::Time now) override {
    listener_->boot_went_on(node_id, record, now);
  }
  void boot_ended(std::uint8_t node_id, BootError error, can::Time now) override;

  // SdoChannelGate
  bool channel_is_free(std::uint8_t node_id) override;
  void channel_freed(std::uint8_t node_id, can::Time now) override;

  // FlyingMasterUser (nmt_master_flying.cpp)
  void mastership_won(can::Time now) override;
  void mastership_lost(can::Time now) override;
  can::Duration standby_for(std::uint8_t master_node_id, can::Time now) override;
  void reset_all_nodes(can::Time now) override;
  void begin_flying(can::Time now);

  // LssSearchUser, and the searches (nmt_master_lss.cpp)
  void change_bit_rate(std::uint32_t bit_rate, can::Time now) override;
  void lss_search_finished(std::uint8_t node_id, bool found, can::Time now) override;
  /// False: there is nobody to look for.
  bool begin_searches(can::Time now);
  void search_next(can::Time now);
  void abandon_search(can::Time now);

  // canopen::ObjectHandler: 1F80H-1F83H, 1F90H
  canopen::AbortCode before_read(canopen::ObjectDictionary&, const canopen::Entry&, can::Time now) override;
  canopen::AbortCode before_write(canopen::ObjectDictionary&, const canopen::Entry&,
                                  std::span<const std::uint8_t> value, can::Time now) override;
  void after_write(canopen::ObjectDictionary&, const canopen::Entry&, can::Time now) override;

  // can::Sink, between the boots and the real one: silent while everything is being given up, and while LSS
  // has the own controller at another bit rate
  bool send(const can::Frame& frame) override;

  // start-up (nmt_master_start_up.cpp)
  void begin(can::Time now);
  void start_network(can::Time now);
  /// True when every node was reset, not only those that need not be kept alive.
  bool reset_network(can::Time now);
  void boot_all(bool all_were_reset, can::Time now);
  void start_boot(std::uint8_t node_id, bool after_reset, can::Time now);
  void boot_time_elapsed(can::Time now);
  void start_up_failed(can::Time now);
  void mandatory_done(can::Time now);
  void become_operational(can::Time now);
  void own_node_is_operational(can::Time now);
  void start_slaves(can::Time now);
  void enter(Phase phase, can::Time now, can::Time until = can::never);
  void halt(can::Time now);
  void abandon_boots();
  [[nodiscard]] bool all_booted(std::uint32_t assignment_bits) const;
  [[nodiscard]] bool may_boot() const;

  // events (nmt_master_events.cpp)
  void hear(const can::Frame& frame, can::Time now);
  void hear_kept(can::Time now);
  void master_tick(can::Time now);
  void node_tick(std::uint8_t node_id, can::Time now);
  void guarding_tick(std::uint8_t node_id, can::Time now);
  void boot_may_have_ended_transfer(std::uint8_t node_id, can::Time now);
  void state_message(std::uint8_t node_id, std::uint8_t byte, can::Time now);
  void boot_up_message(std::uint8_t node_id, can::Time now);
  void check_guarded_state(std::uint8_t node_id, std::uint8_t state, can::Time now);
  void error_event(std::uint8_t node_id, ErrorControlEvent event, can::Time now);
  void flush_commands(can::Time now);
  void command_was_sent(Command command, can::Time now);
  void show_commanded(canopen::NmtCommand command, std::uint8_t node_id, can::Time now);
  [[nodiscard]] bool heard(std::uint8_t node_id) const;

  void set_state(std::uint8_t node_id, std::uint8_t state, can::Time now);
  void set_flags(std::uint8_t node_id, std::uint16_t set, std::uint16_t clear, can::Time now);
  void tell_starting(can::Time now);
  void refresh(std::uint8_t node_id);
  void refresh_master(can::Time now);
  /// Something is to be done in the next tick.
  void wake(can::Time now) { timers_.set(0, now); }

  canopen::Node* node_;
  Wire wire_;
  std::vector<can::Frame> kept_;     // came from inside send(): heard in the next tick, which is due at once
  std::vector<can::Frame> hearing_;  // of those, what is being heard
  SdoLine line_;
  can::Time now_{};  // of the latest call from outside
  bool muted_ = false;

  Phase phase_ = Phase::off;
  std::uint32_t start_up_ = 0;        // 1F80H as it was at start()
  can::Time phase_end_ = can::never;  // of settling, wait_start_all
  can::Time boot_end_ = can::never;   // 1F89H
  can::Time reset_time_{};            // of the latest NMT reset of other nodes
  bool begin_pending_ = false;
  bool network_was_reset_ = false;  // the reset of step 4 was sent already
  bool giving_up_ = false;          // the boot time is over
  bool was_starting_ = false;
  bool own_state_changed_ = false;
  std::uint8_t own_command_ = 0;  // NmtCommand for the own node, to be obeyed in the next tick; 0 = none
  unsigned running_boots_ = 0;

  std::array<std::uint8_t, 128> state_{};
  std::array<std::uint16_t, 128> flags_{};
  std::array<std::uint8_t, 128> expected_state_{};  // what guarding should see; 0 = no opinion
  std::array<can::Time, 128> expected_since_{};
  std::bitset<128> heartbeat_alive_;
  std::bitset<128> heartbeat_lost_pending_;
  std::bitset<128> in_error_;  // had an error control event, not heard since
  std::bitset<128> wrong_state_;
  std::bitset<128> held_;  // stopped by request: not started again by itself [ME3CAN1-Q 4.8.8]
  std::bitset<128> boot_counted_;
  std::bitset<128> boot_up_due_;       // reset, its boot-up message has not come yet
  std::bitset<128> boot_had_channel_;  // the last SDO transfer with the node was the start-up's
  std::array<can::Time, 128> reset_since_{};
  std::array<std::unique_ptr<BootSlave>, 128> boots_;
  std::array<NodeGuarding, 128> guarding_{};
  NodeTimers timers_;
  FlyingMaster flying_;
  LssSearch search_;
  std::bitset<128> wanted_;         // slaves to be looked for
  std::uint8_t searching_for_ = 0;  // the one that is being looked for
  std::uint8_t standby_entry_ = 0;  // sub-index of 1016H that was set to watch the active master; 0 = none

  std::array<Command, queue_size> commands_{};
  std::size_t first_command_ = 0;
  std::size_t command_count_ = 0;
  bool flushes_commands_ = false;
  can::Time next_command_{};  // not before this [102AH]
};

}  // namespace canopus::manager
