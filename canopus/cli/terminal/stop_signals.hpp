#pragma once

#include <csignal>
#include <functional>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

namespace canopus::cli {

/// SIGINT, SIGTERM and SIGHUP, which end a run. A SIGHUP that the program was started to ignore (nohup) stays
/// ignored.
class StopSignals {
 public:
  /// `stop` is called by `io` for the first of them, once.
  StopSignals(boost::asio::io_context& io, std::function<void()> stop)
      : signals_(io, SIGINT, SIGTERM), stop_(std::move(stop)) {
    struct sigaction hang_up {};
    if (::sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler != SIG_IGN) signals_.add(SIGHUP);
    signals_.async_wait([this](const boost::system::error_code& error, int) {
      if (error) return;
      came_ = true;
      if (stop_) stop_();
    });
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  [[nodiscard]] bool came() const noexcept { return came_; }

 private:
  boost::asio::signal_set signals_;
  std::function<void()> stop_;
  bool came_ = false;
};

}  // namespace canopus::cli
