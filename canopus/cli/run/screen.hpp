#pragma once
// The terminal while it shows the live table: its other screen, redrawn in place, without a cursor and without
// wrapping, and its keys. Left in every case: at the end, before the process is suspended, and by a signal that
// ends the program at once.

#include <string>
#include <vector>

#include <termios.h>

#include "canopus/cli/output/output_queue.hpp"
#include "canopus/cli/run/table_state.hpp"
#include "canopus/cli/run/table_text.hpp"

namespace canopus::cli {

/// The terminal that the standard output is, as far as it controls this process: its keys, one at a time, and
/// whether the process is in its foreground. It is opened again for that: the description that the shell
/// shares with its programs must not become non-blocking, and boost::asio makes it so whenever it waits for
/// it.
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

class Screen {
 public:
  /// `out` is the queue before the standard output. One screen at a time.
  Screen(OutputQueue& out, bool colour);
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Nothing, as long as the process is in the background or the terminal takes nothing. True: it was shown.
  bool show(const std::vector<TableLine>& lines, TableSize size);
  [[nodiscard]] bool is_shown() const noexcept { return shown_; }
  /// Gives the terminal back as it was.
  void leave();
  /// The shell had the terminal: it is no longer as show() left it.
  void forget() noexcept { shown_ = false; }

  [[nodiscard]] Terminal& terminal() noexcept { return terminal_; }
  [[nodiscard]] static TableSize size();

 private:
  OutputQueue& out_;
  bool colour_;
  Terminal terminal_;
  bool shown_ = false;
};

/// The bytes that draw these lines on a terminal, from its upper left corner on.
[[nodiscard]] std::string drawn(const std::vector<TableLine>& lines, TableSize size, bool colour);

}  // namespace canopus::cli
