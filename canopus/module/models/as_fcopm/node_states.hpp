#pragma once
// What the master knows of each node: its code at SR830 on, its flag at SR826 on [AS-FCOPM 10.5.1].
//
// Several causes may be there at once; each comes and goes by itself, and the register shows the gravest. The manual
// prints no order: what keeps the slave out of the network comes first, then what keeps it from being started, then
// its PDOs, then its emergency message.

#include <array>
#include <cstdint>

#include "canopus/module/models/as_fcopm/codes.hpp"

namespace canopus::module::as_fcopm {

class NodeStates {
 public:
  static constexpr unsigned nodes = 64;

  void clear() noexcept { causes_.fill(0); }
  void set(std::uint8_t node_id, NodeCode cause, bool there) noexcept {
    if (node_id < 1 || node_id > nodes) return;
    std::uint16_t& causes = causes_[node_id - 1U];
    const auto bit = static_cast<std::uint16_t>(1U << (static_cast<unsigned>(cause) & 0xFU));
    causes = static_cast<std::uint16_t>(there ? causes | bit : causes & ~bit);
  }
  [[nodiscard]] bool has(std::uint8_t node_id, NodeCode cause) const noexcept {
    return node_id >= 1 && node_id <= nodes &&
           (causes_[node_id - 1U] >> (static_cast<unsigned>(cause) & 0xFU) & 1U) != 0;
  }
  /// SR830 + node_id - 1, node 1..64.
  [[nodiscard]] std::uint16_t code(std::uint8_t node_id) const noexcept {
    for (const NodeCode cause : order)
      if (has(node_id, cause)) return static_cast<std::uint16_t>(cause);
    return 0;
  }
  /// SR826 + `word`, 0..3.
  [[nodiscard]] std::uint16_t flags(unsigned word) const noexcept {
    unsigned flags = 0;
    for (unsigned bit = 0; bit < 16; ++bit)
      if (causes_[16 * word + bit] != 0) flags |= 1U << bit;
    return static_cast<std::uint16_t>(flags);
  }

 private:
  static constexpr std::array order{NodeCode::same_node_id,  NodeCode::not_there,     NodeCode::error_control,
                                    NodeCode::key_parameter, NodeCode::pdo_parameter, NodeCode::auto_sdo,
                                    NodeCode::pdo_length,    NodeCode::pdo_missing,   NodeCode::emergency};
  std::array<std::uint16_t, nodes> causes_{};
};

}  // namespace canopus::module::as_fcopm
