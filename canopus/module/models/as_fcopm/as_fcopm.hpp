#pragma once
// The AS-FCOPM: the CANopen function card of Delta's AS300, as master or slave. It has no buffer memory and no signals: a
// program works with it by registers of the CPU (register_table.hpp). Its parameters are downloaded by CANopen Builder
// (configuration.hpp) and count from the next start of the PLC on [AS-FCOPM 10.6].
//
//   off --supply--> initializing --power_on_time--> running
//                                                   wrong_setting (F5), fault (F8): off the bus until the supply goes

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/module/interface/non_volatile_memory.hpp"
#include "canopus/module/interface/observer.hpp"
#include "canopus/module/models/as_fcopm/role.hpp"

namespace canopus::module::as_fcopm {

class AsFcopm final : public CommunicationModule, public RegisterAccess {
 public:
  /// How long a download takes. Not printed.
  static constexpr can::Duration download_time = std::chrono::seconds(2);

  /// Off until power_on(). The controller must outlive the module. The memory is not used: what was downloaded is the
  /// PLC's.
  AsFcopm(can::Controller& controller, NonVolatileMemory& memory, const Profile& profile = {});

  /// CANopen Builder's download. Off, it is there at once. On, SR825 shows it for download_time, and it counts from the
  /// next power_on() on; a supply that goes off meanwhile ends it, and the parameters before stay.
  void download(Configuration configuration, can::Time now = {});
  /// What the next start takes.
  [[nodiscard]] const Configuration& downloaded() const noexcept { return stored_; }

  // CommunicationModule
  bool preset_bit_rate(std::uint32_t bit_rate) override;
  bool preset_node_id(std::uint8_t node_id) override;
  /// Of the slave's objects that can be written.
  canopen::AbortCode preset_object(std::uint16_t index, std::uint8_t sub,
                                   std::span<const std::uint8_t> value) override;
  [[nodiscard]] std::span<const std::uint8_t> object_preset(std::uint16_t index,
                                                            std::uint8_t sub) const override;
  [[nodiscard]] std::optional<InitialNode> initial_node() override;
  [[nodiscard]] const ProgramInterface& program_interface() const noexcept override;
  /// Another object after each start and download: keep no reference.
  [[nodiscard]] const canopen::Node& node() const noexcept override { return role_->node(); }
  [[nodiscard]] std::vector<SlaveBootRecord> boots() const override;
  [[nodiscard]] std::vector<canopen::Emergency> emergency_history() const override {
    return role_->emergency_history();
  }
  [[nodiscard]] std::uint64_t change_count() const noexcept override { return change_count_; }
  [[nodiscard]] ModuleInformation information() const override;
  /// The chapter describes none.
  [[nodiscard]] std::vector<Led> leds(can::Time) const override { return {}; }
  [[nodiscard]] std::uint32_t flash_writes() const noexcept override { return 0; }

  // Module
  [[nodiscard]] std::string_view model() const noexcept override;
  [[nodiscard]] unsigned points() const noexcept override { return 0; }
  [[nodiscard]] ProductInformation product() const noexcept override;
  [[nodiscard]] StartUp start_up() const noexcept override;
  [[nodiscard]] RegisterAccess* registers() noexcept override { return this; }
  void power_on(can::Time now) override;
  void power_off(can::Time now) override;
  void cpu_changed(CpuState state, can::Time now) override;
  void cpu_failed(can::Time now) override;
  void inject(ModuleFault fault, can::Time now) override;
  void set_observer(ModuleObserver* observer) override { observer_ = observer; }

  // RegisterAccess
  [[nodiscard]] std::span<const RegisterRange> registers() const noexcept override;
  [[nodiscard]] std::uint16_t read_register(RegisterKind kind, std::uint32_t number, can::Time now) override;
  void write_register(RegisterKind kind, std::uint32_t number, std::uint16_t value, can::Time now) override;

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& frame, can::Time now) override;
  void controller_changed(can::Time now) override;
  void tick(can::Time now) override;

 private:
  enum class Phase : std::uint8_t { off, initializing, running, wrong_setting, fault };

  /// The role of what the next start takes; of factory settings if that is wrong.
  void make_role();
  [[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> slave_objects() const;
  [[nodiscard]] bool is_master() const noexcept { return in_use_.work_mode == WorkMode::master; }
  [[nodiscard]] bool has_role() const noexcept {
    return phase_ == Phase::initializing || phase_ == Phase::running;
  }
  [[nodiscard]] OwnCode own_code() const noexcept;
  void check_queues();
  void report(std::string_view what, can::Time now) const {
    if (observer_ != nullptr) observer_->error_raised(what, now);
  }

  can::Controller& controller_;
  const Profile profile_;
  ModuleObserver* observer_ = nullptr;
  Configuration stored_;
  Configuration in_use_;
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::vector<std::uint8_t>> presets_;
  std::unique_ptr<Role> role_;
  Phase phase_ = Phase::off;
  can::Alarm initialized_at_;
  std::optional<Configuration> downloading_;
  can::Alarm downloaded_at_;
  bool cpu_has_failed_ = false;
  std::uint64_t change_count_ = 0;
  // Until the supply goes off.
  bool was_bus_off_ = false;
  bool send_buffer_was_full_ = false;
  bool receive_buffer_was_full_ = false;
};

}  // namespace canopus::module::as_fcopm
