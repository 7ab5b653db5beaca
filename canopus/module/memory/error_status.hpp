#pragma once
// What is wrong with a module, and the words that show it: one of bits, some latched until the program clears
// them, some following their cause; and those that hold the address of the first bad write. Which error is
// which bit is the model's layout. A module without such words has errors, too.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

enum class ModuleError : std::uint8_t {
  hardware,
  bus_off,
  flash,           ///< stored settings are damaged, or could not be written
  refused_write,   ///< a write at a forbidden time
  invalid_value,   ///< a write of a value out of range
  queue_overflow,  ///< frames were lost
  node_failure,    ///< error control of some node (NmtStatus::any_failure)
  error_passive,
  message_slot,       ///< messages of a Layer 2 slot were lost
  save_while_online,  ///< save or restore was requested while Layer 2 is online
  access_watchdog,    ///< the program has not used the data words for too long
  baud_rate_change,   ///< the last value written as bit rate is none
  node_address_change,
  slave_emergency,  ///< an assigned slave has sent an emergency message
  power_supply,
  command_overflow,  ///< a queue had no room for what a command, or the module itself, was to send
  emergency,         ///< some node has sent an emergency message, and not yet that its errors are over
};

/// One bit of the error status word.
struct ErrorRow {
  ModuleError error{};
  std::uint8_t bit = 0;
  bool latched = false;  ///< stays after its cause has gone, until it is cleared
  bool signal = false;   ///< makes the error signal
  /// Not shown while the clear request is held; afterwards it comes again if its cause is still there
  /// [RJ71CN91 App. 1 YF].
  bool masked = false;
};

/// A word with an error of its own for values out of range; the next good value ends it [FX3U-CAN 14.2].
struct WordErrorRow {
  BufferAddress word = 0;
  ModuleError error{};
  bool is_invalid_value = false;  ///< it is ModuleError::invalid_value besides
  Modes modes =
      every_mode;  ///< of these function modes; in others a bad value is ModuleError::invalid_value alone
};

struct ErrorStatusLayout {
  BufferAddress status = 0;                         ///< the word of bits
  std::optional<BufferAddress> invalid_address{};   ///< first address an invalid value was written to
  std::optional<BufferAddress> refused_address{};   ///< first address whose write was refused
  std::span<const ErrorRow> errors{};               ///< each error once at most
  std::optional<std::uint8_t> general_error_bit{};  ///< ON while any error of the signal is there
  /// The cause of an invalid value is the word it was written to, until a good value is written there: then the error
  /// goes, and as long as it is there the error comes again after a clear request [RJ71CN91 App. 1 YF, 5.3].
  bool bad_words_are_causes = false;
  /// Clearing errors clears the failures of error control, too [RJ71CN91 App. 1 YF].
  bool clears_node_failures = false;
  std::span<const WordErrorRow> word_errors{};
  /// While Layer 2 is online invalid_value cannot be cleared [FX3U-CAN 14.2].
  bool keeps_invalid_value_online = false;
  /// queue_overflow goes by itself when no frame was lost for so long and the transmit queue has room [RJ71CN91 App. 1 XF].
  std::optional<can::Duration> overflow_lasts{};
};

/// Words that make sense together, or do not: what they are is found when they are to be used.
enum class WordGroup : std::uint8_t { clock, layer2 };

class ErrorStatus final : public BufferArea {
 public:
  ErrorStatus(const std::optional<ErrorStatusLayout>& layout, BufferMemory& memory);

  [[nodiscard]] bool has(ModuleError error) const noexcept { return (errors_ & mask(error)) != 0; }
  /// The program sees it now.
  [[nodiscard]] bool shows(ModuleError error) const noexcept { return (shown() & mask(error)) != 0; }
  [[nodiscard]] BufferAddress invalid_address() const noexcept { return invalid_address_; }
  /// The word of bits, as the program sees it.
  [[nodiscard]] std::uint16_t word() const noexcept { return word_; }
  /// The error signal.
  [[nodiscard]] bool any() const noexcept { return (shown() & signal_) != 0; }

