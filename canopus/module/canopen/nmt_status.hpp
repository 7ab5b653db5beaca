#pragma once
// What the PLC sees of the other nodes' error control and NMT states [ME3CAN1-Q 3.5.15, 3.5.16; FX3U-CAN 6.24]:
// error control bits and a state for each node 1..127. The bits are those of the NMT master
// (manager/nmt/nmt_master.hpp), the life guarding of this node as a slave comes on top. A module without such words
// still has them.

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <utility>

#include "canopus/manager/boot/master_options.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

struct NmtStatusLayout {
  /// Error control bits of node 1; the other nodes follow.
  std::optional<BufferAddress> error_control{};
  /// 1; or 2: an odd node in the low byte, the next one in the high byte.
  unsigned error_control_nodes_per_word = 1;
  /// NMT state of node 1; one word per node.
  std::optional<BufferAddress> state{};
  /// The node that a clear request means, 0 = all. Without the word all are meant.
  std::optional<BufferAddress> clear_node{};
  /// The own word as a slave's has, besides the missing life guarding, whether it runs and a missed guard time
  /// [RJ71CN91 App. 2 G401].
  bool shows_guarding_master = false;
  /// A failure bit that is written as 0 clears the failures of its node [FX3U-CAN 6.24].
  bool cleared_by_write = false;
  /// Bits of manager::error_control that are failures.
  std::uint16_t failures = manager::error_control::errors;
};

class NmtStatus final : public BufferArea {
 public:
  NmtStatus(const std::optional<NmtStatusLayout>& layout, BufferMemory& memory);

  /// The master's bits of a node (manager::error_control).
  void set_status(std::uint8_t node, std::uint16_t bits) noexcept {
    status_[node] = bits;
    note(node);
  }
  /// What this node, which is a slave, finds of its master's guarding (bits of manager::error_control), shown at `node`,
  /// its own word.
  void set_guarding_master(std::uint8_t node, std::uint16_t set, std::uint16_t clear = 0) noexcept {
    if (!layout_.shows_guarding_master) set &= manager::error_control::life_guarding;
    guarding_master_[node] = static_cast<std::uint16_t>((guarding_master_[node] & ~clear) | set);
    note(node);
  }
  /// State as 1F82H shows it (manager::node_state).
  void set_state(std::uint8_t node, std::uint8_t state) noexcept { state_[node] = state; }
  [[nodiscard]] std::uint16_t status(std::uint8_t node) const noexcept {
    return static_cast<std::uint16_t>(status_[node] | guarding_master_[node]);
  }
  [[nodiscard]] std::uint16_t state(std::uint8_t node) const noexcept { return state_[node]; }
  /// The failure signal: at least one node's failure is not cleared.
  [[nodiscard]] bool any_failure() const noexcept { return failing_.any(); }
  [[nodiscard]] bool fails(std::uint8_t node) const noexcept { return failing_.test(node); }

  /// The node that a clear request means now, 0 = all.
  [[nodiscard]] std::uint8_t node_to_clear() const noexcept {
    return layout_.clear_node ? static_cast<std::uint8_t>(memory_->word(*layout_.clear_node))
                              : std::uint8_t{0};
  }
  /// Forgets the life guarding failures of one node, or of all (0). The master's own bits go with the
  /// master's.
  void clear_life_guarding(std::uint8_t node) noexcept;
  /// While held, failures of the node to clear are cleared as they come.
  void hold_clear(bool held) noexcept { hold_clear_ = held; }
  /// The same for all nodes, whatever the word says.
  void hold_clear_all(bool held) noexcept { hold_clear_all_ = held; }
  [[nodiscard]] bool held_clear(std::uint8_t node) const noexcept {
    return hold_clear_all_ || (hold_clear_ && (node_to_clear() == 0 || node_to_clear() == node));
  }
  /// As from power-on; what is held clear stays so.
  void reset() noexcept;

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) const override;
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;
  /// Nodes whose failures the program has cleared by writing, since the last call.
  [[nodiscard]] std::bitset<128> consume_cleared() noexcept { return std::exchange(cleared_, {}); }

 private:
  static constexpr std::uint8_t last_node = 127;
  void note(std::uint8_t node) noexcept { failing_.set(node, (status(node) & layout_.failures) != 0); }

  NmtStatusLayout layout_;
  BufferMemory* memory_;
  bool hold_clear_ = false;
  bool hold_clear_all_ = false;
  std::array<std::uint16_t, 128> status_{};
  std::array<std::uint16_t, 128> state_{};
  std::array<std::uint16_t, 128> guarding_master_{};
  std::bitset<128> failing_;
  std::bitset<128> cleared_;
};

}  // namespace canopus::module
