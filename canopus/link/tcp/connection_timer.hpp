#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

namespace canopus::link {

/// A time limit for a client, in real time. One at a time.
class ConnectionTimer {
 public:
  using Clock = std::chrono::steady_clock;

  /// `now` measures the timer's delay; tests replace it.
  explicit ConnectionTimer(boost::asio::io_context& context, Clock::time_point (*now)() = &Clock::now)
      : timer_(context), now_(now) {}

  /// Calls `over` after `timeout`, unless it is set or stopped before. Where this process did not run when the time was
  /// over (a busy machine, a suspended process), the client could not be served: it has the whole time again.
  /// `over` keeps the owner of the timer alive.
  template <typename Over>
  void set(std::chrono::milliseconds timeout, Over over) {
    is_set_ = true;
    wait(timeout, ++turn_, std::move(over));
  }
  void stop() noexcept {
    if (!std::exchange(is_set_, false)) return;
    ++turn_;
    boost::system::error_code ignored;
    timer_.cancel(ignored);
  }
  [[nodiscard]] bool is_set() const noexcept { return is_set_; }

 private:
  template <typename Over>
  void wait(std::chrono::milliseconds timeout, std::uint64_t turn, Over over) {
    timer_.expires_after(timeout);
    timer_.async_wait(
        [this, timeout, turn, over = std::move(over)](const boost::system::error_code& error) mutable {
          // A timer that was set again after it had expired is not meant any more.
          if (error || turn != turn_) return;
          const bool is_late = now_() - timer_.expiry() > std::max(least_delay, timeout / 4);
          if (is_late) return wait(timeout, turn, std::move(over));
          over();
        });
  }

  static constexpr std::chrono::milliseconds least_delay{250};  // less is usual on a machine in use

  boost::asio::steady_timer timer_;
  Clock::time_point (*now_)();
  bool is_set_ = false;
  std::uint64_t turn_ = 0;
};

}  // namespace canopus::link
