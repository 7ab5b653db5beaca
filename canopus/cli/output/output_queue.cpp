#include "canopus/cli/output/output_queue.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <utility>

#include <poll.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

namespace canopus::cli {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr std::size_t most_gathered = std::size_t{1} << 16;  // octets

bool is_pipe(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISFIFO(status.st_mode);
}

/// The next piece to write: whole lines that a pipe takes in one piece, so that another writer's lines do not
/// come in between. A line that is longer goes in parts.
std::string_view next_piece(std::string_view text) {
  constexpr std::size_t most = PIPE_BUF;
  if (text.size() <= most) return text;
  const std::size_t end = text.rfind('\n', most - 1);
  return text.substr(0, end == std::string_view::npos ? most : end + 1);
}

std::uint64_t lines_in(std::string_view text) {
  return static_cast<std::uint64_t>(std::ranges::count(text, '\n'));
}

}  // namespace

/// State shared by the writing and the printing thread.
struct OutputQueue::Shared {
  Shared(int to, Use how) : descriptor(to), use(std::move(how)) {}

  const int descriptor;
  const Use use;
  mutable std::mutex mutex;
  std::condition_variable work;   // for the thread
  std::condition_variable moved;  // for threads that wait for the reader
  // All under the mutex, but `batch`, which the thread writes without it while `writing`.
  std::string waiting;
  std::string batch;
  std::size_t written = 0;  // octets of the batch
  bool writing = false;
  bool closing = false;
  bool ended = false;
  std::uint64_t unsaid = 0;  // lines lost since the last word about them
  std::uint64_t lost = 0;
  int error = 0;
  Clock::time_point moved_at = Clock::now();

  [[nodiscard]] bool idle() const { return error != 0 || (waiting.empty() && !writing && unsaid == 0); }
  [[nodiscard]] bool is_open() const { return error == 0 && !closing; }
  /// Once lines are lost, the line with their number comes first.
  [[nodiscard]] bool fits(std::size_t size) const {
    return unsaid == 0 && (waiting.empty() || waiting.size() + size <= use.capacity);
  }
  /// Waits until `done`, with the lock, and calls the patience periodically, without it.
  template <typename Done>
  bool wait(std::unique_lock<std::mutex>& lock, const Patience& patience, Done done) {
    while (!done()) {
      const Clock::duration since = Clock::now() - moved_at;
      lock.unlock();
      const bool goes_on = patience && patience(since);
      lock.lock();
      if (!goes_on) return done();
      moved.wait_for(lock, 20ms, done);
    }
    return true;
  }

  void run();
  void move_batch();
  bool write_batch(std::unique_lock<std::mutex>& lock);
  void fail(int reason);
  [[nodiscard]] bool reader_is_gone() const;
};

void OutputQueue::Shared::fail(int reason) {
  error = reason;
  waiting.clear();
  unsaid = 0;
  if (use.failed && !closing) use.failed(reason);
  moved.notify_all();
}

/// Detects that the reader of a pipe has gone, without a line to write, as `tail -f` does.
bool OutputQueue::Shared::reader_is_gone() const {
  pollfd state{.fd = descriptor, .events = 0, .revents = 0};
  return ::poll(&state, 1, 0) == 1 && (state.revents & POLLERR) != 0;
}

void OutputQueue::Shared::move_batch() {
  batch.clear();
  std::swap(batch, waiting);
  if (unsaid != 0 && use.lost_line) batch += use.lost_line(unsaid);
  unsaid = 0;
  written = 0;
  writing = true;
  moved_at = Clock::now();
  moved.notify_all();
}

