#pragma once
// The terminal while it shows the live table: its other screen, redrawn in place, without a cursor and without
// wrapping, and its keys. Left in every case: at the end, before the process is suspended, and by a signal that
// ends the program at once.

#include <string>
#include <vector>

#include "canopus/cli/output/output_queue.hpp"
#include "canopus/cli/run/table_state.hpp"
#include "canopus/cli/run/table_text.hpp"
#include "canopus/cli/run/terminal.hpp"

namespace canopus::cli {

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
