#pragma once
// Notifies the service manager that started the program (systemd) of the run's state: ready, alive, stopping.
// Without one it does nothing.

#include <chrono>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

namespace canopus::serve {

/// The protocol of sd_notify(3): datagrams to the socket that NOTIFY_SOCKET names. A unit of `Type=notify` waits for
/// ready(). With `WatchdogSec=` the manager restarts a program that was silent for so long: signs of life are sent
/// twice in that time, by the thread that runs `io` and so the plant, as long as it gets round.
class ServiceManager {
 public:
  explicit ServiceManager(boost::asio::io_context& io);

  /// All servers listen. `status`: a sentence for `systemctl status`.
  void ready(const std::string& status);
  /// The run ends; no more signs of life.
  void stopping();

 private:
  void stay_alive();

  boost::asio::steady_timer timer_;
  std::chrono::microseconds watchdog_{};  ///< 0: no watchdog
};

}  // namespace canopus::serve
