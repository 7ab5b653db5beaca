#pragma once
// What runs inside a communication module with a buffer memory: life cycle (supply, initialization, restart),
// the stored settings, data exchange, and the areas of the buffer memory, tied to one CANopen node and its
// NMT master, or to Layer 2. What a model's manual says of words, bits and commands is its ModuleModel.
//
// How the PLC program asks for something is the business of the model's request port (request_port.hpp): it
// calls the requests below, and hears of their ends.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/module/engine/controller_monitor.hpp"
#include "canopus/module/engine/cpu_state_handler.hpp"
#include "canopus/module/engine/layer2_online_state.hpp"
#include "canopus/module/engine/module_command_host.hpp"
#include "canopus/module/engine/module_context.hpp"
#include "canopus/module/engine/module_indication.hpp"
#include "canopus/module/engine/network_events.hpp"
#include "canopus/module/engine/register_words.hpp"
#include "canopus/module/interface/communication_module.hpp"

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
    return parts_.settings.object_preset(index, sub);
  }
  [[nodiscard]] bool presets_canopen_mode() const override { return parts_.settings.presets_canopen_mode(); }
  [[nodiscard]] bool presets_free_pdos() const override { return parts_.settings.presets_free_pdos(); }
  [[nodiscard]] std::optional<BufferAddress> layer2_preset_error() const override;
  [[nodiscard]] bool takes_word(BufferAddress address, std::uint16_t value) const override;
  [[nodiscard]] bool takes_parameters() const noexcept override { return parts_.model.takes_parameters; }
  bool parameter_word(BufferAddress address, std::uint16_t value) override;
  canopen::AbortCode parameter_object(std::uint16_t index, std::uint8_t sub,
                                      std::span<const std::uint8_t> value) override;
  bool parameter_concise_dcf(std::uint8_t node_id, std::vector<std::uint8_t> file) override;
  void use_refresh() override { parts_.exchange.use_refresh(); }
  void refresh(can::Time now) override;
  [[nodiscard]] std::optional<InitialNode> initial_node() override;
  [[nodiscard]] const ProgramInterface& program_interface() const noexcept override {
    return parts_.model.program_interface;
  }
  [[nodiscard]] const canopen::Node& node() const noexcept override { return parts_.node; }
  [[nodiscard]] std::uint64_t change_count() const noexcept override { return parts_.change_count; }
  [[nodiscard]] Layer2State layer2_state() const noexcept override { return parts_.layer2_state(); }
  [[nodiscard]] std::vector<ModuleEventRecord> event_history() const override {
    return {parts_.diagnostics.history().begin(), parts_.diagnostics.history().end()};
  }
  [[nodiscard]] std::vector<ModuleErrorRecord> module_errors() const override {
    return parts_.diagnostics.errors();
  }
  [[nodiscard]] std::vector<canopen::Emergency> kept_emergencies() const override;
  [[nodiscard]] std::span<const std::uint8_t> concise_dcf(std::uint8_t node_id) const override {
    return parts_.concise_dcfs.file(node_id);
  }
  bool clear_module_errors() override { return parts_.diagnostics.clear_minor(); }
  [[nodiscard]] ModuleInformation information() const override;
  [[nodiscard]] std::vector<Led> leds(can::Time now) const override {
    return leds_of(parts_, last_frame_, now);
  }
  [[nodiscard]] std::vector<SlaveBootRecord> boots() const override;
  [[nodiscard]] std::uint32_t flash_writes() const noexcept override {
    return parts_.settings.flash().writes();
  }

  // Module
  [[nodiscard]] std::string_view model() const noexcept override { return parts_.model.data_sheet->model; }
  [[nodiscard]] unsigned points() const noexcept override { return parts_.model.data_sheet->points; }
  [[nodiscard]] ProductInformation product() const noexcept override;
  [[nodiscard]] StartUp start_up() const noexcept override;
  [[nodiscard]] BufferMemoryAccess* buffer_memory() noexcept override {
    return parts_.model.buffer_memory_size == 0 ? nullptr : this;
  }
  [[nodiscard]] RegisterAccess* registers() noexcept override {
    return parts_.model.registers.empty() ? nullptr : &registers_;
  }
  [[nodiscard]] SignalAccess* signals() noexcept override { return parts_.port->signals(); }
  void power_on(can::Time now) override;
  void power_off(can::Time now) override;
  void cpu_changed(CpuState state, can::Time now) override;
  void cpu_failed(can::Time now) override;
  void inject(ModuleFault fault, can::Time now) override;
  void set_observer(ModuleObserver* observer) override;

  // BufferMemoryAccess
  [[nodiscard]] BufferAddress buffer_memory_size() const noexcept override {
    return parts_.model.buffer_memory_size;
  }
  [[nodiscard]] std::uint16_t peek(BufferAddress address, can::Time now) const override {
    return parts_.state.phase == Phase::off ? std::uint16_t{0} : parts_.buffer.peek(address, now);
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
  [[nodiscard]] bool exchanging() const noexcept { return parts_.exchange.running(); }
  void begin_restart(can::Time now);
  /// As the save/restore word says.
  void begin_save(can::Time now);
  /// The request is taken back.
  void end_save_request() noexcept { save_is_refused_ = false; }
  void execute_command(can::Time now);
  void set_clock(can::Time now);
  void read_clock(can::Time now);
  void go_online(can::Time now);
  void go_offline(can::Time now) { layer2_bus_.go_offline(now); }
  void request_trigger(bool on) { parts_.layer2.request_trigger(on); }
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
  [[nodiscard]] const ModuleModel& description() const noexcept { return parts_.model; }
  [[nodiscard]] const Profile& profile() const noexcept { return parts_.profile; }
  [[nodiscard]] const ModuleState& state() const noexcept { return parts_.state; }
  [[nodiscard]] bool any_error() const noexcept { return parts_.errors.any(); }
  [[nodiscard]] bool any_nmt_error() const noexcept { return parts_.any_nmt_error(); }
  [[nodiscard]] bool any_emergency() const noexcept {
    return parts_.state.canopen_mode() && !parts_.emergencies.empty();
  }
  [[nodiscard]] bool trigger_done() const noexcept { return parts_.layer2.trigger_done(); }
  /// For a port with words of its own.
  [[nodiscard]] BufferMemory& memory() noexcept { return parts_.buffer; }

 private:
  using Phase = ModuleState::Phase;

  void stop(Phase phase, can::Time now);
  void fail(can::Time now);
  void begin_initialization(can::Duration duration, can::Time now);
  /// Gives the node the dictionary of the function mode.
  void describe_node();
  /// What the CPU has for the module, while it initializes.
  void take_parameters(can::Time now);
  void end_due_initialization(can::Time now);
  [[nodiscard]] bool configuration_is_faulty(can::Time now);
  void end_save(can::Time now);
  void end_bad_settings();
  void look_at_words();
  /// Operational, or Layer 2 online.
  [[nodiscard]] bool is_online() const noexcept {
    if (!parts_.state.running()) return false;
    return parts_.state.canopen_mode() ? parts_.node.state() == canopen::NmtState::operational
                                       : parts_.layer2.online();
  }
  /// A word that a module with a faulty stored object dictionary takes.
  [[nodiscard]] bool is_writable_while_stuck(BufferAddress address) const noexcept;
  void note_access(BufferAddress address, can::Time now) {
    if (!parts_.state.works()) return;
    parts_.state.last_access = now;
    parts_.watchdog.accessed(address, is_online(), now);
  }
  void end_sending(const can::Frame& frame);
  void end_initialisation_of_node(const can::Frame& frame, can::Time now);
  void find_errors_again(can::Time now);
  void receive_pdo(const can::Frame& frame, can::Time now);
  void receive_other(const can::Frame& frame, can::Time now);
  void update_after_frame(can::Time now);

  ModuleCommandHost command_host_{parts_};
  ModuleContext parts_;
  RegisterWords registers_;
  ControllerMonitor controller_side_{parts_};
  CpuStateHandler cpu_side_{parts_};
  Layer2OnlineState layer2_bus_{parts_, controller_side_};
  NetworkEvents network_events_{parts_, cpu_side_, controller_side_, *this};
  ChangeLog change_log_{parts_};

  bool restarting_ = false;
  bool takes_files_ = false;            // the supply came: concise DCFs of the CPU's parameters are stored
  bool controller_sends_last_ = false;  // off the bus after the message that says that the module restarts
  bool save_is_refused_ = false;        // for Layer 2 is online: as long as it is asked for
  can::Time last_frame_{};              // sent or received
  can::Alarm initialized_at_;
};

}  // namespace canopus::module
