#pragma once
// The MELSEC Q module ME3CAN1-Q: 32 points, buffer memory Un\G0..., one CAN port, three function modes:
// CANopen (CiA 405) and plain CAN with 11- or 29-bit identifiers.
//
// This class is the wiring. What an area of the buffer memory does is in canopus/module; the module's facts
// are the tables beside this file: buffer_table.hpp (memory map), object_table.hpp (object dictionary).

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopus/module/communication_module.hpp"

namespace canopus::module::me3can1_q {

/// What the manual gives as "about", leaves open, or prints on the housing.
struct Profile {
  /// Y02 to X02 [ME3CAN1-Q 3.3.2: approx. 6 s].
  can::Duration restart_time = std::chrono::seconds(6);
  /// How long X02 stays ON before Y02, still ON, counts as the next restart. Not printed.
  can::Duration restart_repeat_time = std::chrono::milliseconds(500);
  /// Supply on to the end of initialization (G25.7 = 0). Not printed.
  can::Duration power_on_time = std::chrono::seconds(1);
  /// An NMT reset to the end of initialization. Not printed.
  can::Duration nmt_reset_time = std::chrono::milliseconds(10);
  /// Y01 to X01. Not printed.
  can::Duration exchange_time = std::chrono::milliseconds(1);
  /// Shortest time from Y17 to X17; G1000 reads FFFFH meanwhile. Not printed.
  can::Duration command_time = std::chrono::milliseconds(1);
  /// Y1F to X1F. Not printed.
  can::Duration save_time = std::chrono::milliseconds(100);
  /// Unit of parameter D of a Layer 2 slot: the table says 10 ms, the text 1 ms [ME3CAN1-Q 3.6.2].
  can::Duration layer2_cycle_unit = std::chrono::milliseconds(10);
  /// Layer 2 receive processing: time per message, and messages that may wait for it. Not printed.
  can::Duration layer2_message_time = std::chrono::microseconds(100);
  unsigned layer2_waiting_messages = 8;
  /// How long the flash memory takes no concise DCF after one was deleted. Not printed.
  can::Duration erase_time = std::chrono::seconds(2);
  /// Product list entries [ME3CAN1-Q 2.3].
  std::string serial_number = "1203100000000000";
  std::string function_version = "B";
};

class Me3can1Q final : public CommunicationModule {
 public:
  /// Off until power_on(). The controller and the memory must outlive the module.
  Me3can1Q(can::Controller& controller, NonVolatileMemory& memory, Profile profile = {});
  ~Me3can1Q() override;
  Me3can1Q(const Me3can1Q&) = delete;
  Me3can1Q& operator=(const Me3can1Q&) = delete;

  /// Only words that G22 saves: G21 G24 G27 G59 G70 G71, layer 2 configuration.
  bool preset_word(BufferAddress address, std::uint16_t value) override;
  bool preset_bit_rate(std::uint32_t bit_rate) override;
  bool preset_node_id(std::uint8_t node_id) override;
  canopen::AbortCode preset_object(std::uint16_t index, std::uint8_t sub,
                                   std::span<const std::uint8_t> value) override;
  [[nodiscard]] std::optional<BufferAddress> layer2_preset_error() const override;
  [[nodiscard]] bool takes_word(BufferAddress address, std::uint16_t value) const override;
  [[nodiscard]] const ProgramInterface& program_interface() const noexcept override;

  [[nodiscard]] std::string_view model() const noexcept override { return "ME3CAN1-Q"; }
  [[nodiscard]] unsigned points() const noexcept override { return 32; }
  [[nodiscard]] ProductInformation product() const noexcept override;
  [[nodiscard]] BufferAddress buffer_memory_size() const noexcept override { return 65536; }
  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) override;
  void write_word(BufferAddress address, std::uint16_t value, can::Time now) override;
  [[nodiscard]] std::uint32_t inputs() const noexcept override;
  [[nodiscard]] std::uint32_t outputs() const noexcept override;
  void set_output(unsigned signal, bool on, can::Time now) override;
  void power_on(can::Time now) override;
  void power_off(can::Time now) override;
  void cpu_changed(CpuState state, can::Time now) override;
  void cpu_failed(can::Time now) override;
  /// hardware_error: G29.1 and X0F ON, X00 OFF. watchdog_error: as without supply; signals and LEDs OFF
  /// [ME3CAN1-Q 3.1.1, 3.3.2, 3.5.7].
  void inject(ModuleFault fault, can::Time now) override;
  [[nodiscard]] const manager::NmtMaster* master() const noexcept override;
  void set_observer(ModuleObserver* observer) override;

  void receive(const can::Frame& frame, can::Time now) override;
  void transmitted(const can::Frame& frame, can::Time now) override;
  void controller_changed(can::Time now) override;
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override;

  [[nodiscard]] const Profile& profile() const noexcept;
  /// RUN, ERR., CAN RUN, TX/RX, CAN ERR [ME3CAN1-Q 3.1.1].
  [[nodiscard]] std::vector<Led> leds(can::Time now) const override;
  /// The real flash memory tolerates 10000 [ME3CAN1-Q 4.6].
  [[nodiscard]] std::uint32_t flash_writes() const noexcept override;
  [[nodiscard]] const canopen::Node& node() const noexcept override;
  [[nodiscard]] Layer2State layer2_state() const noexcept override;

 private:
  class Firmware;
  std::unique_ptr<Firmware> firmware_;
};

}  // namespace canopus::module::me3can1_q
