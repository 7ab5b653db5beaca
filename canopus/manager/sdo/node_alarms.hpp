#pragma once
// An alarm for each of 128 numbers: node-IDs, and 0 for what concerns no node alone. They stand in groups: one that changes is
// compared with some twenty others, not with all.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "canopus/can/alarm.hpp"

namespace canopus::manager {

class NodeAlarms {
 public:
  static constexpr std::size_t count = 128;

  NodeAlarms() noexcept {
    for (std::size_t number = 0; number < count; ++number)
      groups_[number / group_size].add_part(alarms_[number]);
    for (can::Alarm& group : groups_) all_.add_part(group);
  }

  [[nodiscard]] can::Alarm& operator[](std::uint8_t number) noexcept { return alarms_[number]; }
  /// Of all of them.
  [[nodiscard]] can::Alarm& alarm() noexcept { return all_; }
  /// The lowest number whose alarm comes first.
  [[nodiscard]] std::uint8_t first() const noexcept {
    const std::size_t group = first_of(groups_);
    return static_cast<std::uint8_t>(group * group_size +
                                     first_of(std::span(alarms_).subspan(group * group_size, group_size)));
  }

 private:
  static constexpr std::size_t group_size = 8;
  [[nodiscard]] static std::size_t first_of(std::span<const can::Alarm> alarms) noexcept {
    return static_cast<std::size_t>(std::ranges::min_element(alarms, {}, &can::Alarm::deadline) -
                                    alarms.begin());
  }

  std::array<can::Alarm, count> alarms_;
  std::array<can::Alarm, count / group_size> groups_;
  can::Alarm all_;
};

}  // namespace canopus::manager