/// False: it failed.
bool OutputQueue::Shared::write_batch(std::unique_lock<std::mutex>& lock) {
  while (written < batch.size() && !closing) {
    const std::string_view piece = next_piece(std::string_view(batch).substr(written));
    lock.unlock();
    const ssize_t size = ::write(descriptor, piece.data(), piece.size());
    const int reason = errno;
    lock.lock();
    if (size < 0 && reason == EAGAIN) {  // O_NONBLOCK of another process on a shared description
      lock.unlock();
      pollfd state{.fd = descriptor, .events = POLLOUT, .revents = 0};
      (void)::poll(&state, 1, 100);
      lock.lock();
    } else if (size < 0 && reason != EINTR) {
      writing = false;
      fail(reason);
      return false;
    } else if (size > 0) {
      written += static_cast<std::size_t>(size);
      moved_at = Clock::now();
      moved.notify_all();
    }
  }
  writing = false;
  moved.notify_all();
  return true;
}

void OutputQueue::Shared::run() {
  std::unique_lock lock(mutex);
  const bool watches_reader = is_pipe(descriptor);
  bool has_written = false;
  while (error == 0) {
    const auto has_work = [this] { return closing || !waiting.empty() || unsaid != 0; };
    if (!work.wait_for(lock, watches_reader && has_written ? 1s : 1h, has_work)) {
      if (watches_reader && reader_is_gone()) fail(EPIPE);
      continue;
    }
    if (waiting.empty() && unsaid == 0) break;
    move_batch();
    has_written = true;
    if (!write_batch(lock)) break;
  }
  ended = true;
  moved.notify_all();
}

OutputQueue::OutputQueue(int descriptor, Use use)
    : shared_(std::make_shared<Shared>(descriptor, std::move(use))) {}

void OutputQueue::start_thread() {
  // Signals are for the thread that runs the plant.
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([shared = shared_] { shared->run(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

OutputQueue::~OutputQueue() { (void)finish({}); }

void OutputQueue::write(std::string_view text) {
  std::unique_lock lock(shared_->mutex);
  if (!thread_.joinable() && !shared_->closing) start_thread();
  const auto settled = [&] { return !shared_->is_open() || shared_->fits(text.size()); };
  if (gathers_ && !settled()) shared_->work.notify_one();
  if (!shared_->wait(lock, patience_, settled) || !shared_->is_open()) {
    ++shared_->lost;
    if (shared_->is_open()) ++shared_->unsaid;
    return;
  }
  if (shared_->idle()) shared_->moved_at = Clock::now();  // its reader had nothing to take until now
  shared_->waiting += text;
  has_gathered_ = gathers_ && shared_->waiting.size() < std::min(most_gathered, shared_->use.capacity / 2);
  if (!has_gathered_) shared_->work.notify_one();
}

void OutputQueue::pass_on() {
  if (!std::exchange(has_gathered_, false)) return;
  shared_->work.notify_one();
}

void OutputQueue::end_gathering() {
  gathers_ = false;
  pass_on();
}

bool OutputQueue::flush(const Patience& patience) {
  pass_on();
  std::unique_lock lock(shared_->mutex);
  return shared_->wait(lock, patience, [this] { return shared_->idle(); });
}

std::uint64_t OutputQueue::finish(const Patience& patience) {
  if (thread_.joinable()) (void)flush(patience);
  std::unique_lock lock(shared_->mutex);
  shared_->closing = true;
  if (!thread_.joinable()) return 0;
  std::uint64_t unread = 0;
  if (!shared_->idle()) {
    const std::string_view rest = std::string_view(shared_->batch).substr(shared_->written);
    unread = std::max<std::uint64_t>(1, shared_->unsaid + lines_in(shared_->waiting) + lines_in(rest));
  }
  shared_->waiting.clear();
  shared_->unsaid = 0;
  shared_->work.notify_one();
  // No reader: the thread stays blocked in write() until the process ends.
  const bool stuck = shared_->writing;
  lock.unlock();
  if (stuck) {
    thread_.detach();
  } else {
    thread_.join();
  }
  return unread;
}

bool OutputQueue::is_idle() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->idle();
}

int OutputQueue::error() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->error;
}

std::uint64_t OutputQueue::lost() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->lost;
}

}  // namespace canopus::cli
