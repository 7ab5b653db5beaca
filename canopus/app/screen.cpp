#include "canopus/app/screen.hpp"

#include <cstdio>

#include <sys/ioctl.h>
#include <unistd.h>

namespace canopus::app {

Screen::~Screen() { leave(); }

void Screen::show(const std::string& picture) {
  std::string out = shown_ ? "\x1b[H" : "\x1b[?1049h\x1b[?25l\x1b[2J\x1b[H";
  shown_ = true;
  out += picture + "\x1b[J";
  std::fwrite(out.data(), 1, out.size(), stdout);
  std::fflush(stdout);
}

void Screen::leave() {
  if (shown_) std::fputs("\x1b[?25h\x1b[?1049l", stdout);
  shown_ = false;
  std::fflush(stdout);
}

TableSize Screen::size() {
  winsize window{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_row == 0) return {};
  return {window.ws_row, window.ws_col};
}

}  // namespace canopus::app
