#include "canopus/cli/run/screen.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "canopus/cli/output/print.hpp"
#include "canopus/text/printable.hpp"

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

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// The other screen, no cursor, no wrapping; and back, with what follows below the table on a terminal that has
/// one screen only.
constexpr const char* enter_sequence = "\x1b[?1049h\x1b[?25l\x1b[?7l\x1b[2J";
constexpr const char* leave_sequence = "\x1b[0m\x1b[999;1H\n\x1b[?7h\x1b[?25h\x1b[?1049l";

std::string_view code(TableStyle style) {
  switch (style) {
    case TableStyle::plain: return "";
    case TableStyle::bold: return "1";
    case TableStyle::faint: return "2";
    case TableStyle::good: return "32";
    case TableStyle::warning: return "33";
    case TableStyle::error: return "31";
  }
  return "";
}

// --- signals that end the program at once

constexpr int fatal_signals[] = {SIGQUIT, SIGILL, SIGABRT, SIGBUS, SIGFPE, SIGSEGV};

std::atomic<const Terminal*> shown_terminal{nullptr};
static_assert(std::atomic<const Terminal*>::is_always_lock_free);

/// The handler is active once: the signal that it raises ends the program.
void restore_and_end(int signal) {
  if (const Terminal* terminal = shown_terminal.exchange(nullptr); terminal != nullptr) {
    terminal->restart_output();
    [[maybe_unused]] const ssize_t written =
        ::write(STDOUT_FILENO, leave_sequence, std::strlen(leave_sequence));
    terminal->give_back();
  }
  (void)::raise(signal);
}

/// Only for signals without another handler (of a sanitizer, for instance).
void set_handlers() {
  for (const int signal : fatal_signals) {
    struct sigaction now {};
    if (::sigaction(signal, nullptr, &now) != 0 || now.sa_handler != SIG_DFL) continue;
    struct sigaction ours {};
    ours.sa_handler = restore_and_end;
    ours.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
    ::sigaction(signal, &ours, nullptr);
  }
}

void remove_handlers() {
  for (const int signal : fatal_signals) {
    struct sigaction now {};
    if (::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == restore_and_end) {
      (void)std::signal(signal, SIG_DFL);
    }
  }
}

}  // namespace

std::string drawn(const std::vector<TableLine>& lines, TableSize size, bool colour) {
  std::string text;
  for (std::size_t row = 0; row < lines.size(); ++row) {
    text += fmt::format("\x1b[{};1H", row + 1);
    std::size_t columns = 0;
    for (const TableSpan& span : lines[row]) {
      const std::string safe = text::printable(span.text);
      columns += text::columns_of(safe);
      const bool plain = !colour || span.style == TableStyle::plain;
      text += plain ? safe : fmt::format("\x1b[{}m{}\x1b[0m", code(span.style), safe);
    }
    // At the end of a full line the cursor is on its last character.
    if (columns < size.columns) text += "\x1b[K";
  }
  if (lines.size() < size.rows) text += fmt::format("\x1b[{};1H\x1b[J", lines.size() + 1);
  return text;
}

Screen::Screen(OutputQueue& out, bool colour) : out_(out), colour_(colour) { set_handlers(); }

Screen::~Screen() {
  leave();
  remove_handlers();
}

bool Screen::show(const std::vector<TableLine>& lines, TableSize size) {
  // A terminal that is stopped gets the latest picture when it goes on, not all of them.
  if (!terminal_.is_foreground() || !out_.is_idle()) return false;
  std::string text;
  if (!shown_) {
    terminal_.read_keys();
    shown_terminal = &terminal_;
    shown_ = true;
    text = enter_sequence;
  }
  out_.content(text += drawn(lines, size, colour_));
  return true;
}

void Screen::leave() {
  if (!shown_) return;
  shown_ = false;
  if (terminal_.is_foreground()) {
    if (!out_.is_idle()) terminal_.restart_output();
    out_.content(leave_sequence);
    (void)out_.flush([start = Clock::now()](auto) { return Clock::now() - start < 1s; });
  }
  terminal_.give_back();
  shown_terminal = nullptr;
}

TableSize Screen::size() {
  winsize window{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_row == 0 || window.ws_col == 0) return {};
  return {window.ws_row, window.ws_col};
}

}  // namespace canopus::cli
