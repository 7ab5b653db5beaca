#include "canopus/text/file_text.hpp"

#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace canopus::text {
namespace {

using Text = std::expected<std::string, std::string>;

/// A file descriptor that closes itself.
class OpenFile {
 public:
  OpenFile(const std::string& path, int flags)
      : number_(::open(path.c_str(), flags | O_RDONLY | O_CLOEXEC)) {}
  ~OpenFile() {
    if (number_ >= 0) ::close(number_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[nodiscard]] int number() const noexcept { return number_; }

 private:
  int number_;
};

/// Nothing for a file; else why it is none.
std::string reason_not_a_file(int number) {
  struct stat status {};
  if (::fstat(number, &status) != 0) return std::strerror(errno);
  if (S_ISREG(status.st_mode)) return {};
  if (S_ISDIR(status.st_mode)) return std::strerror(EISDIR);
  return S_ISFIFO(status.st_mode) ? "it is a FIFO, not a file" : "it is a device, not a file";
}

Text read_until_the_end(int number) {
  constexpr std::size_t most = std::size_t{64} << 20;
  std::string text;
  std::array<char, 65536> piece;
  for (;;) {
    const ssize_t count = ::read(number, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::unexpected(std::strerror(errno));
    if (count == 0) return text;
    text.append(piece.data(), static_cast<std::size_t>(count));
    if (text.size() > most) return std::unexpected("it is larger than 64 MiB");
  }
}

Text read_all(const std::string& path, bool files_alone) {
  if (path.find('\0') != std::string::npos) return std::unexpected("a path cannot hold the character NUL");
  const OpenFile file(path, files_alone ? O_NONBLOCK | O_NOCTTY : 0);  // never waits for the other end
  if (file.number() < 0) return std::unexpected(std::strerror(errno));
  if (files_alone) {
    if (std::string why = reason_not_a_file(file.number()); !why.empty()) {
      return std::unexpected(std::move(why));
    }
  }
  return read_until_the_end(file.number());
}

Text as_sentence(const std::string& path, Text text) {
  if (text) return text;
  return std::unexpected(fmt::format("cannot read {}: {}", path, text.error()));
}

}  // namespace

std::expected<std::string, std::string> read_file(const std::string& path) {
  return as_sentence(path, read_all(path, true));
}

std::expected<std::string, std::string> read_file_or_reason(const std::string& path) {
  return read_all(path, true);
}

std::expected<std::string, std::string> read_file_or_pipe(const std::string& path) {
  return as_sentence(path, read_all(path, false));
}

std::expected<std::string, std::string> read_standard_input() { return read_until_the_end(STDIN_FILENO); }

}  // namespace canopus::text
