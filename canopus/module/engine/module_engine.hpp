#pragma once
// What runs inside a communication module with a buffer memory: life cycle (supply, initialization, restart),
// the stored settings, data exchange, and the areas of the buffer memory, tied to one CANopen node and its
// NMT master, or to Layer 2. What a model's manual says of words, bits and commands is its ModuleModel.
//
// How the PLC program asks for something is the business of the model's request port (request_port.hpp): it
// calls the requests below, and hears of their ends.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/can/gate.hpp"
#include "canopus/manager/nmt/nmt_master.hpp"
#include "canopus/module/areas/command_interface.hpp"
#include "canopus/module/areas/data_exchange.hpp"
#include "canopus/module/areas/diagnostics.hpp"
#include "canopus/module/areas/emergency_buffer.hpp"
#include "canopus/module/areas/error_status.hpp"
#include "canopus/module/areas/exchange_control.hpp"
#include "canopus/module/areas/layer2.hpp"
#include "canopus/module/areas/module_state.hpp"
#include "canopus/module/areas/network_settings.hpp"
#include "canopus/module/areas/nmt_status.hpp"
#include "canopus/module/areas/status_words.hpp"
#include "canopus/module/areas/time_stamp.hpp"
#include "canopus/module/engine/module_model.hpp"
#include "canopus/module/engine/module_settings.hpp"
#include "canopus/module/engine/profile.hpp"
#include "canopus/module/engine/register_words.hpp"
#include "canopus/module/engine/request_port.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/storage/concise_dcf_store.hpp"

