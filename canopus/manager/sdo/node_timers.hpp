#pragma once
// One timer for each of 128 numbers (node-IDs; 0 for the master itself), kept as a tournament: setting one
// costs seven comparisons, the earliest is always at hand.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "canopus/can/alarm.hpp"
#include "canopus/can/time.hpp"

namespace canopus::manager {

class NodeTimers {
 public:
  static constexpr std::size_t count = 128;

  NodeTimers() noexcept { tree_.fill(can::never); }

  void set(std::uint8_t number, can::Time time) noexcept {
    std::size_t place = count + number;
    tree_[place] = time;
    while (place > 1) {
      place /= 2;
      tree_[place] = std::min(tree_[2 * place], tree_[2 * place + 1]);
    }
    alarm_ = tree_[1];
  }
  /// At earliest().
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }
  [[nodiscard]] can::Time earliest() const noexcept { return tree_[1]; }
  /// The number (the lowest one) whose timer is earliest().
  [[nodiscard]] std::uint8_t first() const noexcept {
    std::size_t place = 1;
    while (place < count) place = tree_[2 * place] == tree_[place] ? 2 * place : 2 * place + 1;
    return static_cast<std::uint8_t>(place - count);
  }

 private:
  std::array<can::Time, 2 * count> tree_;
  can::Alarm alarm_;
};

}  // namespace canopus::manager
