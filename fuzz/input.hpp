#pragma once
// The bytes of a fuzz input, taken one after another as the decisions of a run. At the end everything is 0.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <source_location>
#include <span>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::fuzz {

/// What must hold whatever the input is.
inline void expect(bool held, std::source_location place = std::source_location::current()) {
  if (held) return;
  std::fprintf(stderr, "%s:%u: this must hold\n", place.file_name(), static_cast<unsigned>(place.line()));
  std::abort();
}

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  [[nodiscard]] bool empty() const noexcept { return rest_.empty(); }
  std::uint8_t byte() noexcept {
    if (rest_.empty()) return 0;
    const std::uint8_t value = rest_.front();
    rest_ = rest_.subspan(1);
    return value;
  }
  bool flag() noexcept { return (byte() & 1U) != 0; }
  /// 0..below-1; below 1..256.
  unsigned choice(unsigned below) noexcept { return byte() % below; }
  template <typename T, std::size_t size>
  const T& one_of(const T (&values)[size]) noexcept {
    static_assert(size <= 256);
    return values[byte() % size];
  }
  std::uint64_t number(unsigned bytes) noexcept {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < bytes; ++i) value |= std::uint64_t{byte()} << (8 * i);
    return value;
  }
  /// Up to `most` bytes, as far as there are any.
  std::span<const std::uint8_t> bytes(std::size_t most) noexcept {
    const auto taken = rest_.first(std::min(most, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  /// A frame with this identifier: mostly of 8 bytes, now and then of another length or a remote frame.
  can::Frame frame(std::uint32_t identifier, bool extended = false) {
    can::Frame frame{.identifier = identifier, .extended = extended};
    const std::uint8_t shape = byte();
    frame.remote = shape >= 0xF0;
    frame.dlc = shape < 0xC0 ? std::uint8_t{8} : static_cast<std::uint8_t>(shape & 0x0F);
    std::ranges::copy(bytes(frame.length()), frame.data.begin());
    return frame;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// What a protocol object may hand to a controller.
inline void expect_well_formed(const can::Frame& frame) {
  expect(frame.identifier <= (frame.extended ? can::max_extended_identifier : can::max_base_identifier));
  expect(frame.dlc <= 8);
  for (std::size_t i = frame.length(); i < frame.data.size(); ++i) expect(frame.data[i] == 0);
}

/// Brings `participant` to `end` as a bus would: every deadline in time, but not more than `most` of them (a
/// machine may be late). A deadline that ticks cannot move would be an endless loop.
template <typename Participant>
void pass_time(Participant& participant, can::Time& now, can::Time end, unsigned most = 64) {
  unsigned at_one_moment = 0;
  for (unsigned ticks = 0; ticks < most && participant.deadline() <= end; ++ticks) {
    at_one_moment = participant.deadline() > now ? 0 : at_one_moment + 1;
    expect(at_one_moment <= 32);
    now = std::max(now, participant.deadline());
    participant.tick(now);
  }
  now = std::max(now, end);
  for (unsigned ticks = 0; participant.deadline() <= now; ++ticks) {
    expect(ticks <= 32);
    participant.tick(now);
  }
}

}  // namespace canopus::fuzz
