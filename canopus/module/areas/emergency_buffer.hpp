#pragma once
// Received emergency messages for the PLC: the first ones after power-on or a clear stay in a stack, the
// following ones go through a ring where the newest pushes out the oldest. The PLC sees neither until a
// refresh copies both, oldest first, into the buffer memory: records of five words [ME3CAN1-Q 3.5.17].

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/module/areas/buffer_memory.hpp"

namespace canopus::module {

struct EmergencyBufferLayout {
  BufferAddress first = 0;  ///< of the first record
  std::size_t stack = 0;    ///< records
  std::size_t ring = 0;
};

class EmergencyBuffer final : public BufferArea {
 public:
  static constexpr BufferAddress words_per_record = 5;

  /// Without a layout nothing is kept.
  EmergencyBuffer(const std::optional<EmergencyBufferLayout>& layout, BufferMemory& memory);

  [[nodiscard]] bool empty() const noexcept { return messages_.empty(); }

  [[nodiscard]] bool held_clear() const noexcept { return hold_clear_; }
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
    return words_[address - layout_.first];
  }
  /// 0 to the first word clears the whole buffer; other writes have no effect.
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time) override {
    if (address != layout_.first || value != 0) return WriteResult::ignored;
    clear();
    return WriteResult::done;
  }

 private:
  EmergencyBufferLayout layout_;
  std::vector<canopen::Emergency> messages_;  // oldest first: the stack's, then the ring's
  std::vector<std::uint16_t> words_;
  bool hold_clear_ = false;
};

}  // namespace canopus::module
