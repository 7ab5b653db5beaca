#pragma once
// The words that a module's Layer 2 modes are set up with, and which values they take. Plain CAN with 42
// message slots: each slot sends or receives one message, with a set of four parameters (A to D) and a block
// of seven words (CAN-ID low and high, RTR/new/DLC, four words of data), and up to four messages for the
// CPU's way from RUN to STOP [ME3CAN1-Q 3.6; FX3U-CAN 9; RJ71CN91 App. 2]. Where the words lie is the
// module's layout, how modules differ are its rules.

#include <cstdint>
#include <optional>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

inline constexpr unsigned layer2_slots = 42;
inline constexpr unsigned layer2_stop_messages = 4;
/// Transmit slots that may answer remote frames.
inline constexpr unsigned layer2_rtr_slots = 28;

/// First word of each area.
struct Layer2Layout {
  BufferAddress error_codes = 0;    ///< one word per slot
  BufferAddress parameters = 0;     ///< four per slot
  BufferAddress rtr_flags = 0;      ///< three words, a bit per slot
  BufferAddress trigger_flags = 0;  ///< likewise
  BufferAddress stop_messages = 0;  ///< seven per message
  BufferAddress process_data = 0;   ///< seven per slot
};

/// What modules do differently.
struct Layer2Rules {
  /// Unit of parameter D of a transmit slot.
  can::Duration cycle_unit = std::chrono::milliseconds(10);
  /// Cycle time of a parameter D that is 0, and stays 0. Left out: it becomes 1 on going online.
  std::optional<can::Duration> cycle_of_zero{};
  /// A data exchange sends slots of the cyclic types (2 and 3), too, of type 3 those that have changed [FX3U-CAN 9.3.1].
  bool exchange_sends_cyclic = false;
  /// A setting that makes no sense keeps the module offline. Otherwise it goes online without that slot.
  bool errors_keep_offline = true;
  /// From the 29th slot that answers remote frames on it is also a setting error.
  bool rtr_limit_is_error = false;
  /// RTR/new/DLC of a transmit slot is written offline only.
  bool frame_word_is_configuration = false;
  /// With 11-bit identifiers the high word of a transmit slot's CAN-ID does not matter.
  bool base_high_word_ignored = false;
  /// Every transmit slot is sent once on going online.
  bool sends_when_online = false;
  /// The words of receive slots are cleared on going online.
  bool clears_receive_words = false;
  /// No two transmit slots may have the same CAN-ID.
  bool unique_transmit_identifiers = false;
  /// Slots that send remote frames cannot have a transmission type that detects changed data (1 and 3).
  bool remote_frames_have_no_changes = false;
  /// The overflow flag means that new data were not fetched; else that a message was not.
  bool overflow_is_of_new_data = false;
  /// The bit rate word is taken over on going online, and bus-off is left then [RJ71CN91 App. 1 Y3, App. 2 G24].
  bool online_applies_bit_rate = false;
  /// A setting that was last written with a value out of range keeps the module offline, although the word has a good one
  /// [RJ71CN91 App. 1 Y3, 5.5].
  bool bad_words_keep_offline = false;
  /// Offline the module is not on the wire: it acknowledges nothing [RJ71CN91 5.4].
  bool offline_is_silent = false;
  /// Of the process data, only the words of transmit slots are saved [RJ71CN91 App. 2 G10000].
  bool saves_transmit_slots = false;
  /// Word of the bit rate, kbit/s, if what slots of cyclic types send together must find room at it [RJ71CN91 App. 2
  /// parameter D]: with every stuff bit, each of them once in its cycle time.
  std::optional<BufferAddress> rate_of_cycles{};
  /// Receive processing: time per message, and messages that may wait for it. A message that finds no place
  /// is lost.
  can::Duration message_time = std::chrono::microseconds(100);
  unsigned waiting_messages = 8;
};

/// Parameter B of a transmit slot: what remote frames with its CAN-ID do.
enum class RtrResponse : std::uint16_t {
  automatic = 0x7FFF,  ///< the slot's message is sent at once
  manual = 0x6FFF,     ///< the slot's RTR flag is set
  none = 0x5FFF,       ///< nothing
};

/// Parameter C of a transmit slot.
enum class Layer2Transmission : std::uint16_t {
  exchange = 0,          ///< by every data exchange
  exchange_changed = 1,  ///< by a data exchange, if the message changed since it was last sent
  cycle = 2,             ///< every cycle time
  cycle_changed = 3,     ///< every cycle time, if the message changed since it was last sent
  request = 4,           ///< by a remote frame or a trigger flag only
};

enum class SlotKind : std::uint8_t { disabled, transmit, receive };

/// Reads and checks the settings in the buffer memory. Slots are numbered from 0.
class Layer2Settings {
 public:
  /// Words of a slot's block.
  static constexpr BufferAddress block_words = 7;

  Layer2Settings(const Layer2Layout& layout, const Layer2Rules& rules, BufferMemory& memory)
      : layout_(layout), rules_(rules), memory_(&memory) {}

