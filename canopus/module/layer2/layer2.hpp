#pragma once
// A module in a Layer 2 mode: 42 message slots on plain CAN, sent by data exchange, by time, by remote frame
// or by trigger flag, received through filters [ME3CAN1-Q 3.6; FX3U-CAN 9; RJ71CN91 1.11, App. 2].
//
// Offline the settings can be written and nothing is sent or received. Online the slots work with the
// settings they had at that moment. What a slot sends is what the last data exchange took from its words;
// what it received stays inside until the next one.
//
//   words --snapshot()--> next --exchange()--> outgoing --send--> controller
//   controller --receive()--> stored + flags --exchange()--> words

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "canopus/can/controller.hpp"
#include "canopus/module/layer2/layer2_settings.hpp"

namespace canopus::module {

/// Error codes of a slot.
namespace slot_error {
inline constexpr std::uint16_t receive_overflow = 0x2000;
}

/// Words of plain_frame() that are checked: identifier (low word, high word), RTR, DLC. Four words of data follow.
inline constexpr std::size_t plain_frame_parameters = 4;

/// A CAN frame as a command has it [ME3CAN1-Q 5; FX3U-CAN 9.7; FX2N-32CAN 6.3]; nothing when one of the four words is wrong,
/// which `faults` then shows at its place.
[[nodiscard]] std::optional<can::Frame> plain_frame(std::span<const std::uint16_t> parameters,
                                                    std::span<std::uint16_t> faults, bool extended);

/// What became of a frame of the command interface.
enum class PlainFrameResult : std::uint8_t { queued, setting_error, no_room };

class Layer2 final : public BufferArea {
 public:
  /// Everything must outlive it. A module without Layer 2 modes has no layout, and stays offline.
  Layer2(const std::optional<Layer2Layout>& layout, const Layer2Rules& rules, BufferMemory& memory,
         can::Controller& controller);

  /// Offline, as from power-on, with 29-bit or 11-bit identifiers.
  void start(bool extended);
  /// Takes the settings over and goes online, unless they keep it offline. Returns the address of the first
  /// setting that is wrong.
  std::optional<BufferAddress> go_online(can::Time now);
  /// Takes waiting frames back; RUN to STOP messages that are on their way still go.
  void go_offline();
  [[nodiscard]] bool online() const noexcept { return online_; }
  /// It has frames on the wire: online, or RUN to STOP messages on their way.
  [[nodiscard]] bool uses_bus() const noexcept { return online_ || stop_frame_.has_value(); }
  /// RUN to STOP messages that are on their way go no more.
  void drop_stop_messages() noexcept {
    stop_message_ = layer2_stop_messages;
    stop_frame_.reset();
  }
  [[nodiscard]] const Layer2Rules& rules() const noexcept { return rules_; }

  /// Takes what the PLC has written to the transmit slots; exchange() will use it.
  void snapshot();
  /// What was latched is sent where the transmission type requires it, received messages go into the words.
  void exchange();
  /// Trigger request: ON sends the slots whose trigger flags are set, one after another as the controller has
  /// room.
  void request_trigger(bool on);
  /// The request is ON and all its messages are with the controller.
  [[nodiscard]] bool trigger_done() const noexcept { return trigger_done_; }
  /// The CPU went from RUN to STOP.
  void cpu_stopped();
  /// Sends one frame of the command interface: CAN-ID low, high, RTR, DLC, data in `parameters`. A parameter
  /// that is wrong is copied to its place in `faults`.
  PlainFrameResult send(std::span<const std::uint16_t> parameters, std::span<std::uint16_t> faults);
  /// This frame, which is sent now, is the last one of send().
  [[nodiscard]] bool takes_command_frame(const can::Frame& frame) noexcept {
    if (command_frame_ != frame) return false;
    command_frame_.reset();
    return true;
  }

  void receive(const can::Frame& frame, can::Time now);
  void transmitted(const can::Frame& frame);
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept { return next_cycle_.deadline(); }
  [[nodiscard]] can::Alarm& alarm() noexcept { return next_cycle_; }

  /// The first word of the settings that makes no sense.
  [[nodiscard]] std::optional<BufferAddress> setting_error() const noexcept {
    return settings_.first_error();
  }
  /// The first slot, from 1, whose error code is not 0; 0: none.
  [[nodiscard]] unsigned first_slot_error() const noexcept;
  /// Some slot's error code is not 0.
  [[nodiscard]] bool any_slot_error() const noexcept;

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time) const override {
    return memory_->word(address);
  }
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

 private:
  std::optional<can::Frame> command_frame_;
  struct TransmitSlot {
    bool active = false;
    Layer2Transmission transmission{};
    RtrResponse response{};
    bool strict_dlc = false;
    bool next_strict_dlc = false;
    can::Duration cycle{};
    can::Time due = can::never;
    can::Frame next;      // as taken by snapshot(), like next_strict_dlc
    can::Frame outgoing;  // as of the last exchange
    can::Frame last;      // as last sent, or as it was on going online
  };
  struct ReceiveSlot {
    bool active = false;
    std::uint32_t identifier = 0;
    std::uint32_t mask = 0;
    bool any = false;         // `stored` holds a message
    std::uint16_t flags = 0;  // of what came since the last exchange
    can::Frame stored;
  };

  void load(unsigned slot);
  bool transmit(unsigned slot);
  void send_cycles(can::Time now);
  void plan_cycles() noexcept;
  void send_triggered();
  void send_stop_message();
  void answer(const can::Frame& request);
  void store(ReceiveSlot& slot, const can::Frame& frame);
  void show(unsigned slot);
  /// False: the receive processing is too far behind.
  bool receive_message(can::Time now);
  WriteResult write_block(BufferAddress address, std::uint16_t value);
  [[nodiscard]] bool flag(BufferAddress first, unsigned slot) const noexcept;
  void set_flag(BufferAddress first, unsigned slot, bool on);

  std::optional<Layer2Layout> layout_;
  Layer2Rules rules_;
  BufferMemory* memory_;
  can::Controller* controller_;
  Layer2Settings settings_;
  bool online_ = false;
  std::array<TransmitSlot, layer2_slots> transmit_;
  std::array<ReceiveSlot, layer2_slots> receive_;
  can::Alarm next_cycle_;
  can::Time receive_busy_until_{};
  bool snapshot_taken_ = false;
  bool trigger_requested_ = false;
  bool trigger_done_ = false;
  std::array<std::optional<can::Frame>, layer2_stop_messages> stop_messages_;  // as on going online
  unsigned stop_message_ = layer2_stop_messages;                               // the one to send next
  std::optional<can::Frame> stop_frame_;  // with the controller, not yet complete
};

}  // namespace canopus::module
