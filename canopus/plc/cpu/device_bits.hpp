#pragma once
// The points of one bit device of a CPU, all OFF at first: a byte each, so that a program reads and writes one of them as it does a variable.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace canopus::plc {

class DeviceBits {
 public:
  static constexpr std::size_t block_points = 16;

  /// Call it once. There are whole blocks.
  void resize(std::size_t points) {
    points_.resize((points + block_points - 1) / block_points * block_points);
  }
  [[nodiscard]] std::size_t size() const noexcept { return points_.size(); }

  /// Below size(), as all numbers here.
  [[nodiscard]] bool operator[](std::size_t number) const noexcept { return points_[number] != 0; }
  void set(std::size_t number, bool on) noexcept { points_[number] = on ? 1 : 0; }
  /// 16 points from 16 * `block` on, the first in bit 0.
  [[nodiscard]] std::uint16_t block(std::size_t block) const noexcept {
    const std::uint8_t* const first = points_.data() + block * block_points;
    unsigned word = 0;
    for (unsigned bit = 0; bit < block_points; ++bit) word |= unsigned{first[bit]} << bit;
    return static_cast<std::uint16_t>(word);
  }
  /// 0 or 1, at a place that stays.
  [[nodiscard]] std::uint8_t& at(std::size_t number) noexcept { return points_[number]; }
  [[nodiscard]] const std::vector<std::uint8_t>& all() const noexcept { return points_; }
  /// The first `count` are OFF again.
  void clear(std::size_t count) noexcept {
    std::fill_n(points_.begin(), std::min(count, points_.size()), std::uint8_t{0});
  }
  void clear() noexcept { clear(points_.size()); }

 private:
  std::vector<std::uint8_t> points_;
};

}  // namespace canopus::plc
