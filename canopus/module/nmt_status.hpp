#pragma once
// What the PLC sees of the other nodes' error control and NMT states: one status word and one state word per
// node 1..127 [ME3CAN1-Q 3.5.15, 3.5.16]. The words are those of the NMT master (manager/nmt_master.hpp), the
// life guarding of this node as a slave comes on top.

#include <array>
#include <bitset>
#include <cstdint>

#include "canopus/manager/master_options.hpp"
#include "canopus/module/buffer_memory.hpp"

namespace canopus::module {

class NmtStatus final : public BufferArea {
 public:
  /// Word 0 of each list would be node 0: node n is at status_base + n and state_base + n.
  NmtStatus(BufferAddress status_base, BufferAddress state_base)
      : status_base_(status_base), state_base_(state_base) {}

  /// The master's bits of a node (manager::error_control).
  void set_status(std::uint8_t node, std::uint16_t bits) noexcept {
    status_[node] = bits;
    note(node);
  }
  /// The master of this node, which is a slave, was not heard in time; shown at the word of `node`.
  void set_life_guarding(std::uint8_t node) noexcept {
    life_guarding_.set(node);
    note(node);
  }
  /// State as 1F82H shows it (manager::node_state).
  void set_state(std::uint8_t node, std::uint8_t state) noexcept { state_[node] = state; }
  [[nodiscard]] std::uint16_t status(std::uint8_t node) const noexcept {
    return static_cast<std::uint16_t>(
        status_[node] | (life_guarding_.test(node) ? manager::error_control::life_guarding : 0U));
  }
  [[nodiscard]] std::uint16_t state(std::uint8_t node) const noexcept { return state_[node]; }
  /// The failure signal: at least one node's failure is not cleared.
  [[nodiscard]] bool any_failure() const noexcept { return failing_.any(); }
  /// Forgets the life guarding failure of one node, or of all (0). The master's own bits go with the
  /// master's.
  void clear_life_guarding(std::uint8_t node) noexcept {
    for (std::uint8_t n = 1; n <= 127; ++n) {
      if (node != 0 && node != n) continue;
      life_guarding_.reset(n);
      note(n);
    }
  }
  /// As from power-on.
  void reset() noexcept {
    status_.fill(0);
    state_.fill(0);
    life_guarding_.reset();
    failing_.reset();
  }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time) override {
    if (address - status_base_ <= 127) return status(static_cast<std::uint8_t>(address - status_base_));
    return state_[address - state_base_];
  }
  WriteResult write_word(BufferAddress, std::uint16_t, can::Time) override { return WriteResult::ignored; }

 private:
  void note(std::uint8_t node) noexcept {
    failing_.set(node, (status(node) & manager::error_control::errors) != 0);
  }

  BufferAddress status_base_;
  BufferAddress state_base_;
  std::array<std::uint16_t, 128> status_{};
  std::array<std::uint16_t, 128> state_{};
  std::bitset<128> life_guarding_;
  std::bitset<128> failing_;
};

}  // namespace canopus::module
