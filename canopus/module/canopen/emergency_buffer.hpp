#pragma once
// Received emergency messages for the PLC: the first ones after power-on or a clear stay in a stack, the
// following ones go through a ring where the newest pushes out the oldest. The PLC sees neither until a
// refresh copies both, oldest first, into the buffer memory: records of five words [ME3CAN1-Q 3.5.17]. Or there are no words,
// and commands show the messages, each with its number [FX2N-32CAN 9.1].

#include <algorithm>
#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

struct EmergencyBufferLayout {
  BufferAddress first = 0;  ///< of the first record
  std::size_t stack = 0;    ///< records
  std::size_t ring = 0;
  bool has_words = true;  ///< else commands alone show the messages
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

  /// A message as commands show it.
  struct Received {
    canopen::Emergency message{};
    std::uint8_t number = 0;  ///< among those since the last clear, 255 at most
    bool was_read = false;    ///< by next_unread()
  };
  /// Oldest first.
  [[nodiscard]] std::span<const Received> stack() const noexcept {
    return std::span(messages_).first(std::min(messages_.size(), layout_.stack));
  }
  [[nodiscard]] std::span<const Received> ring() const noexcept {
    return std::span(messages_).subspan(stack().size());
  }
  /// The oldest that this has not given yet; nullptr: all are read.
  [[nodiscard]] const Received* next_unread() noexcept;
  /// The last message of some node was not that its errors are over.
  [[nodiscard]] bool any_active() const noexcept { return active_.any(); }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time) const override {
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
  std::vector<Received> messages_;  // oldest first: the stack's, then the ring's
  std::vector<std::uint16_t> words_;
  std::bitset<128> active_;  // nodes whose last message was an error
  std::uint8_t number_ = 0;  // of the last one
  bool hold_clear_ = false;
};

}  // namespace canopus::module
