#pragma once
// Error status: one word of bits, some latched until the PLC clears them, some following their cause; and the
// words that hold the address of the first bad write. Which bit means what is the module's layout.

#include <cstdint>
#include <string_view>

#include "canopus/module/buffer_memory.hpp"

namespace canopus::module {

struct ErrorStatusLayout {
  BufferAddress status = 0;           ///< the word of bits
  BufferAddress setting_address = 0;  ///< shows the first address an invalid value was written to
  BufferAddress refused_address = 0;  ///< shows the first address whose write was refused
  std::uint16_t latched = 0;          ///< bits that stay after their cause has gone
  std::uint16_t sum = 0;              ///< bits that make the error signal
  std::uint8_t setting_bit = 0;       ///< invalid value
  std::uint8_t refused_bit = 0;       ///< write at a forbidden time
};

class ErrorStatus final : public BufferArea {
 public:
  explicit ErrorStatus(const ErrorStatusLayout& layout) : layout_(layout) {}

  [[nodiscard]] std::uint16_t bits() const noexcept { return bits_; }
  [[nodiscard]] bool bit(unsigned number) const noexcept { return (bits_ >> number & 1U) != 0; }
  /// The error signal.
  [[nodiscard]] bool any() const noexcept { return (bits_ & layout_.sum) != 0; }

  /// A latched error happened. False when it was there already or is cleared at once.
  bool raise(unsigned number) noexcept {
    if (bit(number) || (hold_clear_ && latched(number))) return false;
    bits_ = static_cast<std::uint16_t>(bits_ | 1U << number);
    return true;
  }
  /// An error that follows its cause. True when the bit changed.
  bool follow(unsigned number, bool on) noexcept {
    if (bit(number) == on) return false;
    bits_ = static_cast<std::uint16_t>(bits_ ^ 1U << number);
    return true;
  }
  /// Records what became of a PLC write.
  void record(WriteResult result, BufferAddress address) noexcept {
    if (hold_clear_) return;
    if (result == WriteResult::invalid) note(layout_.setting_bit, setting_address_, address);
    if (result == WriteResult::refused) note(layout_.refused_bit, refused_address_, address);
  }

  /// Latched bits go, and the addresses with them.
  void clear() noexcept { clear(layout_.latched); }
  /// While held, latched errors do not come up at all (the clear request signal is ON).
  void hold_clear(bool held) noexcept {
    hold_clear_ = held;
    if (held) clear();
  }
  /// As from power-on.
  void reset() noexcept {
    bits_ = 0;
    setting_address_ = refused_address_ = 0;
  }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time) override {
    if (address == layout_.setting_address) return static_cast<std::uint16_t>(setting_address_);
    if (address == layout_.refused_address) return static_cast<std::uint16_t>(refused_address_);
    return bits_;
  }
  /// A 0 in a latched bit clears it.
  WriteResult write_word(BufferAddress, std::uint16_t value, can::Time) override {
    clear(static_cast<std::uint16_t>(layout_.latched & ~value));
    return WriteResult::done;
  }

 private:
  [[nodiscard]] bool latched(unsigned number) const noexcept { return (layout_.latched >> number & 1U) != 0; }
  void note(unsigned number, BufferAddress& first, BufferAddress address) noexcept {
    if (raise(number)) first = address;
  }
  void clear(std::uint16_t mask) noexcept {
    bits_ = static_cast<std::uint16_t>(bits_ & ~mask);
    if (!bit(layout_.setting_bit)) setting_address_ = 0;
    if (!bit(layout_.refused_bit)) refused_address_ = 0;
  }

  ErrorStatusLayout layout_;
  std::uint16_t bits_ = 0;
  bool hold_clear_ = false;
  BufferAddress setting_address_ = 0;
  BufferAddress refused_address_ = 0;
};

}  // namespace canopus::module
