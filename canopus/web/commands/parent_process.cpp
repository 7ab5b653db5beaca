#include "canopus/web/commands/parent_process.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canopus/ascii/number.hpp"

namespace canopus::web {
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
