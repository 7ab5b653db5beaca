#include "canopus/serve/service_manager.hpp"

#include <systemd/sd-daemon.h>

namespace canopus::serve {
namespace {

/// The result is ignored: a manager that cannot be reached is no error of the run.
void notify(const std::string& state) { (void)sd_notify(0, state.c_str()); }

}  // namespace

ServiceManager::ServiceManager(boost::asio::io_context& io) : timer_(io) {
  std::uint64_t microseconds = 0;
  if (sd_watchdog_enabled(0, &microseconds) > 0) watchdog_ = std::chrono::microseconds(microseconds);
}

void ServiceManager::ready(const std::string& status) {
  std::string sentence = status;
  for (char& character : sentence) {
    if (character == '\n') character = ' ';  // separates variables
  }
  notify("READY=1\nSTATUS=" + sentence);
  if (watchdog_ > std::chrono::microseconds{}) stay_alive();
}

void ServiceManager::stopping() {
  timer_.cancel();
  notify("STOPPING=1");
}

void ServiceManager::stay_alive() {
  notify("WATCHDOG=1");
  timer_.expires_after(watchdog_ / 2);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) stay_alive();
  });
}

}  // namespace canopus::serve
