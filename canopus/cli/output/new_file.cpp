#include "canopus/cli/output/new_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace canopus::cli {
namespace {

constexpr std::array ending_signals{SIGINT, SIGTERM, SIGHUP};

/// For the signal handler, which may not allocate.
std::array<char, PATH_MAX> unfinished{};
std::atomic<bool> is_unfinished = false;
static_assert(std::atomic<bool>::is_always_lock_free);
std::array<struct sigaction, ending_signals.size()> actions_before{};

extern "C" void remove_and_end(int signal) {
  if (is_unfinished.exchange(false)) (void)::unlink(unfinished.data());
  (void)std::signal(signal, SIG_DFL);
  (void)::raise(signal);
}

/// Signals that end the program by default remove the file first; ignored ones (nohup) stay ignored.
void watch_signals(const std::string& path) {
  std::strcpy(unfinished.data(), path.c_str());
  is_unfinished = true;
  for (std::size_t i = 0; i < ending_signals.size(); ++i) {
    (void)::sigaction(ending_signals[i], nullptr, &actions_before[i]);
    if (actions_before[i].sa_handler != SIG_DFL) continue;
    struct sigaction action {};
    action.sa_handler = remove_and_end;
    (void)::sigaction(ending_signals[i], &action, nullptr);
  }
}

void forget_signals() {
  is_unfinished = false;
  for (std::size_t i = 0; i < ending_signals.size(); ++i) {
    if (actions_before[i].sa_handler == SIG_DFL)
      (void)::sigaction(ending_signals[i], &actions_before[i], nullptr);
  }
}

/// The name of a descriptor: other processes may share its file offset.
bool is_open_already(const std::string& name) {
  std::error_code failure;
  const std::string plain = std::filesystem::absolute(name, failure).lexically_normal().string();
  return plain.starts_with("/dev/std") || plain.starts_with("/dev/fd/") || plain.starts_with("/proc/");
}

}  // namespace

NewFile::NewFile(const std::string& name) : name_(name), path_(name) {
  if (is_open_already(name)) return;
  std::error_code failure;
  const auto real = std::filesystem::weakly_canonical(name, failure);
  if (failure) return;
  struct stat found {};
  const bool exists = ::stat(name.c_str(), &found) == 0;
  if (exists && !S_ISREG(found.st_mode)) return;
  if (exists && ::access(name.c_str(), W_OK) != 0) return;  // the error of opening it has the reason
  const std::string beside = real.string() + '.' + std::to_string(::getpid()) + ".part";
  if (beside.size() >= unfinished.size()) return;
  const int file = ::open(beside.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  if (file < 0) return;
  watch_signals(beside);
  if (exists) (void)::fchmod(file, found.st_mode & 07777U);
  (void)::close(file);
  name_ = real.string();
  path_ = beside;
  is_beside_ = true;
}

NewFile::~NewFile() {
  if (!is_beside_) return;
  (void)::unlink(path_.c_str());
  forget_signals();
}

std::expected<void, std::string> NewFile::commit() {
  if (!is_beside_) return {};
  if (std::rename(path_.c_str(), name_.c_str()) != 0) {
    return std::unexpected(name_ + ": cannot create the file: " + std::strerror(errno));
  }
  is_beside_ = false;
  forget_signals();
  return {};
}

std::expected<void, std::string> write_new_file(const std::string& name, std::string_view content) {
  NewFile file(name);
  errno = 0;
  std::ofstream stream(file.path(), std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream) {
    return std::unexpected("cannot write " + name + ": " + (errno != 0 ? std::strerror(errno) : "I/O error"));
  }
  return file.commit();
}

bool is_same_file(const std::string& in, const std::string& out) {
  struct stat first {
  }, second{};
  const int found = in == "-" ? ::fstat(STDIN_FILENO, &first) : ::stat(in.c_str(), &first);
  return out != "-" && found == 0 && ::stat(out.c_str(), &second) == 0 && S_ISREG(first.st_mode) &&
         first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

}  // namespace canopus::cli
