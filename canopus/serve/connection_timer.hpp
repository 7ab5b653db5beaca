#pragma once

#include <chrono>
#include <cstdint>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

namespace canopus::serve {

/// How long a client may take for something, in real time. One at a time.
class ConnectionTimer {
 public:
  explicit ConnectionTimer(boost::asio::io_context& context) : timer_(context) {}

  /// Calls `over` after `timeout`, unless it is set or stopped before. `over` keeps the owner of the timer alive.
  template <typename Over>
  void set(std::chrono::milliseconds timeout, Over over) {
    is_set_ = true;
    const std::uint64_t turn = ++turn_;
    timer_.expires_after(timeout);
    timer_.async_wait([this, turn, over = std::move(over)](const boost::system::error_code& error) {
      // A timer that was set again after it had expired is not meant any more.
      if (!error && turn == turn_) over();
    });
  }
  void stop() noexcept {
    if (!std::exchange(is_set_, false)) return;
    ++turn_;
    boost::system::error_code ignored;
    timer_.cancel(ignored);
  }
  [[nodiscard]] bool is_set() const noexcept { return is_set_; }

 private:
  boost::asio::steady_timer timer_;
  bool is_set_ = false;
  std::uint64_t turn_ = 0;
};

}  // namespace canopus::serve
