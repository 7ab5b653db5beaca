#pragma once
// Received emergency messages for the PLC: the first ones after power-on or a clear stay in a stack, the
// following ones go through a ring where the newest pushes out the oldest. The PLC sees neither until a
// refresh copies both, oldest first, into the buffer memory: records of five words [ME3CAN1-Q 3.5.17].

#include <array>
#include <cstdint>
#include <vector>

#include "canopus/canopen/node.hpp"
#include "canopus/module/buffer_memory.hpp"

namespace canopus::module {

class EmergencyBuffer final : public BufferArea {
 public:
  static constexpr BufferAddress words_per_record = 5;

  /// `first` is the address of the first record; `stack` and `ring` count records.
  EmergencyBuffer(BufferAddress first, std::size_t stack, std::size_t ring)
      : first_(first), stack_(stack), ring_(ring), words_((stack + ring) * words_per_record) {}

  [[nodiscard]] BufferAddress last_address() const noexcept {
    return first_ + static_cast<BufferAddress>(words_.size()) - 1;
  }
  [[nodiscard]] bool empty() const noexcept { return messages_.empty(); }

  /// A message came in. While clearing is held it is dropped.
  void record(const canopen::Emergency& message);
  /// Makes the words show what was received.
  void refresh();
  /// Forgets everything, the words too.
  void clear();
  /// While held, nothing is stored (the clear request signal is ON).
  void hold_clear(bool held) {
    hold_clear_ = held;
    if (held) clear();
  }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time) override {
    return words_[address - first_];
  }
  /// 0 to the first word clears the whole buffer; other writes have no effect.
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time) override {
    if (address != first_ || value != 0) return WriteResult::ignored;
    clear();
    return WriteResult::done;
  }

 private:
  BufferAddress first_;
  std::size_t stack_;
  std::size_t ring_;
  std::vector<canopen::Emergency> messages_;  // oldest first: the stack's, then the ring's
  std::vector<std::uint16_t> words_;
  bool hold_clear_ = false;
};

}  // namespace canopus::module
