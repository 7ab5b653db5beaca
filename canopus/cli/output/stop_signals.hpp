#pragma once

#include <csignal>
#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

namespace canopus::cli {

/// Whether SIGHUP is one of the signals that end something; else it ends the process, as without this.
enum class HangUp : std::uint8_t { is_seen, left_alone };

/// SIGINT, SIGTERM and SIGHUP, which end a run. A SIGHUP that the program was started to ignore (nohup) stays
/// ignored.
class StopSignals {
 public:
  /// `stop` is called by `io` for the first of them, once.
  StopSignals(boost::asio::io_context& io, std::function<void()> stop, HangUp hang_ups = HangUp::is_seen)
      : signals_(io, SIGINT, SIGTERM), stop_(std::move(stop)) {
    struct sigaction hang_up {};
    const bool is_ignored = ::sigaction(SIGHUP, nullptr, &hang_up) != 0 || hang_up.sa_handler == SIG_IGN;
    if (hang_ups == HangUp::is_seen && !is_ignored) signals_.add(SIGHUP);
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

/// The same for a caller outside of any io_context: asked now and then, by any thread.
class StopWatch {
 public:
  explicit StopWatch(HangUp hang_ups) : signals_(io_, {}, hang_ups) {}
  [[nodiscard]] bool came() {
    const std::scoped_lock lock(mutex_);
    io_.poll();
    return signals_.came();
  }

 private:
  std::mutex mutex_;
  boost::asio::io_context io_;
  StopSignals signals_;
};

}  // namespace canopus::cli
