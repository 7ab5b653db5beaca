#pragma once
// A queue whose memory grows to the largest size it ever had, and is kept: in steady state nothing is allocated.

#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

namespace canopus::can {

/// First in, first out. References and numbers hold until the next change.
template <typename T>
class Ring {
 public:
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// The oldest one. Not when empty.
  [[nodiscard]] T& front() noexcept { return places_[first_]; }
  [[nodiscard]] const T& front() const noexcept { return places_[first_]; }
  /// 0 is the oldest one; below size().
  [[nodiscard]] T& operator[](std::size_t number) noexcept { return places_[place(number)]; }
  [[nodiscard]] const T& operator[](std::size_t number) const noexcept { return places_[place(number)]; }

  void push_back(T value) {
    make_room();
    places_[place(size_++)] = std::move(value);
  }
  /// It becomes the oldest one.
  void push_front(T value) {
    make_room();
    first_ = (first_ + places_.size() - 1) & (places_.size() - 1);
    places_[first_] = std::move(value);
    ++size_;
  }
  /// Not when empty.
  void pop_front() noexcept { pop_front(1); }
  /// The oldest `count`, which must be there.
  void pop_front(std::size_t count) noexcept {
    if (count == 0) return;
    first_ = place(count);
    size_ -= count;
  }
  /// Takes one out of the middle; those behind it move up.
  void erase(std::size_t number) noexcept {
    for (; number + 1 < size_; ++number) places_[place(number)] = std::move(places_[place(number + 1)]);
    --size_;
  }
  void clear() noexcept { first_ = size_ = 0; }

 private:
  [[nodiscard]] std::size_t place(std::size_t number) const noexcept {
    return (first_ + number) & (places_.size() - 1);
  }
  void make_room() {
    if (size_ < places_.size()) return;
    std::vector<T> larger(std::bit_ceil(size_ + 16));
    for (std::size_t i = 0; i < size_; ++i) larger[i] = std::move((*this)[i]);
    places_.swap(larger);
    first_ = 0;
  }

  std::vector<T> places_;  // a power of two of them, or none
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace canopus::can
