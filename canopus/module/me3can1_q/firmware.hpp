#pragma once
// What runs inside the ME3CAN1-Q: life cycle (power, initialization, restart), signals, and the areas of the
// buffer memory, tied to one CANopen node and its NMT master. Private to the module's folder.

#include <array>
#include <map>
#include <vector>

#include "canopus/can/gate.hpp"
#include "canopus/manager/nmt_master.hpp"
#include "canopus/module/buffer_memory.hpp"
#include "canopus/module/command_interface.hpp"
#include "canopus/module/concise_dcf_store.hpp"
#include "canopus/module/data_exchange.hpp"
#include "canopus/module/emergency_buffer.hpp"
#include "canopus/module/error_status.hpp"
#include "canopus/module/flash_memory.hpp"
#include "canopus/module/layer2.hpp"
#include "canopus/module/me3can1_q/me3can1_q.hpp"
#include "canopus/module/nmt_status.hpp"
#include "canopus/module/signals.hpp"
#include "canopus/module/time_stamp.hpp"

namespace canopus::module::me3can1_q {

class Me3can1Q::Firmware final : public BufferArea,
                                 public CommandHost,
                                 public canopen::NodeListener,
                                 public canopen::ObjectHandler,
                                 public manager::MasterListener {
 public:
  Firmware(can::Controller& controller, NonVolatileMemory& memory, Profile profile);

  bool preset_word(BufferAddress address, std::uint16_t value);
  canopen::AbortCode preset_object(std::uint16_t index, std::uint8_t sub,
                                   std::span<const std::uint8_t> value);
  [[nodiscard]] std::optional<BufferAddress> layer2_preset_error() const;
  [[nodiscard]] bool takes_word(BufferAddress address, std::uint16_t value) const;

  std::uint16_t read(BufferAddress address, can::Time now);
  void write(BufferAddress address, std::uint16_t value, can::Time now);
  void set_output(unsigned number, bool on, can::Time now);
  void power_on(can::Time now);
  void power_off(can::Time now);
  void cpu_changed(CpuState state, can::Time now);
  void cpu_failed(can::Time now);
  void inject(ModuleFault fault, can::Time now);
  void set_observer(ModuleObserver* observer);

  void receive(const can::Frame& frame, can::Time now);
  void transmitted(const can::Frame& frame, can::Time now);
  void controller_changed(can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept;

  [[nodiscard]] std::vector<Led> leds(can::Time now) const;
  [[nodiscard]] const Signals& signals() const noexcept { return signals_; }
  [[nodiscard]] const Profile& profile() const noexcept { return profile_; }
  [[nodiscard]] const canopen::Node& node() const noexcept { return node_; }
  [[nodiscard]] const manager::NmtMaster& master() const noexcept { return master_; }
  [[nodiscard]] std::uint32_t flash_writes() const noexcept { return flash_.writes(); }
  [[nodiscard]] Layer2State layer2_state() const noexcept;

  // BufferArea: the status words that are made when they are read (G20 G25 G35 G36 G37), and G50.
  std::uint16_t read_word(BufferAddress address, can::Time now) override;
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

  // CommandHost
  std::uint16_t bus_obstacle() const override;
  std::uint8_t own_node_id() const override { return node_.node_id(); }
  canopen::ObjectDictionary& dictionary() override { return node_.dictionary(); }
  can::Duration sdo_time_out() const override;
  bool sdo_channel_free(std::uint8_t node_id) const override { return !master_.sdo_channel_busy(node_id); }
  EmergencyAnswer send_emergency(std::uint16_t code, std::uint8_t error_register,
                                 std::span<const std::uint8_t, 5> manufacturer, can::Time now) override;
  FrameAnswer send_plain_frame(std::span<const std::uint16_t> parameters,
                               std::span<std::uint16_t> faults) override;
  void command_finished(can::Time now) override;

  // NodeListener
  void nmt_state_changed(canopen::NmtState state, can::Time now) override;
  void reset_requested(canopen::NmtCommand which, can::Time now) override;
  void reset_done(canopen::NmtCommand which, can::Time now) override;
  bool may_become_operational() override;
  void emergency_received(const canopen::Emergency& message, can::Time now) override;
  void rpdo_received(std::uint16_t number, can::Time now) override;
  void time_received(const canopen::TimeOfDay& time, can::Time now) override;
  void heartbeat_received(std::uint8_t node_id, canopen::NmtState state, can::Time now) override;
  void heartbeat_lost(std::uint8_t node_id, can::Time now) override;
  void life_guarding_event(bool occurred, can::Time now) override;
  void object_written(const canopen::Entry& entry, can::Time now) override;

  // ObjectHandler: 0002H-0008H, 1010H, 1011H
  canopen::AbortCode before_read(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                 can::Time now) override;
  canopen::AbortCode before_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                                  std::span<const std::uint8_t> value, can::Time now) override;
  void after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                   can::Time now) override;

