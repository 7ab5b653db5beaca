#include "canopus/campaign/python_check.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canopus/plant/events/event_printer.hpp"
#include "canopus/text/json_fields.hpp"
#include "canopus/trace/print/message_printer.hpp"

extern char** environ;

namespace canopus::campaign {
namespace {

// Prints of the function go to standard error. The answer is one line: what was found, and how far the events were read.
constexpr const char* host_program = R"(
import importlib.util, json, os, random, resource, sys, traceback
path, name, seconds, memory = sys.argv[1:5]
resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds)))
resource.setrlimit(resource.RLIMIT_AS, (int(memory), int(memory)))
answer_to = os.fdopen(os.dup(1), "w", encoding="utf-8")
os.dup2(2, 1)
random.seed(0)
def answer(**found):
    json.dump(found, answer_to)
    answer_to.write("\n")
    answer_to.flush()
time = 0
def events():
    global time
    for line in sys.stdin:
        event = json.loads(line)
        time = event["t"]
        yield event
def lines_of(error):
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename != "<string>" and not f.filename.startswith("<frozen")]
    return "".join(traceback.format_list(frames[-20:]) + traceback.format_exception_only(type(error), error))[:16000]
def short(text):
    return str(text)[:1000]
try:
    sys.path.insert(0, os.path.dirname(os.path.abspath(path)))
    spec = importlib.util.spec_from_file_location("invariants", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
except BaseException as error:
    answer(file=short(f"{type(error).__name__}: {error}"), traceback=lines_of(error))
    sys.exit()
function = getattr(module, name, None)
if not callable(function):
    answer(function="the file has no function of this name")
    sys.exit()
if len(sys.argv) > 5:
    answer(found="nothing")
    sys.exit()
try:
    result = function(events())
    if result is None or result is True:
        answer(found="nothing")
    elif result is False:
        answer(reason=f"{name} returned False", t=time)
    elif isinstance(result, str):
        answer(reason=short(result), t=time)
    else:
        answer(reason=f"{name} returned a value of type {type(result).__name__}; expected None, True, False or text", t=time)
except BaseException as error:
    answer(reason=short(f"{type(error).__name__}: {error}"), traceback=lines_of(error), t=time)
for line in sys.stdin:
    pass
)";

/// A Python process that is written to and read from through one socket.
class PythonProcess {
 public:
  PythonProcess(const std::string& path, const std::string& function, bool only_find) {
    std::array<int, 2> sockets{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) fail(errno);
    socket_ = sockets[0];
    const timeval longest{.tv_sec = std::chrono::seconds(longest_wait).count(), .tv_usec = 0};
    (void)::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest);
    const int error = start(path, function, only_find, sockets[1]);
    (void)::close(sockets[1]);
    if (error != 0) fail(error);
  }
  ~PythonProcess() {
    (void)::close(socket_);
    if (process_ <= 0) return;
    (void)::kill(process_, SIGKILL);
    (void)::waitpid(process_, nullptr, 0);
  }
  PythonProcess(const PythonProcess&) = delete;
  PythonProcess& operator=(const PythonProcess&) = delete;

  void write(std::string_view text) {
    while (!text.empty() && is_open_) {
      const ssize_t sent = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0) is_open_ = false;  // it has ended, and its answer says why; or it reads nothing
      if (sent > 0) text.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  /// What it answers after the last line; null: nothing.
  text::Json answer() {
    (void)::shutdown(socket_, SHUT_WR);
    std::string text;
    std::array<char, 4096> bytes{};
    const auto end = std::chrono::steady_clock::now() + longest_wait;
    while (text.size() < longest_answer) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      pollfd ready{.fd = socket_, .events = POLLIN, .revents = 0};
      if (left.count() <= 0 || ::poll(&ready, 1, static_cast<int>(left.count())) == 0) return {};
      const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      text.append(bytes.data(), static_cast<std::size_t>(count));
    }
    auto answer = text::parse_json(text, {.bytes = longest_answer, .depth = 4});
    return answer && answer->is_object() ? std::move(*answer) : text::Json();
  }

 private:
  // A process that uses no processor's time has no other bound. Long enough for any machine.
  static constexpr std::chrono::minutes longest_wait{10};
  static constexpr std::size_t longest_answer = std::size_t{256} << 10U;

  int start(const std::string& path, const std::string& function, bool only_find, int socket) {
    std::string program = "python3";
    std::string option = "-c";
    std::string host = host_program;
    std::string file = path;
    std::string name = function;
    std::string seconds = std::to_string(python_seconds);
    std::string memory = std::to_string(python_memory);
    std::string find = "find";
    std::vector<char*> words{program.data(), option.data(),  host.data(),  file.data(),
                             name.data(),    seconds.data(), memory.data()};
    if (only_find) words.push_back(find.data());
    words.push_back(nullptr);
    // Sets have the same order in every run; nothing is written beside the file.
    std::string hashes = "PYTHONHASHSEED=0";
    std::string no_bytecode = "PYTHONDONTWRITEBYTECODE=1";
    std::vector<char*> environment;
    for (char** each = environ; *each != nullptr; ++each) {
      const std::string_view variable = *each;
      if (!variable.starts_with("PYTHONHASHSEED=")) environment.push_back(*each);
    }
    environment.insert(environment.end(), {hashes.data(), no_bytecode.data(), nullptr});
    posix_spawn_file_actions_t files{};
    posix_spawnattr_t attributes{};
    (void)::posix_spawn_file_actions_init(&files);
    (void)::posix_spawnattr_init(&attributes);
    (void)::posix_spawn_file_actions_adddup2(&files, socket, STDIN_FILENO);
    (void)::posix_spawn_file_actions_adddup2(&files, socket, STDOUT_FILENO);
    // A process group of its own: Ctrl-C at the terminal ends the campaign and is no exception of the function.
    (void)::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    (void)::posix_spawnattr_setpgroup(&attributes, 0);
    const int error =
        ::posix_spawnp(&process_, program.c_str(), &files, &attributes, words.data(), environment.data());
    (void)::posix_spawn_file_actions_destroy(&files);
    (void)::posix_spawnattr_destroy(&attributes);
    if (error != 0) process_ = 0;
    return error;
  }
  [[noreturn]] void fail(int error) {
    if (socket_ >= 0) (void)::close(socket_);
    throw std::runtime_error(fmt::format("cannot start python3, which an invariant of the campaign needs: {}",
                                         std::strerror(error)));
  }

  int socket_ = -1;
  pid_t process_ = 0;
  bool is_open_ = true;
};

