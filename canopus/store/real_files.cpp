#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canopus/store/files.hpp"

namespace canopus::store {

namespace {

// Repeats a call that a signal broke off. -1 is an error as the calls report it.
template <typename Call>
auto uninterrupted(Call call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

int outcome(int result) { return result < 0 ? errno : 0; }

class RealFiles final : public Files {
 public:
  std::expected<std::vector<std::uint8_t>, int> read(const std::filesystem::path& path,
                                                     std::size_t at_most) override {
    const int file = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY);
    if (file < 0) return std::unexpected(errno);
    std::vector<std::uint8_t> bytes;
    const int kind = check_kind(file);
    const int why = kind != 0 ? kind : read_all(file, bytes, at_most);
    ::close(file);
    if (why != 0) return std::unexpected(why);
    return bytes;
  }
  bool is_link(const std::filesystem::path& path) override {
    struct stat status {};
    return ::lstat(path.c_str(), &status) == 0 && S_ISLNK(status.st_mode);
  }
  int make_folder(const std::filesystem::path& path) override { return outcome(::mkdir(path.c_str(), 0755)); }
  std::expected<int, int> create(const std::filesystem::path& path) override {
    constexpr int new_file = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW;
    int file = open(path, new_file);
    // Left by a power cut, or put there by another program: a link is unlinked, not followed.
    if (file < 0 && errno == EEXIST && ::unlink(path.c_str()) == 0) file = open(path, new_file);
    if (file < 0) return std::unexpected(errno);
    return file;
  }
  std::expected<std::size_t, int> write(int file, std::span<const std::uint8_t> bytes) override {
    const ssize_t written = uninterrupted([&] { return ::write(file, bytes.data(), bytes.size()); });
    if (written < 0) return std::unexpected(errno);
    return static_cast<std::size_t>(written);
  }
  int flush(int file) override {
    return outcome(uninterrupted([&] { return ::fsync(file); }));
  }
  void close(int file) noexcept override { ::close(file); }
  int rename(const std::filesystem::path& from, const std::filesystem::path& to) override {
    return outcome(::rename(from.c_str(), to.c_str()));
  }
  int remove(const std::filesystem::path& path) override { return outcome(::unlink(path.c_str())); }
  int flush_folder(const std::filesystem::path& path) override {
    const int folder = open(path, O_RDONLY | O_DIRECTORY);
    if (folder < 0) return errno;
    const int why = flush(folder);
    ::close(folder);
    return why;
  }

 private:
  static int open(const std::filesystem::path& path, int how) {
    return uninterrupted([&] { return ::open(path.c_str(), how | O_CLOEXEC, 0644); });
  }

  static int check_kind(int file) {
    struct stat status {};
    if (::fstat(file, &status) != 0) return errno;
    if (S_ISDIR(status.st_mode)) return EISDIR;
    return S_ISREG(status.st_mode) ? 0 : not_a_file;
  }

  static int read_all(int file, std::vector<std::uint8_t>& bytes, std::size_t at_most) {
    std::array<std::uint8_t, 16384> piece{};
    for (;;) {
      const ssize_t count = uninterrupted([&] { return ::read(file, piece.data(), piece.size()); });
      if (count < 0) return errno;
      if (count == 0) return 0;
      bytes.insert(bytes.end(), piece.begin(), piece.begin() + count);
      if (bytes.size() > at_most) return EFBIG;
    }
  }
};

}  // namespace

std::string describe_error(int why) {
  return why == not_a_file ? "it is not a file" : std::generic_category().message(why);
}

Files& real_files() noexcept {
  static RealFiles files;
  return files;
}

}  // namespace canopus::store
