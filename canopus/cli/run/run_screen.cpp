#include "canopus/cli/run/run_screen.hpp"

#include <chrono>
#include <csignal>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "canopus/cli/run/table_keys.hpp"

namespace canopus::cli {
namespace {

namespace asio = boost::asio;
using Error = boost::system::error_code;
using namespace std::chrono_literals;

constexpr auto interval = 250ms;

}  // namespace

RunScreen::RunScreen(asio::io_context& io, OutputQueue& out, Use use)
    : use_(std::move(use)),
      screen_(out, use_.colour),
      timer_(io),
      size_changed_(io, SIGWINCH),
      suspended_(io),
      keys_(io) {}

void RunScreen::start() {
  if (screen_.terminal().descriptor() >= 0) {
    Error error;
    keys_.assign(screen_.terminal().descriptor(), error);
    has_keys_ = !error;
  }
  continuations_ = use_.continuations();
  wait_for_size();
  wait_for_suspension();
  redraw();
  draw_again(interval);
}

void RunScreen::end() {
  if (std::exchange(has_ended_, true)) return;
  Error ignored;
  timer_.cancel();
  size_changed_.cancel(ignored);
  suspended_.clear(ignored);
  if (has_keys_) (void)keys_.release();  // it is the terminal's
  screen_.leave();
}

void RunScreen::draw_again(std::chrono::milliseconds after) {
  timer_.expires_after(after);
  timer_.async_wait([this](const Error& error) {
    if (error) return;
    redraw();
    draw_again(interval);
  });
}

bool RunScreen::redraw() {
  TableState state = use_.state();
  redraw_after_shell();
  state.has_keys = has_keys_;
  const TableSize size = Screen::size();
  picture_ = lay_out(state, view_, size);
  view_.first = picture_.first;
  const bool is_up_to_date = screen_.show(picture_.lines, size);
  if (is_up_to_date) wait_for_keys();
  return is_up_to_date;
}

/// A process stopped by SIGSTOP could not restore the terminal for the shell: draws everything again after
/// SIGCONT.
void RunScreen::redraw_after_shell() {
  const std::uint64_t now = use_.continuations();
  const bool continued = std::exchange(continuations_, now) != now;
  if (!screen_.is_shown()) return;
  if (continued || (has_keys_ && !screen_.terminal().has_keys())) screen_.forget();
}

void RunScreen::wait_for_keys() {
  if (!has_keys_ || waits_for_keys_) return;
  waits_for_keys_ = true;
  keys_.async_wait(asio::posix::stream_descriptor::wait_read, [this](const Error& error) {
    if (error) return;
    waits_for_keys_ = false;
    read_keys();
  });
}

void RunScreen::read_keys() {
  // Keys typed while the process is in the background belong to the shell: redraw() waits for keys again.
  if (!screen_.is_shown() || !screen_.terminal().is_foreground()) return;
  const std::string bytes = screen_.terminal().read();
  if (bytes.empty()) return;  // redraw() tries again
  for (const TableKey key : keys_in(bytes)) {
    if (key == TableKey::quit) return use_.quit();
    view_ = after_key(view_, key, picture_);
    picture_.first = view_.first;
  }
  if (!redraw()) draw_again(30ms);  // the last picture is still on its way
  wait_for_keys();
}

void RunScreen::wait_for_size() {
  size_changed_.async_wait([this](const Error& error, int) {
    if (error) return;
    redraw();
    wait_for_size();
  });
}

void RunScreen::wait_for_suspension() {
  struct sigaction now {};
  if (::sigaction(SIGTSTP, nullptr, &now) != 0 || now.sa_handler == SIG_IGN) return;
  Error error;
  suspended_.add(SIGTSTP, error);
  if (error) return;
  suspended_.async_wait([this](const Error& failed, int) {
    if (!failed) suspend();
  });
}

void RunScreen::suspend() {
  screen_.leave();
  Error ignored;
  suspended_.clear(ignored);  // as for a program that does not handle the signal
  (void)std::raise(SIGTSTP);
  // Continued: in the foreground, or in the background, where nothing is shown.
  wait_for_suspension();
  redraw();
}

}  // namespace canopus::cli
