#pragma once
// The MELSEC Q module ME3CAN1-Q: 32 points, buffer memory Un\G0..., one CAN port, three function modes:
// CANopen (CiA 405) and plain CAN with 11- or 29-bit identifiers.
//
// This class is the wiring. What an area of the buffer memory does is in canopus/module; the module's facts
// are the tables beside this file: buffer_table.hpp (memory map), object_table.hpp (object dictionary).

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "canopus/canopen/node.hpp"
#include "canopus/module/layer2.hpp"
#include "canopus/module/led.hpp"
#include "canopus/module/module.hpp"

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

class Me3can1Q final : public Module {
 public:
  /// Off until power_on(). The controller and the memory must outlive the module.
  Me3can1Q(can::Controller& controller, NonVolatileMemory& memory, Profile profile = {});
  ~Me3can1Q() override;
  Me3can1Q(const Me3can1Q&) = delete;
  Me3can1Q& operator=(const Me3can1Q&) = delete;

  /// A setting the module leaves the shelf with, in place of the factory default, until it saves its own (G22
  /// and Y1F). Only words that G22 saves (G21 G24 G27 G59 G70 G71, layer 2 configuration), checked as a write
  /// is; false otherwise. To be called before power_on().
  bool preset_buffer(BufferAddress address, std::uint16_t value);
  /// The same for an object that 1010H stores, until 1010H stores for the first time. The answer of a write:
  /// no_object, no_sub_index, length_too_low, invalid_value ..., cannot_store for an object that 1010H does
  /// not store.
  canopen::AbortCode preset_object(std::uint16_t index, std::uint8_t sub,
                                   std::span<const std::uint8_t> value);
  /// The first of the preset words that would keep the module from going online in the Layer 2 mode they
  /// select.
  [[nodiscard]] std::optional<BufferAddress> layer2_preset_error() const;
  /// A program may write this value to this word in the preset function mode.
  [[nodiscard]] bool takes_word(BufferAddress address, std::uint16_t value) const;

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
  [[nodiscard]] std::array<Led, 5> leds(can::Time now) const;
  /// Writes of the flash memory over all runs, as it would wear; the real one tolerates 10000
  /// [ME3CAN1-Q 4.6].
  [[nodiscard]] std::uint32_t flash_writes() const noexcept;
  /// The CANopen node inside, for display (state, node-ID, objects).
  [[nodiscard]] const canopen::Node& node() const noexcept;
  /// Likewise: whether it is in a Layer 2 mode, and online.
  [[nodiscard]] Layer2State layer2_state() const noexcept;

 private:
  class Firmware;
  std::unique_ptr<Firmware> firmware_;
};

}  // namespace canopus::module::me3can1_q