  /// 29-bit identifiers, or 11-bit ones.
  void select(bool extended) noexcept { extended_ = extended; }
  [[nodiscard]] bool extended() const noexcept { return extended_; }

  /// Address of parameter A of a slot; B, C and D follow.
  [[nodiscard]] BufferAddress parameters(unsigned slot) const noexcept {
    return layout_.parameters + 4 * slot;
  }
  /// Address of the first of the seven words of a slot.
  [[nodiscard]] BufferAddress block(unsigned slot) const noexcept { return layout_.process_data + 7 * slot; }
  [[nodiscard]] BufferAddress stop_block(unsigned message) const noexcept {
    return layout_.stop_messages + 7 * message;
  }

  [[nodiscard]] SlotKind kind(unsigned slot) const noexcept;
  /// Of a transmit slot.
  [[nodiscard]] RtrResponse response(unsigned slot) const noexcept {
    return static_cast<RtrResponse>(word(parameters(slot) + 1));
  }
  [[nodiscard]] Layer2Transmission transmission(unsigned slot) const noexcept {
    return static_cast<Layer2Transmission>(word(parameters(slot) + 2));
  }
  [[nodiscard]] can::Duration cycle(unsigned slot) const noexcept {
    const std::uint16_t units = word(parameters(slot) + 3);
    return units == 0 && rules_.cycle_of_zero ? *rules_.cycle_of_zero : rules_.cycle_unit * units;
  }
  /// A remote frame counts only if it requests as many bytes as the slot has (bit 12).
  [[nodiscard]] bool strict_dlc(unsigned slot) const noexcept;
  /// The frame that a transmit slot's words describe.
  [[nodiscard]] can::Frame frame(unsigned slot) const noexcept;
  [[nodiscard]] bool stop_message_enabled(unsigned message) const noexcept;
  [[nodiscard]] can::Frame stop_message(unsigned message) const noexcept;
  /// Identifier and mask (1 = any) of a receive slot.
  [[nodiscard]] std::uint32_t identifier(unsigned slot) const noexcept { return pair(parameters(slot)); }
  [[nodiscard]] std::uint32_t mask(unsigned slot) const noexcept { return pair(parameters(slot) + 2); }

  /// What a write of one word is worth by itself, given the others as they are.
  [[nodiscard]] WriteResult check_parameter(BufferAddress address, std::uint16_t value) const noexcept;
  [[nodiscard]] WriteResult check_identifier_word(std::uint16_t value, bool high) const noexcept;
  [[nodiscard]] bool good_frame_word(unsigned slot, std::uint16_t value) const noexcept;

  /// The first word of a slot, or a stop message, that does not go together with the others.
  [[nodiscard]] std::optional<BufferAddress> slot_error(unsigned slot) const noexcept;
  [[nodiscard]] std::optional<BufferAddress> stop_message_error(unsigned message) const noexcept;
  /// Parameter D of the first slot whose cycle time is too short for the bit rate.
  [[nodiscard]] std::optional<BufferAddress> cycle_error() const noexcept;
  /// Of all slots and stop messages.
  [[nodiscard]] std::optional<BufferAddress> first_error() const noexcept;
  /// What going online makes of the settings: parameter B of slots over the limit becomes 5FFFH, a cycle time
  /// of 0 becomes 1 (but for Layer2Rules::cycle_of_zero). Returns the address of the first B that was changed.
  std::optional<BufferAddress> settle() noexcept;

 private:
  [[nodiscard]] std::uint16_t word(BufferAddress address) const noexcept { return memory_->word(address); }
  [[nodiscard]] std::uint32_t pair(BufferAddress low) const noexcept {
    return static_cast<std::uint32_t>(word(low)) | static_cast<std::uint32_t>(word(low + 1)) << 16;
  }
  /// CAN-ID of a slot or stop message in its block.
  [[nodiscard]] std::uint32_t block_identifier(BufferAddress block) const noexcept;
  [[nodiscard]] std::optional<BufferAddress> identifier_error(BufferAddress low,
                                                              std::uint32_t identifier) const noexcept;
  [[nodiscard]] can::Frame frame_at(BufferAddress block, bool remote) const noexcept;

  Layer2Layout layout_;
  Layer2Rules rules_;
  BufferMemory* memory_;
  bool extended_ = false;
};

// RTR/new/DLC.
namespace frame_word {
inline constexpr std::uint16_t dlc = 0x00FF;
inline constexpr std::uint16_t new_data = 1U << 8;
inline constexpr std::uint16_t new_frame = 1U << 9;
inline constexpr std::uint16_t overflow = 1U << 10;
inline constexpr std::uint16_t flags = new_data | new_frame | overflow;
inline constexpr std::uint16_t strict_dlc = 1U << 12;
inline constexpr std::uint16_t remote = 1U << 15;
}  // namespace frame_word

}  // namespace canopus::module
