#include "canopus/store/folder_lock.hpp"

#include <array>
#include <cerrno>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canopus/store/file_memory.hpp"

namespace canopus::store {

namespace {

/// The number that the lock's holder has written, or nothing.
std::string process_in(int file) {
  std::array<char, 24> text{};
  const ssize_t length = ::pread(file, text.data(), text.size(), 0);
  std::string digits;
  for (ssize_t i = 0; i < length; ++i) {
    const char c = text[static_cast<std::size_t>(i)];
    if (c < '0' || c > '9') break;
    digits += c;
  }
  return digits;
}

}  // namespace

FolderLock::~FolderLock() {
  if (file_ >= 0) ::close(file_);
}

std::expected<FolderLock, std::string> FolderLock::acquire(const std::filesystem::path& folder) {
  const auto refuse = [](std::string_view what, int why) {
    return std::unexpected(std::string(what) + ": " + describe_error(why));
  };
  if (const int why = make_folders(real_files(), folder); why != 0) {
    return refuse("cannot make the folder", why);
  }
  std::error_code no_folder;
  if (!std::filesystem::is_directory(folder, no_folder)) return refuse("cannot use it", ENOTDIR);
  const std::filesystem::path path = folder / ".lock";
  constexpr int flags = O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const int number = ::open(path.c_str(), flags, 0644);
  if (number < 0) return refuse("cannot write into it: .lock", errno);
  FolderLock lock(number);
  struct stat status {};
  if (::fstat(number, &status) != 0) return refuse("cannot write into it: .lock", errno);
  if (!S_ISREG(status.st_mode)) return refuse("cannot write into it: .lock", not_a_file);
  if (::flock(number, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return refuse("cannot lock it", errno);
    const std::string process = process_in(number);
    return std::unexpected("another process " + (process.empty() ? "" : "(" + process + ") ") + "uses it");
  }
  const std::string process = std::to_string(::getpid()) + "\n";
  if (::ftruncate(number, 0) != 0 ||
      ::pwrite(number, process.data(), process.size(), 0) != static_cast<ssize_t>(process.size())) {
    return refuse("cannot write into it: .lock", errno);
  }
  return lock;
}

}  // namespace canopus::store
