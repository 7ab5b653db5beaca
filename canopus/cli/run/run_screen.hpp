#pragma once
// The live table of a run on its terminal: drawn every quarter of a second, after a key and when the terminal
// gets another size. Ctrl-Z gives the terminal back before the process is suspended; afterwards the table comes
// back as soon as the process is in the foreground. One at a time in a process: it handles SIGTSTP and SIGWINCH.

#include <chrono>
#include <cstdint>
#include <functional>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/cli/run/screen.hpp"
#include "canopus/cli/run/table_layout.hpp"

namespace canopus::cli {

class RunScreen {
 public:
  struct Use {
    std::function<TableState()> state{};  ///< what to show
    std::function<void()> quit{};         ///< the key q
    /// The known number of times that the process was stopped and continued.
    std::function<std::uint64_t()> continuations{};
    bool colour = false;
  };
  /// `out` is the queue before the standard output, which is a terminal.
  RunScreen(boost::asio::io_context& io, OutputQueue& out, Use use);
  ~RunScreen() { end(); }
  RunScreen(const RunScreen&) = delete;
  RunScreen& operator=(const RunScreen&) = delete;

  void start();
  /// Gives the terminal back as it was.
  void end();

 private:
  bool redraw();
  void draw_again(std::chrono::milliseconds after);
  void wait_for_keys();
  void read_keys();
  void wait_for_size();
  void wait_for_suspension();
  void suspend();
  void redraw_after_shell();

  Use use_;
  Screen screen_;
  TableView view_;
  TablePicture picture_;
  std::uint64_t continuations_ = 0;
  boost::asio::steady_timer timer_;
  boost::asio::signal_set size_changed_;
  boost::asio::signal_set suspended_;
  boost::asio::posix::stream_descriptor keys_;
  bool has_keys_ = false;
  bool waits_for_keys_ = false;
  bool has_ended_ = false;
};

}  // namespace canopus::cli
