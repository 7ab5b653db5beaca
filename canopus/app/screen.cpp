#include "canopus/app/screen.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include "canopus/app/print.hpp"

namespace canopus::app {

Screen::~Screen() { leave(); }

void Screen::show(const std::string& picture) {
  std::string out = shown_ ? "\x1b[H" : "\x1b[?1049h\x1b[?25l\x1b[2J\x1b[H";
  shown_ = true;
  out += picture + "\x1b[J";
  standard_output().content(out);
}

void Screen::leave() {
  if (shown_) standard_output().content("\x1b[?25h\x1b[?1049l");
  shown_ = false;
}

TableSize Screen::size() {
  winsize window{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_row == 0) return {};
  return {window.ws_row, window.ws_col};
}

}  // namespace canopus::app
