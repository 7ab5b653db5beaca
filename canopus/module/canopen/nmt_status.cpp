#include "canopus/module/canopen/nmt_status.hpp"

namespace canopus::module {

NmtStatus::NmtStatus(const std::optional<NmtStatusLayout>& layout, BufferMemory& memory)
    : layout_(layout.value_or(NmtStatusLayout{})), memory_(&memory) {
  if (layout_.error_control) {
    const unsigned per_word = layout_.error_control_nodes_per_word;
    memory.attach(*layout_.error_control, *layout_.error_control + (last_node - 1U) / per_word, *this);
  }
  if (layout_.state) memory.attach(*layout_.state, *layout_.state + last_node - 1U, *this);
}

void NmtStatus::clear_life_guarding(std::uint8_t node) noexcept {
  for (std::uint8_t n = 1; n <= last_node; ++n) {
    if (node != 0 && node != n) continue;
    guarding_master_[n] &= static_cast<std::uint16_t>(~manager::error_control::errors);
    note(n);
  }
}

void NmtStatus::reset() noexcept {
  status_.fill(0);
  state_.fill(0);
  guarding_master_.fill(0);
  failing_.reset();
}

std::uint16_t NmtStatus::read_word(BufferAddress address, can::Time) const {
  if (layout_.state && address - *layout_.state < last_node) {
    return state_[address - *layout_.state + 1U];
  }
  const BufferAddress word = address - *layout_.error_control;
  if (layout_.error_control_nodes_per_word == 1) return status(static_cast<std::uint8_t>(word + 1U));
  const auto low = static_cast<std::uint8_t>(2 * word + 1U);
  const unsigned high = low == last_node ? 0U : status(static_cast<std::uint8_t>(low + 1U));
  return static_cast<std::uint16_t>(high << 8U | (status(low) & 0xFFU));
}

WriteResult NmtStatus::write_word(BufferAddress address, std::uint16_t value, can::Time) {
  if (!layout_.cleared_by_write || (layout_.state && address - *layout_.state < last_node))
    return WriteResult::ignored;
  const unsigned per_word = layout_.error_control_nodes_per_word;
  for (unsigned i = 0; i < per_word; ++i) {
    const unsigned node = per_word * (address - *layout_.error_control) + i + 1;
    if (node > last_node) break;
    const unsigned failures = status(static_cast<std::uint8_t>(node)) & manager::error_control::errors;
    const unsigned written = per_word == 1 ? value : value >> (8 * i) & 0xFFU;
    if ((failures & ~written) != 0) cleared_.set(node);
  }
  return WriteResult::done;
}

}  // namespace canopus::module