  // MasterListener
  void boot_went_on(std::uint8_t node_id, const manager::BootRecord& record, can::Time now) override;
  void start_up_halted(std::uint8_t node_id, manager::BootError error, can::Time now) override;
  void error_control_event(std::uint8_t node_id, manager::ErrorControlEvent event, can::Time now) override;
  void lss_active_changed(bool active, can::Time now) override;
  void change_bit_rate(std::uint32_t bit_rate, can::Time now) override;
  void lss_search_ended(std::uint8_t node_id, bool found, can::Time now) override;
  void node_state_changed(std::uint8_t node_id, std::uint8_t state, can::Time now) override;
  void error_control_changed(std::uint8_t node_id, std::uint16_t bits, can::Time now) override;
  bool sdo_channel_free(std::uint8_t node_id) override { return command_.remote_node() != node_id; }

 private:
  enum class State : std::uint8_t {
    off,           ///< no supply
    initializing,  ///< power-on or Y02 until the settings are in force
    stuck,         ///< initializing for ever: the stored object dictionary is faulty
    running,
  };
  /// An emergency of the module's own finding: sent after the event that caused it is dealt with.
  struct Event {
    std::uint16_t code;
    std::uint8_t error_register;
    std::array<std::uint8_t, 5> manufacturer;
  };

  // Life cycle.
  void begin_initialization(can::Duration duration, can::Time now);
  void end_initialization(can::Time now);
  void begin_restart(can::Time now);
  [[nodiscard]] bool configuration_is_faulty(can::Time now);
  void load_settings();
  bool use_stored_words();
  [[nodiscard]] Modes preset_mode() const;
  void load_objects();
  void use_communication_settings();
  [[nodiscard]] bool initializing() const noexcept;
  [[nodiscard]] bool canopen_mode() const noexcept;

  // Signals.
  void rising(unsigned number, can::Time now);
  void falling(unsigned number, can::Time now);
  void begin_exchange(can::Time now);
  void end_exchange(can::Time now);
  void exchange_process_data(can::Time now);
  void go_online(can::Time now);
  void begin_save(can::Time now);
  void end_save(can::Time now);
  void clear_nmt_errors(can::Time now);
  void set_clock(can::Time now);
  void send_time(can::Time now);
  void use_time_role();

  // Status.
  [[nodiscard]] std::uint16_t communication_status() const;
  void update(can::Time now);
  [[nodiscard]] static Event cpu_event(bool error);
  void raise_event(Event event) {
    if (events_.size() < most_events) events_.push_back(event);
  }
  void send_events(can::Time now);
  void tell(std::string_view what, can::Time now);
  void tell_wear(can::Time now);

  can::Controller& controller_;
  can::Gate network_;  // closed while the LSS search has the controller at another bit rate
  NonVolatileMemory& memory_;
  FlashMemory flash_;  // the settings; the mark of a running save is in memory_ itself
  Profile profile_;
  ModuleObserver* observer_ = nullptr;

  BufferMemory buffer_;
  Signals signals_;
  ErrorStatus errors_;
  EmergencyBuffer emergencies_;
  NmtStatus nmt_status_;
  canopen::Node node_;
  manager::NmtMaster master_;
  CommandInterface command_;
  DataExchange exchange_;
  Layer2 layer2_;
  TimeStamp time_stamp_;
  ConciseDcfStore concise_dcfs_;

  State state_ = State::off;
  std::uint16_t mode_ = 405;      // active function mode: 405, 11, 29
  std::uint16_t mode_bit_ = 1;    // the same for the tables
  std::uint16_t bit_rate_ = 250;  // active, in kbit/s
  CpuState cpu_ = CpuState::run;
  bool flash_error_ = false;
  bool hardware_fault_ = false;
  bool cpu_failed_ = false;      // the STOP that comes is an error's
  bool nmt_reset_seen_ = false;  // G25.6
  bool time_seen_ = false;       // G25.12
  can::Time last_frame_{};       // sent or received
  bool process_data_pending_ = false;
  bool emergencies_pending_ = false;
  bool exchange_running_ = false;
  std::uint16_t save_request_ = 0;
  std::uint32_t overflows_ = 0;
  static constexpr std::size_t most_events = 8;
  std::vector<Event> events_;  // not sent yet

  can::Time events_due_ = can::never;  // the inhibit time 1015H held some back
  can::Time initialized_at_ = can::never;
  can::Time restart_again_at_ = can::never;
  can::Time nmt_reset_end_ = can::never;
  can::Time exchange_end_ = can::never;
  can::Time save_end_ = can::never;

  // What the module leaves the shelf with (presets), and what it has stored of the buffer memory.
  StoredWords shelf_words_;
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::vector<std::uint8_t>> shelf_objects_;
  StoredWords stored_words_;
  bool restarting_ = false;
  bool clear_concise_dcfs_ = false;  // 1011H was written: at the next restart
  std::uint32_t told_writes_ = 0;    // of the flash memory, when its wear was last looked at
};

}  // namespace canopus::module::me3can1_q
