#include "canopus/web/commands/child_process.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canopus/ascii/number.hpp"

namespace canopus::web {
namespace {

using boost::system::error_code;

/// Both ends of a pipe, closed unless they were taken.
struct Pipe {
  Pipe() { good = ::pipe2(ends.data(), O_CLOEXEC) == 0; }
  ~Pipe() {
    for (const int end : ends) {
      if (end >= 0) ::close(end);
    }
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int take_reading() { return std::exchange(ends[0], -1); }

  std::array<int, 2> ends{-1, -1};
  bool good = false;
};

/// That of this process, and what end_with_parent() reads.
std::vector<std::string> environment_of_child(const std::filesystem::path& folder) {
  std::vector<std::string> all;
  for (char** one = environ; *one != nullptr; ++one) all.emplace_back(*one);
  all.push_back(fmt::format("{}={}", parent_variable, ::getpid()));
  all.push_back(fmt::format("{}={}", parent_folder_variable, folder.string()));
  return all;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// A process ID identifies a process within its namespace alone, and several may share a folder for temporary files.
std::string folders_of_namespace() {
  struct stat status {};
  const bool is_known = ::stat("/proc/self/ns/pid", &status) == 0;
  return fmt::format("{}{}-", child_folder_prefix, is_known ? status.st_ino : 0);
}

/// A folder of make_folder(), of this user, whose process is there no more.
bool is_left_folder(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const std::string prefix = folders_of_namespace();
  constexpr std::size_t dice = 7;  // "-XXXXXX"
  if (!name.starts_with(prefix) || name.size() <= prefix.size() + dice) return false;
  const std::string_view digits =
      std::string_view(name).substr(prefix.size(), name.size() - prefix.size() - dice);
  const pid_t process = ascii::parse_number<pid_t>(digits).value_or(0);
  if (process <= 0 || name[name.size() - dice] != '-') return false;
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0 || !S_ISDIR(status.st_mode)) return false;
  return status.st_uid == ::geteuid() && ::kill(process, 0) != 0 && errno == ESRCH;
}

std::string sentence(int error) {
  return fmt::format("a command cannot be started: {}", std::generic_category().message(error));
}

}  // namespace

std::filesystem::path ChildProcess::make_folder() {
  std::error_code error;
  const std::string name = fmt::format("{}{}-XXXXXX", folders_of_namespace(), ::getpid());
  std::string path = (std::filesystem::temp_directory_path(error) / name).string();
  return error || ::mkdtemp(path.data()) == nullptr ? std::filesystem::path() : std::filesystem::path(path);
}

void ChildProcess::remove_left_folders() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path place = fs::temp_directory_path(error);
  if (error) return;
  for (fs::directory_iterator one(place, error), end; !error && one != end; one.increment(error)) {
    if (!is_left_folder(one->path())) continue;
    std::error_code ignored;
    fs::remove_all(one->path(), ignored);
  }
}

std::expected<std::shared_ptr<ChildProcess>, std::string> ChildProcess::start(
    boost::asio::io_context& io, const std::string& program, const std::vector<std::string>& arguments,
    Use use) {
  Pipe output;
  Pipe errors;
  if (!output.good || !errors.good) return std::unexpected(sentence(errno));
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawnattr_init(&attributes);
  ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&files, output.ends[1], STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, errors.ends[1], STDERR_FILENO);
  // Nobody but this process holds its servers' ports.
  ::posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  // What this process does with signals is not for the other one; Ctrl-C of the terminal is for this one alone.
  sigset_t all;
  sigset_t none;
  sigfillset(&all);
  sigemptyset(&none);
  ::posix_spawnattr_setsigdefault(&attributes, &all);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  ::posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  std::vector<std::string> words{"canopus"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> environment = environment_of_child(use.folder);
  pid_t process = 0;
  const int error = ::posix_spawn(&process, program.c_str(), &files, &attributes, pointers_to(words).data(),
                                  pointers_to(environment).data());
  ::posix_spawn_file_actions_destroy(&files);
  ::posix_spawnattr_destroy(&attributes);
  if (error != 0) return std::unexpected(sentence(error));
  std::shared_ptr<ChildProcess> child(
      new ChildProcess(io, process, output.take_reading(), errors.take_reading(), std::move(use)));
  child->read_output();
  child->read_errors();
  return child;
}

ChildProcess::ChildProcess(boost::asio::io_context& io, pid_t process, int output, int errors, Use use)
    : process_(process), output_(io, output), errors_(io, errors), use_(std::move(use)) {}

ChildProcess::~ChildProcess() { stop(); }

void ChildProcess::interrupt() noexcept {
  if (process_ > 0) ::kill(process_, SIGINT);
}

void ChildProcess::kill() noexcept {
  // And what it has started itself, which would hold its output open.
  if (process_ > 0) ::kill(-process_, SIGKILL);
}

void ChildProcess::stop() noexcept {
  use_ = {};
  error_code ignored;
  output_.close(ignored);
  errors_.close(ignored);
  const pid_t process = std::exchange(process_, 0);
  if (process <= 0) return;
  ::kill(process, SIGTERM);
  constexpr int turns = 100;
  for (int turn = 0; turn < turns; ++turn) {
    if (::waitpid(process, nullptr, WNOHANG) != 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ::kill(-process, SIGKILL);
  ::waitpid(process, nullptr, 0);
}

void ChildProcess::read_output() {
  output_.async_read_some(boost::asio::buffer(output_bytes_),
                          [self = shared_from_this()](error_code error, std::size_t count) {
                            self->read_ += count;
                            if (self->read_ <= self->use_.most_output) {
                              self->line_.append(self->output_bytes_.data(), count);
                              self->take_lines();
                            } else {
                              self->kill();
                            }
                            if (error) return self->closed();
                            self->read_output();
                          });
}

void ChildProcess::take_lines() {
  std::size_t begin = 0;
  for (std::size_t end = line_.find('\n'); end != std::string::npos; end = line_.find('\n', begin)) {
    if (use_.line) use_.line(line_.substr(begin, end - begin));
    begin = end + 1;
  }
  line_.erase(0, begin);
  if (line_.size() > longest_line && process_ > 0) {
    line_.clear();
    ::kill(-process_, SIGTERM);
  }
}

void ChildProcess::read_errors() {
  errors_.async_read_some(boost::asio::buffer(error_bytes_),
                          [self = shared_from_this()](error_code error, std::size_t count) {
                            const std::size_t room = longest_errors - self->said_.size();
                            self->said_.append(self->error_bytes_.data(), std::min(room, count));
                            if (error) return self->closed();
                            self->read_errors();
                          });
}

/// Both are closed when it has ended.
void ChildProcess::closed() {
  if (--open_ > 0) return;
  const pid_t process = std::exchange(process_, 0);
  if (process <= 0) return;
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (read_ > use_.most_output)
    said_ += fmt::format("it printed more than {} bytes and was ended\n", use_.most_output);
  const auto ended = std::exchange(use_, {}).ended;
  if (ended) ended(code, std::move(said_));
}

namespace {

/// Its value, which the children of this process do not get.
std::string taken_variable(const char* name) {
  const char* const value = ::getenv(name);
  std::string text = value == nullptr ? "" : value;
  ::unsetenv(name);
  return text;
}

void expect_end_of(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) std::raise(SIGTERM);  // it has ended before
}

/// Whatever comes for this process goes to the other one, until that has ended.
int pass_signals_on(pid_t process, const sigset_t& signals) {
  int status = 0;
  while (true) {
    const int signal = ::sigwaitinfo(&signals, nullptr);
    if (signal > 0 && signal != SIGCHLD) ::kill(process, signal);
    if (signal == SIGCHLD && ::waitpid(process, &status, WNOHANG) == process) return status;
  }
}

[[noreturn]] void end_as(int status) {
  if (WIFEXITED(status)) ::_exit(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  sigset_t none;
  sigemptyset(&none);
  std::signal(signal, SIG_DFL);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  std::raise(signal);
  ::_exit(128 + signal);
}

/// Returns in the second process.
void split(pid_t parent, const std::filesystem::path& folder) {
  sigset_t signals, before;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&signals, signal);
  ::sigprocmask(SIG_BLOCK, &signals, &before);
  expect_end_of(parent);  // passed on, too
  const pid_t first = ::getpid();
  const pid_t second = ::fork();
  if (second == 0) {
    expect_end_of(first);
    ::sigprocmask(SIG_SETMASK, &before, nullptr);
    return;
  }
  if (second < 0) {  // the folder has the parent alone
    ::sigprocmask(SIG_SETMASK, &before, nullptr);
    return;
  }
  // The parent waits for the end of the output of the second one.
  ::close_range(0, ~0U, 0);
  const int status = pass_signals_on(second, signals);
  std::error_code ignored;
  if (::getppid() != parent) std::filesystem::remove_all(folder, ignored);
  end_as(status);
}

}  // namespace

void end_with_parent() {
  const std::string variable = taken_variable(parent_variable);
  const std::filesystem::path folder = taken_variable(parent_folder_variable);
  const pid_t parent = ascii::parse_number<pid_t>(variable).value_or(0);
  if (parent <= 0) return;
  const bool is_ours = folder.is_absolute() && folder.filename().string().starts_with(child_folder_prefix);
  if (is_ours) return split(parent, folder);
  expect_end_of(parent);
}

}  // namespace canopus::web
