#pragma once

#include <chrono>
#include <cstddef>

namespace canopus::cli {

/// Whether a plant in virtual time waits for the clients of its buses to read. It runs a thousand times
/// faster than they can, and they would lose frames. A client that reads nothing for `patience` loses frames
/// as in real time.
class ClientBackpressure {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t enough_waiting = 512;  ///< messages; a quarter of what a client's queue holds
  static constexpr Clock::duration patience = std::chrono::seconds(2);

  /// `waiting`: messages that wait for the slowest client.
  [[nodiscard]] bool are_behind(std::size_t waiting, Clock::time_point now) noexcept {
    if (waiting < waiting_ || waiting < enough_waiting) progress_at_ = now;
    waiting_ = waiting;
    return waiting >= enough_waiting && now - progress_at_ < patience;
  }

 private:
  std::size_t waiting_ = 0;
  Clock::time_point progress_at_{};
};

}  // namespace canopus::cli
