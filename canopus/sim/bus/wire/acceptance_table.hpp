#pragma once
// Which ports of a bus accept an identifier.

#include <algorithm>
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
    Cache& cached = cache_[identifier];
    if (cached.first == not_cached) {
      cached = find_receivers(identifier);
      has_cached_ = true;
    }
    return {cached.first != many, cached.first, cached.second};
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
      cache_[identifier].first = not_cached;
    }
    if (former.base.all() != wanted.base.all() && std::exchange(has_cached_, false))
      std::ranges::fill(cache_, Cache{});
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
  [[nodiscard]] Cache find_receivers(std::size_t identifier) const noexcept {
    Cache found{no_port, no_port};
    for (std::size_t word = 0; word < words_; ++word) {
      for (std::uint64_t ports = row(identifier)[word] | row(every_base_row)[word]; ports != 0;
           ports &= ports - 1) {
        const auto port =
            static_cast<std::uint16_t>(64 * word + static_cast<std::size_t>(std::countr_zero(ports)));
        if (found.second != no_port) return {many, no_port};
        (found.first == no_port ? found.first : found.second) = port;
      }
    }
    return found;
  }

  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<Cache> cache_ = std::vector<Cache>(can::max_base_identifier + 1);  // by identifier
  bool has_cached_ = false;  // for some, since all were forgotten
};

}  // namespace canopus::sim
