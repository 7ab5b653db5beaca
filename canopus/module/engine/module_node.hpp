#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "canopus/can/gate.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/manager/nmt/nmt_master.hpp"
#include "canopus/module/canopen/data_exchange.hpp"
#include "canopus/module/canopen/emergency_buffer.hpp"
#include "canopus/module/canopen/network_settings.hpp"
#include "canopus/module/canopen/nmt_status.hpp"
#include "canopus/module/canopen/time_stamp.hpp"
#include "canopus/module/commands/command_interface.hpp"
#include "canopus/module/engine/controller_monitor.hpp"
#include "canopus/module/engine/cpu_state_handler.hpp"
#include "canopus/module/engine/emergency_queue.hpp"
#include "canopus/module/engine/exchange_control.hpp"
#include "canopus/module/engine/status_words.hpp"
#include "canopus/module/lift/lift.hpp"
#include "canopus/module/storage/concise_dcf_store.hpp"

namespace canopus::module {

/// The CANopen node of a module with its NMT master, the areas of the buffer memory that show the network, and the command words, of
/// which Layer 2 has some, too.
class ModuleNode final : private canopen::NodeListener,
                         private canopen::ObjectHandler,
                         private manager::MasterListener,
                         private CommandHost {
 public:
  /// `monitor`, `cpu` and `layer2` may be under construction. `module` is notified when its controller has changed.
  ModuleNode(ModuleContext& context, can::Controller& controller, ControllerMonitor& monitor,
             CpuStateHandler& cpu, Layer2Mode& layer2, can::Participant& module);
  ModuleNode(const ModuleNode&) = delete;
  ModuleNode& operator=(const ModuleNode&) = delete;

  [[nodiscard]] const canopen::Node& node() const noexcept { return node_; }
  [[nodiscard]] const manager::NmtMaster& master() const noexcept { return master_; }
  [[nodiscard]] canopen::NmtState state() const noexcept { return node_.state(); }
  /// Counts what node and master report, but received process data and repeated heartbeats: a callback of theirs that changes a word or a
  /// signal counts here. Without it update(), and what the plant reads of a module, would follow each PDO.
  [[nodiscard]] std::uint64_t change_count() const noexcept { return change_count_; }
  /// It is in an NMT reset.
  [[nodiscard]] bool is_resetting() const noexcept { return is_resetting_; }
  /// Its boot-up message is not on the wire yet.
  [[nodiscard]] bool boot_up_waits() const noexcept { return boot_up_waits_; }
  /// False while the LSS search has the controller at another bit rate.
  [[nodiscard]] bool is_on_network() const noexcept { return network_.is_open(); }
  /// 1F80H makes it an NMT master, active or not.
  [[nodiscard]] bool is_master_by_role() const;
  /// 1029:01.
  [[nodiscard]] bool keeps_state_on_error() const;

  // --- the module's life: power_off(), reset(), clear_restored_configurations(), describe(), begin(), power_on()
  void power_off(can::Time now);
  /// The words, as from power-on.
  void reset();
  /// Concise DCFs, if 1011H has taken "load" since they were loaded last [ME3CAN1-Q 4.6.11].
  void clear_restored_configurations();
  /// Only a restart carries out what 1011H has taken; a cut of the supply does not.
  void forget_restore() noexcept { clear_configurations_ = false; }
  /// The dictionary of a CANopen mode.
  void describe(const FunctionModeRow& mode);
  /// The areas of the function mode.
  void begin(bool canopen_mode);
  /// bit/s, for the LSS search.
  void set_bit_rate(std::uint32_t bit_rate) { master_.options().bit_rate = bit_rate; }
  void power_on(std::uint8_t node_id, can::Time now);

  // --- events
  /// True: it may have changed more than process data and a known heartbeat.
  [[nodiscard]] bool receive(const can::Frame& frame, can::Time now);
  /// True: the boot-up message, which ends Initialisation [CiA 301 7.3.2.2].
  [[nodiscard]] bool transmitted(const can::Frame& frame, can::Time now);
  /// The plain frame of a command is sent.
  void command_frame_sent(can::Time now) { command_.frame_sent(now); }
  /// The controller was restarted: nothing waits in it any more.
  void frames_lost() noexcept { boot_up_waits_ = false; }
  void bus_off(can::Time now);
  void communication_error(can::Time now) { node_.communication_error(now); }
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

  // --- the CPU
  void start_master(can::Time now) { master_.start(now); }
  void stop_master(can::Time now) { master_.stop(now); }
  void pause_heartbeat(bool paused, can::Time now) { node_.pause_heartbeat(paused, now); }
  /// To Stopped where 1029:01 has that, else from Operational to Pre-operational.
  void leave_operational(can::Time now);

  // --- emergency messages
  /// Of the module's own finding: sent by send_emergencies(), once the boot-up message is on the wire.
  void raise_emergency(const EmergencyRow& row) { own_emergencies_.raise(row); }
  void send_emergencies(can::Time now) {
    if (!boot_up_waits_) own_emergencies_.send(now);
  }
  void drop_emergencies() noexcept { own_emergencies_.clear(); }
  void forget_error(const EmergencyRow& row, can::Time now) {
    node_.forget_error(row.code, row.manufacturer, now);
  }
  /// At once. False: it may not be sent.
  bool send_restart_emergency(can::Time now);
  /// Received ones, in the words.
  [[nodiscard]] const EmergencyBuffer& received_emergencies() const noexcept { return emergencies_; }
  void hold_clear_emergencies(bool held) { emergencies_.hold_clear(held); }

  // --- failures of nodes
  [[nodiscard]] bool any_failure() const noexcept { return nmt_status_.any_failure(); }
  /// Failures of the node to clear, or of all nodes, are cleared as they come.
  void hold_clear_failures(bool held) noexcept { nmt_status_.hold_clear(held); }
  void hold_clear_all_failures(bool held) noexcept { nmt_status_.hold_clear_all(held); }
  /// Of this node, or of all (0).
  void clear_failures(std::uint8_t node_id, can::Time now);
  /// Of the node that its word selects.
  void clear_selected_failures(can::Time now) { clear_failures(nmt_status_.node_to_clear(), now); }
  /// Those whose bits the program has written as 0.
  void clear_written_failures(can::Time now);

  // --- commands
  [[nodiscard]] bool is_command_word(BufferAddress address) const noexcept { return command_.owns(address); }
  void execute_command(can::Time now);
  /// Commands that were held begin.
  void release_commands(can::Time now) { command_.release(now); }

  // --- clock
  /// The address of a word that is out of range, or nothing.
  std::optional<BufferAddress> set_clock(can::Time now) { return time_stamp_.set_from_words(now); }
  void show_clock(can::Time now) { time_stamp_.show(now); }
  [[nodiscard]] std::optional<BufferAddress> wrong_clock_word() const { return time_stamp_.wrong_word(); }

  // --- settings and files
  /// Others than the program have changed words of the network and of the clock.
  void words_restored(can::Time now);
  /// Of the nodes that it configures.
  [[nodiscard]] std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) const noexcept {
    return concise_dcfs_.file(node_id);
  }
  [[nodiscard]] std::vector<std::uint8_t> stored_configurations() { return concise_dcfs_.stored_nodes(); }
  [[nodiscard]] const manager::ConfigurationOptions& configuration_limits() noexcept {
    return concise_dcfs_.limits();
  }
  /// See ConciseDcfStore::merge().
  [[nodiscard]] bool merge_configurations(const std::map<std::uint8_t, std::vector<std::uint8_t>>& files,
                                          bool& changed) {
    return concise_dcfs_.merge(files, changed);
  }
  /// The flash memory is busy until then.
  void occupy_store(can::Time until) noexcept { concise_dcfs_.occupy(until); }
  /// Stored concise DCFs were damaged at the last start.
  [[nodiscard]] bool has_damaged_files() const noexcept { return has_damaged_files_; }

