#include "canopus/cli/app/password_input.hpp"

#include <array>
#include <cerrno>
#include <optional>
#include <system_error>

#include <termios.h>
#include <unistd.h>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {
namespace {

constexpr char interrupted = '\x03';  // Ctrl-C

/// Disables the terminal's echo for its lifetime. Ctrl-C is a character that ends the line: as a signal it
/// would leave the echo off.
class Silence {
 public:
  Silence() {
    ::tcgetattr(STDIN_FILENO, &before_);
    termios silent = before_;
    silent.c_lflag &= ~static_cast<tcflag_t>(ECHO | ISIG);
    silent.c_lflag |= ECHONL;
    silent.c_cc[VEOL] = interrupted;
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
  }
  ~Silence() { ::tcsetattr(STDIN_FILENO, TCSADRAIN, &before_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  termios before_{};
};

/// Up to the end of the line, byte by byte: the input behind it belongs to other readers. Nothing at the end
/// of the input.
std::expected<std::optional<std::string>, std::string> read_line() {
  constexpr std::size_t most = 4096;
  std::string line;
  while (line.size() < most) {
    char letter = 0;
    const ssize_t count = ::read(STDIN_FILENO, &letter, 1);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::unexpected(std::generic_category().message(errno));
    if (count == 0) return line.empty() ? std::optional<std::string>() : line;
    if (letter == interrupted) return std::unexpected(std::string("interrupted"));
    if (letter == '\n') break;
    line += letter;
  }
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

std::expected<std::string, std::string> prompt(const std::string& sentence) {
  if (!sentence.empty()) print_error("{}", sentence);
  auto line = read_line();
  if (!line) return std::unexpected("the password cannot be read: " + line.error());
  if (!*line) return std::unexpected(std::string("expected a password on the standard input"));
  return std::move(**line);
}

}  // namespace

std::expected<std::string, std::string> read_password(const std::string& user) {
  if (::isatty(STDIN_FILENO) == 0) return prompt({});
  const Silence silence;
  auto first = prompt("Password of " + user + " (it is not shown):");
  if (!first) return first;
  const auto second = prompt("The same again:");
  if (!second) return second;
  if (*first != *second) return std::unexpected(std::string("the two passwords are not the same"));
  return first;
}

}  // namespace canopus::cli
