#pragma once
// The terminal that the standard output is, as far as it controls this process: its keys, one at a time, and
// whether the process is in its foreground. It is opened again for that: the description that the shell
// shares with its programs must not become non-blocking, and boost::asio makes it so whenever it waits for
// it.

#include <string>

#include <termios.h>

namespace canopus::cli {

class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// The descriptor that keys are read from, non-blocking; -1: the standard output is no terminal, or another
  /// one than the one that controls this process. There are no keys then, and no foreground to be in.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] bool is_foreground() const;

  /// Keys come one by one and are not shown from now on. Ctrl-C, Ctrl-Z, Ctrl-S and Ctrl-Q work as before.
  void read_keys();
  /// True after read_keys() while the settings are unchanged.
  [[nodiscard]] bool has_keys() const;
  /// Restores the settings before read_keys(), if the process is in the foreground. Thread-safe and
  /// async-signal-safe.
  void give_back() const;
  /// The input up to now. Empty: none, or the terminal is gone.
  [[nodiscard]] std::string read();
  /// Output goes on that was stopped by Ctrl-S. Any thread or signal handler may call it.
  void restart_output() const;

 private:
  int descriptor_ = -1;
  bool taken_ = false;
  termios before_{};  // of the last read_keys()
  termios ours_{};
};

}  // namespace canopus::cli
