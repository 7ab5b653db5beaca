#pragma once
// Two small tables over the ports of a bus: who hears an identifier, and who wins arbitration.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "canopus/can/frame.hpp"

namespace canopus::sim {

/// A set of ports for each base identifier, and one for all extended identifiers.
class AcceptanceTable {
 public:
  static constexpr std::size_t extended_row = 2048;

  [[nodiscard]] std::size_t words() const noexcept { return words_; }  ///< per set
  [[nodiscard]] const std::uint64_t* ports_for(const can::Frame& frame) const noexcept {
    const std::size_t row = frame.extended ? extended_row : frame.identifier & can::max_base_identifier;
    return &bits_[row * words_];
  }
  /// Makes room for `ports` ports; the new ones accept nothing yet.
  void resize(std::size_t ports) {
    const std::size_t words = std::max<std::size_t>((ports + 63) / 64, 1);
    if (words == words_) return;
    std::vector<std::uint64_t> bits((extended_row + 1) * words);
    for (std::size_t row = 0; words_ > 0 && row <= extended_row; ++row) {
      std::copy_n(&bits_[row * words_], words_, &bits[row * words]);
    }
    bits_ = std::move(bits);
    words_ = words;
  }
  void set(std::size_t port, std::size_t row, bool wanted) noexcept {
    std::uint64_t& word = bits_[row * words_ + port / 64];
    const std::uint64_t bit = std::uint64_t{1} << (port % 64);
    word = wanted ? word | bit : word & ~bit;
  }

 private:
  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_;
};

/// The lowest of one key per port at any time: a tree of minima, so that a change costs log2(ports).
class Arbiter {
 public:
  static constexpr std::uint64_t none = ~std::uint64_t{0};

  /// Key of a port that offers something with this arbitration value (see arbitration()).
  [[nodiscard]] static constexpr std::uint64_t key(std::uint32_t arbitration_value,
                                                   std::size_t port) noexcept {
    return std::uint64_t{arbitration_value} << 16 | port;
  }
  [[nodiscard]] static constexpr std::size_t port_of(std::uint64_t key) noexcept { return key & 0xFFFF; }
  [[nodiscard]] static constexpr std::uint32_t value_of(std::uint64_t key) noexcept {
    return static_cast<std::uint32_t>(key >> 16);
  }

  void resize(std::size_t ports) {
    const std::size_t leaves = std::bit_ceil(std::max<std::size_t>(ports, 1));
    if (leaves == leaves_) return;
    std::vector<std::uint64_t> tree(2 * leaves, none);
    for (std::size_t port = 0; port < leaves_; ++port) tree[leaves + port] = tree_[leaves_ + port];
    tree_ = std::move(tree);
    leaves_ = leaves;
    for (std::size_t node = leaves; node-- > 1;) tree_[node] = std::min(tree_[2 * node], tree_[2 * node + 1]);
  }
  void set(std::size_t port, std::uint64_t new_key) noexcept {
    std::size_t node = leaves_ + port;
    if (tree_[node] == new_key) return;
    tree_[node] = new_key;
    while (node > 1) {
      const std::uint64_t lower = std::min(tree_[node], tree_[node ^ 1]);
      node /= 2;
      if (tree_[node] == lower) return;
      tree_[node] = lower;
    }
  }
  [[nodiscard]] std::uint64_t lowest() const noexcept { return tree_[1]; }
  /// The lowest of all others.
  [[nodiscard]] std::uint64_t lowest_but(std::size_t port) const noexcept {
    std::uint64_t lowest = none;
    for (std::size_t node = leaves_ + port; node > 1; node /= 2) lowest = std::min(lowest, tree_[node ^ 1]);
    return lowest;
  }

 private:
  std::size_t leaves_ = 1;
  std::vector<std::uint64_t> tree_ = std::vector<std::uint64_t>(2, none);
};

}  // namespace canopus::sim
