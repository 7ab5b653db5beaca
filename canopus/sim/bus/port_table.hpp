#pragma once
// Two small tables over the ports of a bus: who hears an identifier, and who wins arbitration.

#include <algorithm>
#include <array>
#include <bit>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/can/frame.hpp"

namespace canopus::sim {

/// A set of ports for each base identifier, one for ports that accept them all, and one for all extended identifiers.
class AcceptanceTable {
 public:
  static constexpr std::size_t extended_row = 2048;
  static constexpr std::size_t every_base_row = 2049;
  static constexpr std::uint16_t no_port = 0xFFFF;

  /// A set of ports, 64 to a word.
  class Ports {
   public:
    Ports(const std::uint64_t* of_identifier, const std::uint64_t* of_all) noexcept
        : of_identifier_(of_identifier), of_all_(of_all) {}
    [[nodiscard]] std::uint64_t operator[](std::size_t word) const noexcept {
      return of_identifier_[word] | of_all_[word];
    }

   private:
    const std::uint64_t* of_identifier_;
    const std::uint64_t* of_all_;
  };

  [[nodiscard]] std::size_t words() const noexcept { return words_; }  ///< per set
  [[nodiscard]] Ports ports_for(const can::Frame& frame) const noexcept {
    if (frame.extended) return {row(extended_row), row(extended_row)};
    return {row(frame.identifier & can::max_base_identifier), row(every_base_row)};
  }
  /// The ports that accept a frame where they are at most two, as with nearly all PDOs: the consumer, and the producer
  /// itself, which may be asked for it.
  struct Receivers {
    bool are_known = false;  ///< no: see ports_for()
    std::uint16_t first = no_port;
    std::uint16_t second = no_port;  ///< higher than the first
  };
  [[nodiscard]] Receivers cached_receivers(const can::Frame& frame) noexcept {
    if (frame.extended) return {};
    const std::size_t identifier = frame.identifier & can::max_base_identifier;
    Cache& looked = looked_[identifier];
    if (looked.first == not_cached) {
      looked = look_for_few(identifier);
      has_looked_ = true;
    }
    return {looked.first != many, looked.first, looked.second};
  }
  /// Makes room for `ports` ports; the new ones accept nothing yet.
  void resize(std::size_t ports) {
    const std::size_t words = std::max<std::size_t>((ports + 63) / 64, 1);
    if (words == words_) return;
    std::vector<std::uint64_t> bits(rows * words);
    for (std::size_t number = 0; words_ > 0 && number < rows; ++number) {
      std::copy_n(row(number), words_, &bits[number * words]);
    }
    bits_ = std::move(bits);
    words_ = words;
  }
  /// The port accepts `wanted` instead of `former`. Costs what has changed; all and nothing cost the same.
  void change(std::size_t port, const can::Acceptance& former, const can::Acceptance& wanted) noexcept {
    const auto single = [](const can::Acceptance& acceptance) {
      return acceptance.base.all() ? std::bitset<2048>{} : acceptance.base;
    };
    const std::bitset<2048> now = single(wanted);
    const std::bitset<2048> changed = single(former) ^ now;
    for (std::size_t identifier = changed._Find_first(); identifier < changed.size();
         identifier = changed._Find_next(identifier)) {
      set(port, identifier, now[identifier]);
      looked_[identifier].first = not_cached;
    }
    if (former.base.all() != wanted.base.all() && std::exchange(has_looked_, false))
      std::ranges::fill(looked_, Cache{});
    set(port, every_base_row, wanted.base.all());
    set(port, extended_row, wanted.extended);
  }

 private:
  static constexpr std::size_t rows = 2050;
  static constexpr std::uint16_t not_cached = 0xFFFE;
  static constexpr std::uint16_t many = 0xFFFD;
  struct Cache {
    std::uint16_t first = not_cached;
    std::uint16_t second = no_port;
  };

  [[nodiscard]] const std::uint64_t* row(std::size_t number) const noexcept {
    return &bits_[number * words_];
  }
  void set(std::size_t port, std::size_t number, bool wanted) noexcept {
    std::uint64_t& word = bits_[number * words_ + port / 64];
    const std::uint64_t bit = std::uint64_t{1} << (port % 64);
    word = wanted ? word | bit : word & ~bit;
  }
  [[nodiscard]] Cache look_for_few(std::size_t identifier) const noexcept {
    Cache few{no_port, no_port};
    for (std::size_t word = 0; word < words_; ++word) {
      for (std::uint64_t ports = row(identifier)[word] | row(every_base_row)[word]; ports != 0;
           ports &= ports - 1) {
        const auto port =
            static_cast<std::uint16_t>(64 * word + static_cast<std::size_t>(std::countr_zero(ports)));
        if (few.second != no_port) return {many, no_port};
        (few.first == no_port ? few.first : few.second) = port;
      }
    }
    return few;
  }

  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<Cache> looked_ = std::vector<Cache>(can::max_base_identifier + 1);  // by identifier
  bool has_looked_ = false;  // for some, since all were forgotten
};

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

  /// Room for what nodes of CANopen send. To be called before the first set(): nothing is allocated for a frame.
  void expect_identifiers() { owners_.resize(can::max_base_identifier + 1, no_port); }
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
    if (old_key != none) take_out(port, old_key);
    if (new_key != none) put_in(port, new_key);
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
    return is_it(lowest_identifier()) || is_it(lowest_in_tree_but(port_of(lowest_)));
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
  [[nodiscard]] std::uint64_t lowest_in_tree_but(std::size_t port) const noexcept {
    std::uint64_t lowest = none;
    for (std::size_t node = leaves_ + port; node > 1; node /= 2) lowest = std::min(lowest, tree_[node ^ 1]);
    return lowest;
  }
  void put_in(std::size_t port, std::uint64_t new_key) noexcept {
    const std::size_t identifier = identifier_of(new_key);
    if (!is_base_data(new_key) || owners_[identifier] != no_port) return set_in_tree(port, new_key);
    owners_[identifier] = static_cast<std::uint16_t>(port);
    identifiers_[identifier / 64] |= std::uint64_t{1} << identifier % 64;
    words_ |= std::uint32_t{1} << identifier / 64;
  }
  void take_out(std::size_t port, std::uint64_t old_key) noexcept {
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
  std::vector<std::uint16_t> owners_;  // by identifier: the port whose offer is in the set
  std::vector<std::uint64_t> offers_;  // by port
  std::size_t leaves_ = 1;
  std::vector<std::uint64_t> tree_ = std::vector<std::uint64_t>(2, none);
};

}  // namespace canopus::sim