  /// A latched error happened. False when it was there already or is cleared at once.
  bool raise(ModuleError error) noexcept {
    if (has(error) || (hold_clear_ && (latched_ & mask(error)) != 0)) return false;
    set(errors_ | mask(error));
    return true;
  }
  /// An error that follows its cause. True when it changed.
  bool follow(ModuleError error, bool on) noexcept {
    if (has(error) == on) return false;
    set(errors_ ^ mask(error));
    return true;
  }
  /// As the model's row says: latched, it is raised while its cause is there; else it follows its cause. True: it is new.
  bool track(ModuleError error, bool on) noexcept {
    if ((latched_ & mask(error)) == 0) return follow(error, on) && on;
    return on && raise(error);
  }
  /// Records what became of a PLC write.
  void record(WriteResult result, BufferAddress address) {
    if (result != WriteResult::done || !bad_words_.empty() || any_word_error_) note_write(result, address);
  }
  /// These words make no sense, from this one on: an invalid value.
  void found_wrong(WordGroup group, BufferAddress address);
  /// found_wrong() was the last report on these words.
  [[nodiscard]] bool is_wrong(WordGroup group) const noexcept { return wrong_[index(group)].has_value(); }
  /// They make sense.
  void found_good(WordGroup group);
  /// Where values out of range were written to that no good value has followed; empty without
  /// ErrorStatusLayout::bad_words_are_causes.
  [[nodiscard]] std::span<const BufferAddress> bad_words() const noexcept { return bad_words_; }

  /// Latched errors go, and the addresses with them.
  void clear() noexcept { clear(latched_); }
  /// While held, latched errors and bad writes are not even recorded.
  void hold_clear(bool held);
  /// As from power-on.
  void reset() noexcept {
    set(0);
    invalid_address_ = refused_address_ = 0;
    bad_words_.clear();
    wrong_ = {};
    any_word_error_ = false;
  }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) const override;
  /// A 0 in a latched bit clears it.
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

 private:
  using Errors = std::uint32_t;  // a bit each, by ModuleError
  [[nodiscard]] static constexpr Errors mask(ModuleError error) noexcept {
    return static_cast<Errors>(1U << static_cast<unsigned>(error));
  }
  void set(Errors errors) noexcept;
  [[nodiscard]] Errors shown() const noexcept {
    return static_cast<Errors>(hold_clear_ ? errors_ & ~masked_ : errors_);
  }
  void clear(Errors errors) noexcept;
  /// False: nothing else is to be noted of the write.
  bool note_word_error(WriteResult result, BufferAddress address);
  void note_write(WriteResult result, BufferAddress address);
  void note(ModuleError error, BufferAddress& first, BufferAddress address) noexcept {
    if (raise(error)) first = address;
  }
  [[nodiscard]] static constexpr std::size_t index(WordGroup group) noexcept {
    return static_cast<std::size_t>(group);
  }
  /// The first of the words that cause an invalid value; nothing: there is no cause any more.
  [[nodiscard]] std::optional<BufferAddress> first_cause() const noexcept;
  void cause_removed();

  std::optional<ErrorStatusLayout> layout_;
  const BufferMemory* memory_;
  Errors latched_ = 0;
  Errors signal_ = 0;
  Errors masked_ = 0;
  Errors errors_ = 0;
  std::uint16_t word_ = 0;  // errors_ as the program sees them
  bool hold_clear_ = false;
  bool any_word_error_ = false;
  BufferAddress invalid_address_ = 0;
  BufferAddress refused_address_ = 0;
  std::vector<BufferAddress> bad_words_;                 // in the order of their writes
  std::array<std::optional<BufferAddress>, 2> wrong_{};  // by WordGroup
};

}  // namespace canopus::module