  /// What a data exchange moves.
  [[nodiscard]] ExchangeControl::Data exchange_data(Layer2& layer2, const can::Controller& controller) {
    return {process_data_, lift_, emergencies_, layer2, node_, controller};
  }

 private:
  [[nodiscard]] canopen::NodeOptions options(const FunctionModeRow& mode) const;

  // NodeListener
  void nmt_state_changed(canopen::NmtState state, can::Time now) override;
  void reset_requested(canopen::NmtCommand which, can::Time now) override;
  void defaults_loaded(canopen::NmtCommand which, can::Time now) override;
  void reset_done(canopen::NmtCommand which, can::Time now) override;
  bool may_become_operational() override { return cpu_.allows_operational(); }
  void emergency_received(const canopen::Emergency& message, can::Time now) override;
  void emergency_raised(const canopen::Emergency& message, can::Time now) override;
  void rpdo_received(std::uint16_t number, can::Time now) override;
  void rpdo_length_wrong(std::uint16_t number, std::uint16_t code, can::Time now) override;
  void time_received(const canopen::TimeOfDay& time, can::Time now) override;
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) override;
  void heartbeat_lost(std::uint8_t node_id, can::Time now) override;
  void life_guarding_event(bool occurred, can::Time now) override;
  void life_guarding_running(bool running, can::Time now) override;
  void life_guarding_missed(can::Time now) override;
  void object_written(const canopen::Entry& entry, can::Time now) override;

  // ObjectHandler: 0002H-0008H
  canopen::AbortCode before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                 can::Time now) override;
  canopen::AbortCode before_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                  std::span<const std::uint8_t> value, can::Time now) override;

  // MasterListener
  void active_changed(bool /*active*/, can::Time) override { ++change_count_; }
  void starting_changed(bool /*starting*/, can::Time) override { ++change_count_; }
  void start_up_finished(can::Time) override { ++change_count_; }
  void slave_booted(std::uint8_t /*node_id*/, can::Time) override { ++change_count_; }
  void error_control_resolved(std::uint8_t /*node_id*/, can::Time) override { ++change_count_; }
  void boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) override;
  void slave_failed(std::uint8_t node_id, manager::BootError error, can::Time now) override;
  void start_up_halted(std::uint8_t node_id, manager::BootError error, can::Time now) override;
  void error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event, can::Time now) override;
  void lss_active_changed(bool active, can::Time now) override;
  void change_bit_rate(std::uint32_t bit_rate, can::Time now) override;
  void lss_search_ended(std::uint8_t node_id, bool found, can::Time now) override;
  void node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time now) override;
  void error_control_changed(std::uint8_t node_id, std::uint16_t bits, can::Time now) override;
  bool sdo_channel_free(std::uint8_t node_id) override { return command_.remote_node() != node_id; }

  // CommandHost
  std::uint16_t bus_obstacle() const override;
  std::uint8_t own_node_id() const override { return node_.node_id(); }
  canopen::ObjectDictionary& dictionary() override { return node_.dictionary(); }
  can::Duration sdo_time_out() const override { return network_settings_.sdo_time_out(); }
  bool sdo_channel_available(std::uint8_t node_id) const override {
    return !master_.sdo_channel_busy(node_id);
  }
  EmergencyAnswer send_emergency(std::uint16_t code, std::uint8_t error_register,
                                 std::span<const std::uint8_t, 5> manufacturer, can::Time now) override;
  PlainFrameResult send_plain_frame(std::span<const std::uint16_t> parameters,
                                    std::span<std::uint16_t> faults) override;
  bool is_nmt_master() const override { return is_master_by_role(); }
  std::uint16_t pdos() const override { return context_.model.program_interface.process_data.pdos; }
  void map_pdos(PdoMapping mapping, can::Time now) override;
  bool holds_commands() const override {
    return context_.model.cpu.watchdog_holds_commands && context_.watchdog.expired();
  }
  bool send_now(const can::Frame& frame) override;
  EmergencyBuffer& emergencies() override { return emergencies_; }
  const NmtStatus& nmt_status() const override { return nmt_status_; }
  void clear_error_control(std::uint8_t node_id, can::Time now) override { clear_failures(node_id, now); }
  void command_finished(can::Time now) override { context_.port->done(Request::command, now); }

  ModuleContext& context_;
  ControllerMonitor& monitor_;
  CpuStateHandler& cpu_;
  Layer2Mode& layer2_;
  can::Participant& module_;

  can::Gate network_;  // closed while the LSS search has the controller at another bit rate
  EmergencyBuffer emergencies_;
  NmtStatus nmt_status_;
  canopen::Node node_;
  manager::NmtMaster master_;
  CommandInterface command_;
  NetworkSettings network_settings_;
  DataExchange process_data_;
  LiftData lift_;
  TimeStamp time_stamp_;
  StatusWords status_words_;
  ConciseDcfStore concise_dcfs_;
  EmergencyQueue own_emergencies_;
  can::Alarm alarm_;

  std::uint64_t change_count_ = 0;
  bool is_resetting_ = false;
  bool boot_up_waits_ = false;
  bool clear_configurations_ = false;
  bool has_damaged_files_ = false;
};

}  // namespace canopus::module
