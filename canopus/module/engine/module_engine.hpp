#pragma once
// What runs inside a communication module with a buffer memory: life cycle (supply, initialization, restart),
// the stored settings, data exchange, and the areas of the buffer memory, tied to one CANopen node and its
// NMT master, or to Layer 2. What a model's manual says of words, bits and commands is its ModuleModel.
//
// How the PLC program makes a request is the concern of the model's request port (request_port.hpp): it
// calls the requests below, and is notified of their ends.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/module/engine/controller_monitor.hpp"
#include "canopus/module/engine/cpu_state_handler.hpp"
#include "canopus/module/engine/exchange_control.hpp"
#include "canopus/module/engine/layer2_mode.hpp"
#include "canopus/module/engine/module_context.hpp"
#include "canopus/module/engine/module_indication.hpp"
#include "canopus/module/engine/module_node.hpp"
#include "canopus/module/engine/register_words.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/memory/process_data_windows.hpp"

namespace canopus::module {

class ModuleEngine : public CommunicationModule, public BufferMemoryAccess {
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
    return context_.settings.object_preset(index, sub);
  }
  [[nodiscard]] bool presets_canopen_mode() const override {
    return context_.settings.presets_canopen_mode();
  }
  [[nodiscard]] bool presets_free_pdos() const override { return context_.settings.presets_free_pdos(); }
  [[nodiscard]] std::optional<BufferAddress> layer2_preset_error() const override;
  [[nodiscard]] bool takes_word(BufferAddress address, std::uint16_t value) const override;
  [[nodiscard]] bool takes_parameters() const noexcept override { return context_.model.takes_parameters; }
  bool parameter_word(BufferAddress address, std::uint16_t value) override;
  canopen::AbortCode parameter_object(std::uint16_t index, std::uint8_t sub,
                                      std::span<const std::uint8_t> value) override;
  bool parameter_concise_dcf(std::uint8_t node_id, std::vector<std::uint8_t> file) override;
  void use_refresh() override { exchange_.use_refresh(); }
  void refresh(can::Time now) override;
  [[nodiscard]] std::optional<InitialNode> initial_node() override;
  [[nodiscard]] const ProgramInterface& program_interface() const noexcept override {
    return context_.model.program_interface;
  }
  [[nodiscard]] const canopen::Node& node() const noexcept override { return node_.node(); }
  [[nodiscard]] std::uint64_t change_count() const noexcept override {
    return node_.change_count() + layer2_frames_;
  }
  [[nodiscard]] Layer2State layer2_state() const noexcept override {
    if (context_.state.canopen_mode()) return Layer2State::inactive;
    return layer2_.online() ? Layer2State::online : Layer2State::offline;
  }
  [[nodiscard]] std::vector<ModuleEventRecord> event_history() const override {
    return {context_.diagnostics.history().begin(), context_.diagnostics.history().end()};
  }
  [[nodiscard]] std::vector<ModuleErrorRecord> module_errors() const override {
    return context_.diagnostics.errors();
  }
  [[nodiscard]] std::vector<canopen::Emergency> emergency_history() const override;
  [[nodiscard]] std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) const override {
    return node_.concise_dcf(node_id);
  }
  bool clear_module_errors() override { return context_.diagnostics.clear_minor(); }
  [[nodiscard]] ModuleInformation information() const override;
  [[nodiscard]] std::vector<Led> leds(can::Time now) const override {
    return leds_of({context_, node_, layer2_, cpu_}, last_frame_, now);
  }
  [[nodiscard]] std::vector<SlaveBootRecord> boots() const override;
  [[nodiscard]] std::uint32_t flash_writes() const noexcept override {
    return context_.settings.flash().writes();
  }

  // Module
  [[nodiscard]] std::string_view model() const noexcept override { return context_.model.data_sheet->model; }
  [[nodiscard]] unsigned points() const noexcept override { return context_.model.data_sheet->points; }
  [[nodiscard]] ProductInformation product() const noexcept override;
  [[nodiscard]] StartUp start_up() const noexcept override;
  [[nodiscard]] BufferMemoryAccess* buffer_memory() noexcept override {
    return context_.model.buffer_memory_size == 0 ? nullptr : this;
  }
  [[nodiscard]] RegisterAccess* registers() noexcept override {
    return context_.model.registers.empty() ? nullptr : &registers_;
  }
  [[nodiscard]] SignalAccess* signals() noexcept override { return context_.port->signals(); }
  void power_on(can::Time now) override;
  void power_off(can::Time now) override;
  void cpu_changed(CpuState state, can::Time now) override;
  void cpu_failed(can::Time now) override;
  void inject(ModuleFault fault, can::Time now) override;
  void set_observer(ModuleObserver* observer) override;

  // BufferMemoryAccess
  [[nodiscard]] BufferAddress buffer_memory_size() const noexcept override {
    return context_.model.buffer_memory_size;
  }
  [[nodiscard]] std::uint16_t peek(BufferAddress address, can::Time now) const override {
    return context_.state.phase == Phase::off ? std::uint16_t{0} : context_.buffer.peek(address, now);
  }
  [[nodiscard]] std::uint16_t program_read(BufferAddress address, can::Time now) override;
  void write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& frame, can::Time now) override;
  void controller_changed(can::Time now) override;
  void tick(can::Time now) override;

  // --- for the request port: requests of the PLC program; the module is on
  /// As the data exchange control word says.
  void begin_exchange(can::Time now);
  /// Process data run, or wait for Operational.
  [[nodiscard]] bool exchanging() const noexcept { return exchange_.running(); }
  void begin_restart(can::Time now);
  /// As the save/restore word says.
  void begin_save(can::Time now);
  /// The request is taken back.
  void end_save_request() noexcept { save_is_refused_ = false; }
  void execute_command(can::Time now);
  void set_clock(can::Time now);
  void read_clock(can::Time now);
  void go_online(can::Time now);
  void go_offline(can::Time now) { layer2_.go_offline(now); }
  void request_trigger(bool on) { layer2_.request_trigger(on); }
  /// Errors, failures and messages that come while these are held are cleared at once.
  void hold_clear_errors(bool held, can::Time now);
  void hold_clear_emergencies(bool held, can::Time now);
  void hold_clear_nmt_errors(bool held, can::Time now);
  /// Clears those that are there.
  void clear_nmt_errors(can::Time now);
  /// Those whose bits the program has written as 0.
  void clear_written_nmt_errors(can::Time now);
  /// After every event: what hangs on several causes.
  void update(can::Time now);

  // --- for the request port: what is
  [[nodiscard]] const ModuleModel& description() const noexcept { return context_.model; }
  [[nodiscard]] const Profile& profile() const noexcept { return context_.profile; }
  [[nodiscard]] const ModuleState& state() const noexcept { return context_.state; }
  /// No program may use the module: settings are being put in force, or the node is in an NMT reset.
  [[nodiscard]] bool initializing() const noexcept {
    return context_.state.initializing() || node_.is_resetting();
  }
  [[nodiscard]] bool any_error() const noexcept { return context_.errors.any(); }
  [[nodiscard]] bool any_nmt_error() const noexcept {
    return context_.state.canopen_mode() && node_.any_failure();
  }
  [[nodiscard]] bool any_emergency() const noexcept {
    return context_.state.canopen_mode() && !node_.received_emergencies().empty();
  }
  [[nodiscard]] bool trigger_done() const noexcept { return layer2_.slots().trigger_done(); }
  /// For a port with words of its own.
  [[nodiscard]] BufferMemory& memory() noexcept { return context_.buffer; }

 private:
  using Phase = ModuleState::Phase;

  void stop(Phase phase, can::Time now);
  void fail(can::Time now);
  void begin_initialization(can::Duration duration, can::Time now);
  /// What the CPU has for the module, while it initializes.
  void load_parameters(can::Time now);
  void end_due_initialization(can::Time now);
  [[nodiscard]] bool configuration_is_faulty(can::Time now);
  void end_save(can::Time now);
  void end_bad_settings();
  void check_words();
  /// Operational, or Layer 2 online.
  [[nodiscard]] bool is_online() const noexcept {
    if (!context_.state.running()) return false;
    return context_.state.canopen_mode() ? node_.state() == canopen::NmtState::operational : layer2_.online();
  }
  /// A word that a module with a faulty stored object dictionary takes.
  [[nodiscard]] bool is_writable_while_stuck(BufferAddress address) const noexcept;
  void note_access(BufferAddress address, can::Time now) {
    if (!context_.state.works()) return;
    context_.state.last_access = now;
    context_.watchdog.accessed(address, is_online(), now);
  }
  void end_sending(const can::Frame& frame);
  void find_errors_again(can::Time now);
  void apply_layer2_bit_rate();

  ModuleContext context_;
  ControllerMonitor controller_;
  ModuleNode node_;
  Layer2Mode layer2_;
  ProcessDataWindows windows_;
  ExchangeControl exchange_;
  RegisterWords registers_;
  CpuStateHandler cpu_{context_, node_, layer2_};
  ChangeLog change_log_{context_, node_, layer2_};

  bool restarting_ = false;
  bool takes_files_ = false;            // the supply came: concise DCFs of the CPU's parameters are stored
  bool controller_sends_last_ = false;  // off the bus after the message that says that the module restarts
  bool save_is_refused_ = false;        // as Layer 2 is online: as long as it is requested
  std::uint64_t layer2_frames_ = 0;     // received
  can::Time last_frame_{};              // sent or received
  can::Alarm initialized_at_;
};

}  // namespace canopus::module
