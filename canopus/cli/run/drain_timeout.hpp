#pragma once

#include <algorithm>
#include <chrono>

#include <boost/asio/io_context.hpp>

#include "canopus/cli/output/stop_signals.hpp"

namespace canopus::cli {

/// How long the end of a run waits for the reader of its output. Another signal ends the waiting.
class DrainTimeout {
 public:
  /// `limited`: no longer than a second for a reader that takes nothing.
  explicit DrainTimeout(bool limited) : limited_(limited) {}
  bool operator()(std::chrono::steady_clock::duration since_reader_took_something) {
    io_.poll();
    if (again_.came()) return false;
    return !limited_ || std::min(since_reader_took_something, std::chrono::steady_clock::now() - start_) <
                            std::chrono::seconds(1);
  }

 private:
  boost::asio::io_context io_{1};  // its own: that of the run would serve clients in the middle of a tick
  StopSignals again_{io_, {}};
  bool limited_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace canopus::cli