namespace canopus::module {

class ModuleEngine : public CommunicationModule,
                     public BufferMemoryAccess,
                     private CommandHost,
                     private canopen::NodeListener,
                     private canopen::ObjectHandler,
                     private manager::MasterListener {
 public:
  /// Off until power_on(). Everything must outlive the module.
  ModuleEngine(const ModuleModel& model, can::Controller& controller, NonVolatileMemory& memory,
               const Profile& profile);
  ModuleEngine(const ModuleEngine&) = delete;
  ModuleEngine& operator=(const ModuleEngine&) = delete;

  // CommunicationModule
  bool preset_word(BufferAddress address, std::uint16_t value) override;
  bool preset_bit_rate(std::uint32_t bit_rate) override;
  bool preset_node_id(std::uint8_t node_id) override;
  canopen::AbortCode preset_object(std::uint16_t index, std::uint8_t sub,
                                   std::span<const std::uint8_t> value) override;
  [[nodiscard]] std::span<const std::uint8_t> object_preset(std::uint16_t index,
                                                            std::uint8_t sub) const override {
    return settings_.object_preset(index, sub);
  }
  [[nodiscard]] bool presets_canopen_mode() const override { return settings_.presets_canopen_mode(); }
  [[nodiscard]] std::optional<BufferAddress> layer2_preset_error() const override;
  [[nodiscard]] bool takes_word(BufferAddress address, std::uint16_t value) const override;
  [[nodiscard]] std::optional<InitialNode> initial_node() override;
  [[nodiscard]] const ProgramInterface& program_interface() const noexcept override;
  [[nodiscard]] const canopen::Node& node() const noexcept override { return node_; }
  [[nodiscard]] Layer2State layer2_state() const noexcept override;
  [[nodiscard]] std::vector<ModuleEventRecord> event_history() const override {
    return {diagnostics_.history().begin(), diagnostics_.history().end()};
  }
  [[nodiscard]] std::vector<ModuleErrorRecord> module_errors() const override {
    return diagnostics_.errors();
  }
  bool clear_module_errors() override { return diagnostics_.clear_minor(); }
  [[nodiscard]] std::vector<Led> leds(can::Time now) const override;
  [[nodiscard]] std::vector<SlaveBootRecord> boots() const override;
  [[nodiscard]] std::uint32_t flash_writes() const noexcept override { return settings_.flash().writes(); }

  // Module
  [[nodiscard]] std::string_view model() const noexcept override { return model_.data_sheet->model; }
  [[nodiscard]] unsigned points() const noexcept override { return model_.data_sheet->points; }
  [[nodiscard]] ProductInformation product() const noexcept override;
  [[nodiscard]] StartUp start_up() const noexcept override;
  [[nodiscard]] BufferMemoryAccess* buffer_memory() noexcept override {
    return model_.buffer_memory_size == 0 ? nullptr : this;
  }
  [[nodiscard]] RegisterAccess* registers() noexcept override {
    return model_.registers.empty() ? nullptr : &registers_;
  }
  [[nodiscard]] SignalAccess* signals() noexcept override { return port_->signals(); }
  void power_on(can::Time now) override;
  void power_off(can::Time now) override;
  void cpu_changed(CpuState state, can::Time now) override;
  void cpu_failed(can::Time now) override;
  void inject(ModuleFault fault, can::Time now) override;
  void set_observer(ModuleObserver* observer) override;

  // BufferMemoryAccess
  [[nodiscard]] BufferAddress buffer_memory_size() const noexcept override {
    return model_.buffer_memory_size;
  }
  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) override;
  void write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& frame, can::Time now) override;
  void controller_changed(can::Time now) override;
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override;

  // --- for the request port: requests of the PLC program; the module is on
  /// As the data exchange control word says.
  void begin_exchange(can::Time now);
  /// Process data run, or wait for Operational.
  [[nodiscard]] bool exchanging() const noexcept { return exchange_.running(); }
  void begin_restart(can::Time now);
  /// As the save/restore word says.
  void begin_save(can::Time now);
  void execute_command(can::Time now);
  void set_clock(can::Time now);
  void read_clock(can::Time now);
  void go_online(can::Time now);
  void go_offline(can::Time now);
  void request_trigger(bool on) { layer2_.request_trigger(on); }
  /// Errors, failures and messages that come while these are held are cleared at once.
  void hold_clear_errors(bool held, can::Time now);
  void hold_clear_emergencies(bool held, can::Time now);
  void hold_clear_nmt_errors(bool held, can::Time now);
  /// Clears those that are there.
  void clear_nmt_errors(can::Time now);
  /// After every event: what hangs on several causes.
  void update(can::Time now);

  // --- for the request port: what is
  [[nodiscard]] const ModuleModel& description() const noexcept { return model_; }
  [[nodiscard]] const Profile& profile() const noexcept { return profile_; }
  [[nodiscard]] const ModuleState& state() const noexcept { return state_; }
  [[nodiscard]] bool any_error() const noexcept { return errors_.any(); }
  [[nodiscard]] bool any_nmt_error() const noexcept {
    return state_.canopen_mode() && nmt_status_.any_failure();
  }
  [[nodiscard]] bool any_emergency() const noexcept { return state_.canopen_mode() && !emergencies_.empty(); }
  [[nodiscard]] bool trigger_done() const noexcept { return layer2_.trigger_done(); }
  /// For a port with words of its own.
  [[nodiscard]] BufferMemory& memory() noexcept { return buffer_; }

 private:
  using Phase = ModuleState::Phase;
  /// Not sent yet.
  struct Event {
    const EmergencyRow* row = nullptr;
    std::uint8_t node_id = 0;  ///< added to the code
  };

  // CommandHost
  std::uint16_t bus_obstacle() const override;
  std::uint8_t own_node_id() const override { return node_.node_id(); }
  canopen::ObjectDictionary& dictionary() override { return node_.dictionary(); }
  can::Duration sdo_time_out() const override { return network_settings_.sdo_time_out(); }
  bool sdo_channel_free(std::uint8_t node_id) const override { return !master_.sdo_channel_busy(node_id); }
  EmergencyAnswer send_emergency(std::uint16_t code, std::uint8_t error_register,
                                 std::span<const std::uint8_t, 5> manufacturer, can::Time now) override;
  FrameAnswer send_plain_frame(std::span<const std::uint16_t> parameters,
                               std::span<std::uint16_t> faults) override;
  void command_finished(can::Time now) override { port_->done(Request::command, now); }

  // NodeListener
  void nmt_state_changed(canopen::NmtState state, can::Time now) override;
  void reset_requested(canopen::NmtCommand which, can::Time now) override;
  void defaults_loaded(canopen::NmtCommand which, can::Time now) override;
  void reset_done(canopen::NmtCommand which, can::Time now) override;
  bool may_become_operational() override;
  void emergency_received(const canopen::Emergency& message, can::Time now) override;
  void emergency_raised(const canopen::Emergency& message, can::Time now) override;
  void rpdo_received(std::uint16_t number, can::Time now) override;
  void time_received(const canopen::TimeOfDay& time, can::Time now) override;
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) override;
  void heartbeat_lost(std::uint8_t node_id, can::Time now) override;
  void life_guarding_event(bool occurred, can::Time now) override;
  void object_written(const canopen::Entry& entry, can::Time now) override;

  // ObjectHandler: 0002H-0008H
  canopen::AbortCode before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                 can::Time now) override;
  canopen::AbortCode before_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                  std::span<const std::uint8_t> value, can::Time now) override;

  // MasterListener
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

  // Life cycle.
  void end_due_initialization(can::Time now);
  void begin_initialization(can::Duration duration, can::Time now);
  [[nodiscard]] bool configuration_is_faulty(can::Time now);
  void end_save(can::Time now);
  /// CPU in STOP: 1029H:01, emergency message, and what the model's CpuRules say.
  void enter_stop(const EmergencyRow& row, can::Time now);
  void enter_run(can::Time now);
  /// 1F80H makes the node an NMT master, active or not.
  [[nodiscard]] bool is_master_by_role() const;
  void join_layer2_bus(can::Time now);
  void leave_layer2_bus(can::Time now);
  void end_sending(const can::Frame& frame);

  // Status.
  [[nodiscard]] LedPattern network_state_pattern() const;
  [[nodiscard]] LedPattern network_error_pattern() const;
  void raise_event(const EmergencyRow& row, std::uint8_t node_id = 0) {
    if (events_.size() < most_events) events_.push_back({&row, node_id});
  }
  void send_events(can::Time now);
  void log_changes(can::Time now);
  void look_at_overflows(can::Time now);
  void report(std::string_view what, can::Time now);
  void tell_of_word(BufferAddress address, std::uint16_t value, std::string_view what, can::Time now);

  const ModuleModel& model_;
  can::Controller& controller_;
  can::Gate network_;  // closed while the LSS search has the controller at another bit rate
  Profile profile_;
  ModuleObserver* observer_ = nullptr;
  ModuleState state_;

  BufferMemory buffer_;
  RegisterWords registers_;
  ModuleSettings settings_;
  ErrorStatus errors_;
  Diagnostics diagnostics_;
  EmergencyBuffer emergencies_;
  NmtStatus nmt_status_;
  canopen::Node node_;
  manager::NmtMaster master_;
  CommandInterface command_;
  NetworkSettings network_settings_;
  DataExchange process_data_;
  Layer2 layer2_;
  ProcessDataWindows windows_;
  ExchangeControl exchange_;
  TimeStamp time_stamp_;
  StatusWords status_words_;
  ConciseDcfStore concise_dcfs_;
  std::unique_ptr<RequestPort> port_;

  bool cpu_failed_ = false;   // the STOP that comes is an error's
  bool stop_is_due_ = false;  // the node has started with the CPU in STOP
  bool restarting_ = false;
  // What the event history has been told of.
  bool logged_online_ = false;
  bool logged_warning_ = false;
  bool logged_active_ = false;
  bool controller_sends_last_ = false;  // off the bus after the message that says that the module restarts
  bool clear_concise_dcfs_ = false;     // 1011H was written: at the next restart
  can::Time last_frame_{};              // sent or received
  std::uint32_t overflows_ = 0;
  static constexpr std::size_t most_events = 8;
  std::vector<Event> events_;  // of the module's own finding, sent after what caused them is dealt with

  can::Time events_due_ = can::never;  // the inhibit time 1015H held some back
  can::Time initialized_at_ = can::never;
  bool wire_left_ = true;               // Layer 2 offline, where that means off the wire
  can::Time off_wire_at_ = can::never;  // Layer 2 offline: when the last frame is over for certain
};

}  // namespace canopus::module
