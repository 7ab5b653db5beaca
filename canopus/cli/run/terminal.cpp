#include "canopus/cli/run/terminal.hpp"

#include <csignal>
#include <cstddef>

#include <fcntl.h>
#include <unistd.h>

namespace canopus::cli {
namespace {

/// A background process that sets the terminal is stopped by SIGTTOU; it may have gone to the background
/// after the check.
void set(int descriptor, const termios& settings) {
  sigset_t stop, before;
  sigemptyset(&stop);
  sigaddset(&stop, SIGTTOU);
  ::pthread_sigmask(SIG_BLOCK, &stop, &before);
  (void)::tcsetattr(descriptor, TCSANOW, &settings);  // does not wait for unread output
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

bool is_key_by_key(const termios& settings) { return (settings.c_lflag & (ICANON | ECHO)) == 0U; }

}  // namespace

Terminal::Terminal() {
  if (::tcgetpgrp(STDOUT_FILENO) < 0) return;  // not the one that controls this process
  descriptor_ = ::open("/dev/tty", O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
}

Terminal::~Terminal() {
  if (descriptor_ < 0) return;
  give_back();
  ::close(descriptor_);
}

bool Terminal::is_foreground() const { return descriptor_ < 0 || ::tcgetpgrp(descriptor_) == ::getpgrp(); }

void Terminal::read_keys() {
  termios now{};
  if (descriptor_ < 0 || ::tcgetattr(descriptor_, &now) != 0) return;
  if (!taken_ || !is_key_by_key(now)) before_ = now;
  ours_ = now;
  ours_.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  ours_.c_cc[VMIN] = 1;
  ours_.c_cc[VTIME] = 0;
  taken_ = true;
  set(descriptor_, ours_);
}

bool Terminal::has_keys() const {
  termios now{};
  return taken_ && ::tcgetattr(descriptor_, &now) == 0 && is_key_by_key(now);
}

void Terminal::give_back() const {
  if (taken_ && is_foreground()) set(descriptor_, before_);
}

std::string Terminal::read() {
  char bytes[256];
  const ssize_t size = ::read(descriptor_, bytes, sizeof bytes);
  return size > 0 ? std::string(bytes, static_cast<std::size_t>(size)) : std::string();
}

void Terminal::restart_output() const {
  // Only what tcflow() stopped can be started by it.
  const int descriptor = descriptor_ < 0 ? STDOUT_FILENO : descriptor_;
  if (!is_foreground()) return;
  (void)::tcflow(descriptor, TCOOFF);
  (void)::tcflow(descriptor, TCOON);
}

}  // namespace canopus::cli