class PythonInvariant final : public InvariantCheck {
 public:
  PythonInvariant(const Invariant& invariant, RunResult& result, std::string path)
      : InvariantCheck(invariant, result), path_(std::move(path)) {}

  void on(const plant::Event& event) override {
    if (counts(event.time)) printer().on(event);
  }
  void receive(const trace::Message& message, std::string_view bus) override {
    if (!invariant().has_filter || !counts(message.time)) return;
    if (!invariant().filter.wants(message, bus, message.time.time_since_epoch(),
                                  [&] { return searched_text(message, bus); }))
      return;
    text::Json line = plant::event_line(message.time, "message");
    line.update(trace::to_json(message, bus));
    (void)printer();
    process_->write(line.dump() + '\n');
  }
  void end(can::Time now) override {
    (void)printer();
    const text::Json answer = process_->answer();
    const std::string reason = text::field_text(answer, "reason");
    const std::string unreadable = text::field_text(answer, "file") + text::field_text(answer, "function");
    if (!reason.empty()) {
      const can::Time at =
          can::Time{} +
          std::chrono::microseconds(static_cast<std::int64_t>(text::field_number(answer, "t") * 1e6 + 0.5));
      fail("", without_numbers(reason.substr(0, reason.find('\n'))), reason, std::min(at, now),
           text::field_text(answer, "traceback"));
    } else if (!unreadable.empty()) {
      fail("", without_numbers(unreadable), unreadable, now, text::field_text(answer, "traceback"));
    } else if (text::field_text(answer, "found") != "nothing") {
      fail("", "the function has no end",
           fmt::format("{} gave no result: it ended its process, or took more than {} s of a processor or {} "
                       "GiB of memory",
                       invariant().function, python_seconds, python_memory >> 30U),
           now);
    }
  }

 private:
  /// Starts the process before the first line.
  plant::JsonPrinter& printer() {
    if (process_ == nullptr) {
      process_ = std::make_unique<PythonProcess>(path_, invariant().function, false);
      printer_ = std::make_unique<plant::JsonPrinter>(lines_);
    }
    return *printer_;
  }

  std::string path_;
  std::unique_ptr<PythonProcess> process_;
  text::FunctionOutput lines_{[this](std::string_view line) { process_->write(line); }};
  std::unique_ptr<plant::JsonPrinter> printer_;
};

}  // namespace

std::string python_path(const std::string& campaign_path, const Invariant& invariant) {
  return (std::filesystem::path(campaign_path).parent_path() / invariant.file).lexically_normal().string();
}

std::string find_python_function(const std::string& path, const std::string& function) {
  if (!std::filesystem::is_regular_file(path)) return fmt::format("file: there is no file {}", path);
  try {
    const text::Json answer = PythonProcess(path, function, true).answer();
    if (const std::string problem = text::field_text(answer, "file"); !problem.empty())
      return fmt::format("file: {} cannot be imported: {}", path, problem);
    if (const std::string problem = text::field_text(answer, "function"); !problem.empty())
      return fmt::format("function = \"{}\": {}", function, problem);
    if (text::field_text(answer, "found") != "nothing")
      return fmt::format("file: {} ended Python while it was imported", path);
  } catch (const std::runtime_error& error) {
    return fmt::format("kind = \"python\": {}", error.what());
  }
  return {};
}

std::unique_ptr<InvariantCheck> make_python_check(const Invariant& invariant, RunResult& result,
                                                  std::string path) {
  return std::make_unique<PythonInvariant>(invariant, result, std::move(path));
}

}  // namespace canopus::campaign
