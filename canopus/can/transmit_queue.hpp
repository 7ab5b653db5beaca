#pragma once
// The frames that wait in a controller, and which of them wins arbitration.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "canopus/can/frame.hpp"

namespace canopus::can {

/// The bits that decide arbitration as one number, first bit on the wire highest: the frame with the lower
/// one wins. Equal only for frames that are the same before the control field.
[[nodiscard]] constexpr std::uint32_t arbitration(const Frame& frame) noexcept {
  const std::uint32_t remote = frame.remote ? 1 : 0;
  if (!frame.extended) return (frame.identifier & max_base_identifier) << 21 | remote << 20;
  // identifier 28-18, SRR, IDE, identifier 17-0, RTR
  return ((frame.identifier >> 18) & max_base_identifier) << 21 | 3U << 19 |
         (frame.identifier & 0x3FFFF) << 1 | remote;
}

/// A bounded queue, sorted or not. Two frames lie in it, as many as most controllers ever have, and what a frame needs on
/// its way lies together. Its memory grows with the longest queue there ever was, by doubling, from 8 frames on.
class TransmitQueue {
 public:
  TransmitQueue() noexcept { frames_ = own_.data(); }
  TransmitQueue(const TransmitQueue&) = delete;
  TransmitQueue& operator=(const TransmitQueue&) = delete;

  void configure(bool sorted, std::size_t capacity);
  /// False: full. `reserved` places count as taken: of frames that are under way, one of which may come back.
  bool push(const Frame& frame, std::size_t reserved) {
    if (!empty() || reserved >= capacity_) return push_behind(frame, reserved);
    frames_[0] = frame;  // the usual case
    begin_ = 0;
    end_ = 1;
    return true;
  }
  /// Gives a frame back that was taken by pop(): it is the oldest of its kind again. Its place must be free.
  void push_back_again(const Frame& frame) noexcept;
  /// Takes the oldest one that equals this frame out, if there is one.
  void remove(const Frame& frame) noexcept;
  [[nodiscard]] bool empty() const noexcept { return begin_ == end_; }
  [[nodiscard]] std::size_t size() const noexcept { return end_ - begin_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  /// The frame to offer next. Not when empty.
  [[nodiscard]] const Frame& front() const noexcept { return frames_[begin_]; }
  Frame pop() noexcept {
    const Frame frame = frames_[begin_++];
    if (begin_ == end_) begin_ = end_ = 0;
    return frame;
  }
  void clear() noexcept { begin_ = end_ = 0; }

 private:
  static constexpr std::uint32_t own_room = 2;
  bool push_behind(const Frame& frame, std::size_t reserved);
  void insert(std::size_t position, const Frame& frame) noexcept;
  void make_room();

  Frame* frames_ = nullptr;  // begin_..end_ are waiting, the next one first
  std::uint32_t begin_ = 0;
  std::uint32_t end_ = 0;
  std::uint32_t capacity_ = 1;
  std::uint32_t room_ = own_room;  // at frames_
  std::array<Frame, own_room> own_{};
  std::unique_ptr<Frame[]> more_;
  bool sorted_ = true;
};

}  // namespace canopus::can
