#include "canopus/cli/output/print.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

/// The standard output or standard error. Nothing is kept back: the two stay in order on a terminal.
class StandardStream final : public Output {
 public:
  explicit StandardStream(int descriptor) : descriptor_(descriptor) {}
  void divert(Output* to) { diverted_ = to; }
  /// Lines that cannot be written are dropped; end_keeping_quiet() returns the reason (errno, or 0).
  void silence() {
    is_quiet_ = true;
    error_ = 0;
  }
  [[nodiscard]] int end_keeping_quiet() {
    is_quiet_ = false;
    return error_;
  }

 private:
  void write(std::string_view text) override {
    if (diverted_ != nullptr) return diverted_->content(text);
    end_progress();
    if (is_quiet_ && error_ != 0) return;
    while (!text.empty()) {
      const ssize_t written = ::write(descriptor_, text.data(), text.size());
      if (written >= 0) {
        text.remove_prefix(static_cast<std::size_t>(written));
      } else if (errno != EAGAIN || !wait_for_reader()) {
        if (descriptor_ == STDERR_FILENO) return;
        if (is_quiet_ && errno != EINTR) {
          error_ = errno;
          return;
        }
        throw OutputFailed(errno);
      }
    }
  }

  /// Another process may have set O_NONBLOCK on the description it shares with this one.
  [[nodiscard]] bool wait_for_reader() const {
    pollfd state{.fd = descriptor_, .events = POLLOUT, .revents = 0};
    return ::poll(&state, 1, -1) > 0;
  }

  int descriptor_;
  Output* diverted_ = nullptr;
  bool is_quiet_ = false;
  int error_ = 0;
};

StandardStream& stream(int descriptor) {
  static StandardStream out(STDOUT_FILENO);
  static StandardStream error(STDERR_FILENO);
  return descriptor == STDOUT_FILENO ? out : error;
}

bool progress_is_shown = false;

void write_to_terminal(std::string_view text) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

}  // namespace

bool is_terminal(int descriptor) {
  const char* terminal = std::getenv("TERM");
  return isatty(descriptor) != 0 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

bool wants_colour(int descriptor) {
  const char* refused = std::getenv("NO_COLOR");  // no-color.org: set and not empty
  return (refused == nullptr || *refused == '\0') && is_terminal(descriptor);
}

OutputFailed::OutputFailed(int error)
    : std::runtime_error(error == EINTR
                             ? "interrupted"
                             : "cannot write the output: " + std::generic_category().message(error)) {}

void reserve_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest free number, so this one; for the wrong direction, so that its use fails as before.
    (void)::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

Output& standard_output() { return stream(STDOUT_FILENO); }

Output& standard_error() { return stream(STDERR_FILENO); }

Diversion::Diversion(Output& out, Output& error) {
  stream(STDOUT_FILENO).divert(&out);
  stream(STDERR_FILENO).divert(&error);
}

Diversion::~Diversion() {
  stream(STDOUT_FILENO).divert(nullptr);
  stream(STDERR_FILENO).divert(nullptr);
}

int run_ignoring_sigpipe(const std::function<int()>& work) {
  struct Quiet {
    Quiet() {
      struct sigaction ignored {};
      ignored.sa_handler = SIG_IGN;
      (void)::sigaction(SIGPIPE, &ignored, &before);
      stream(STDOUT_FILENO).silence();
    }
    ~Quiet() {
      (void)::sigaction(SIGPIPE, &before, nullptr);
      (void)stream(STDOUT_FILENO).end_keeping_quiet();
    }
    Quiet(const Quiet&) = delete;
    Quiet& operator=(const Quiet&) = delete;
    struct sigaction before {};
  } quiet;
  const int code = work();
  const int error = stream(STDOUT_FILENO).end_keeping_quiet();
  if (error != 0 && error != EPIPE) throw OutputFailed(error);
  return code;
}

void print_json(const text::Json& object) { standard_output().json(object); }

void show_progress(const Line& line) {
  if (!is_terminal(STDERR_FILENO)) return;
  winsize window{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 1;
  const std::string_view text = text::clipped(line.text(), known ? window.ws_col - 1U : 79U);
  write_to_terminal(fmt::format("\r{}\x1b[K", text));
  progress_is_shown = true;
}

void end_progress() {
  if (!progress_is_shown) return;
  progress_is_shown = false;
  write_to_terminal("\r\x1b[K");
}

}  // namespace canopus::cli
