#pragma once
// Which port wins arbitration.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "canopus/can/frame.hpp"

namespace canopus::sim {

/// The lowest of one key per port at any time. Data frames with base identifiers, nearly all there are on a CANopen bus, are
/// bits in a set of identifiers: coming and going costs a few instructions. Whatever else is offered, and a second frame of one
/// identifier, lies in a tree of minima, where a change costs log2(ports).
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
    offers_.resize(ports, none);
    const std::size_t leaves = std::bit_ceil(std::max<std::size_t>(ports, 1));
    if (leaves == leaves_) return;
    std::vector<std::uint64_t> tree(2 * leaves, none);
    for (std::size_t port = 0; port < leaves_; ++port) tree[leaves + port] = tree_[leaves_ + port];
    tree_ = std::move(tree);
    leaves_ = leaves;
    for (std::size_t node = leaves; node-- > 1;) tree_[node] = std::min(tree_[2 * node], tree_[2 * node + 1]);
  }
  [[gnu::always_inline]] void set(std::size_t port, std::uint64_t new_key) noexcept {
    std::uint64_t& offer = offers_[port];
    if (offer == new_key) return;
    const std::uint64_t old_key = std::exchange(offer, new_key);
    if (old_key != none) remove(port, old_key);
    if (new_key != none) insert(port, new_key);
    const std::uint64_t lower = std::min(lowest_, new_key);
    lowest_ = lower == old_key ? std::min(lowest_identifier(), tree_[1]) : lower;  // the lowest one goes
  }
  [[nodiscard]] std::uint64_t of(std::size_t port) const noexcept { return offers_[port]; }
  [[nodiscard]] std::uint64_t lowest() const noexcept { return lowest_; }
  /// Whether another port offers what arbitration cannot tell from the lowest one's.
  [[nodiscard]] bool is_lowest_shared() const noexcept {
    if (tree_[1] == none) return false;  // each identifier is in the set once
    const auto is_it = [&](std::uint64_t other) {
      return other != lowest_ && other != none && value_of(other) == value_of(lowest_);
    };
    return is_it(lowest_identifier()) || is_it(lowest_in_tree_without(port_of(lowest_)));
  }

 private:
  static constexpr std::uint16_t no_port = 0xFFFF;
  static constexpr unsigned behind_identifier = 21;  // bits of the arbitration value, 0 in a base data frame
  [[nodiscard]] static constexpr bool is_base_data(std::uint64_t key) noexcept {
    return (value_of(key) & ((1U << behind_identifier) - 1)) == 0;
  }
  [[nodiscard]] static constexpr std::size_t identifier_of(std::uint64_t key) noexcept {
    return value_of(key) >> behind_identifier;
  }
  [[nodiscard]] std::uint64_t lowest_identifier() const noexcept {
    if (words_ == 0) return none;
    const auto word = static_cast<std::size_t>(std::countr_zero(words_));
    const std::size_t identifier = 64 * word + static_cast<std::size_t>(std::countr_zero(identifiers_[word]));
    return key(static_cast<std::uint32_t>(identifier) << behind_identifier, owners_[identifier]);
  }
  [[nodiscard]] std::uint64_t lowest_in_tree_without(std::size_t port) const noexcept {
    std::uint64_t lowest = none;
    for (std::size_t node = leaves_ + port; node > 1; node /= 2) lowest = std::min(lowest, tree_[node ^ 1]);
    return lowest;
  }
  void insert(std::size_t port, std::uint64_t new_key) noexcept {
    const std::size_t identifier = identifier_of(new_key);
    if (!is_base_data(new_key) || owners_[identifier] != no_port) return set_in_tree(port, new_key);
    owners_[identifier] = static_cast<std::uint16_t>(port);
    identifiers_[identifier / 64] |= std::uint64_t{1} << identifier % 64;
    words_ |= std::uint32_t{1} << identifier / 64;
  }
  void remove(std::size_t port, std::uint64_t old_key) noexcept {
    const std::size_t identifier = identifier_of(old_key);
    if (!is_base_data(old_key) || owners_[identifier] != port) return set_in_tree(port, none);
    owners_[identifier] = no_port;
    std::uint64_t& word = identifiers_[identifier / 64];
    word &= ~(std::uint64_t{1} << identifier % 64);
    if (word == 0) words_ &= ~(std::uint32_t{1} << identifier / 64);
  }
  [[gnu::noinline]] void set_in_tree(std::size_t port, std::uint64_t new_key) noexcept {
    std::size_t node = leaves_ + port;
    tree_[node] = new_key;
    while (node > 1) {
      const std::uint64_t lower = std::min(tree_[node], tree_[node ^ 1]);
      node /= 2;
      if (tree_[node] == lower) return;
      tree_[node] = lower;
    }
  }

  std::uint64_t lowest_ = none;
  std::uint32_t words_ = 0;  // of identifiers_ that are not 0
  std::array<std::uint64_t, 32> identifiers_{};
  // By identifier: the port whose offer is in the set. Allocated with the arbiter: nothing is allocated for a frame.
  std::vector<std::uint16_t> owners_ = std::vector<std::uint16_t>(can::max_base_identifier + 1, no_port);
  std::vector<std::uint64_t> offers_;  // by port
  std::size_t leaves_ = 1;
  std::vector<std::uint64_t> tree_ = std::vector<std::uint64_t>(2, none);
};

}  // namespace canopus::sim
