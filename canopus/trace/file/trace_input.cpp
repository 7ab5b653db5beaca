#include "canopus/trace/file/trace_input.hpp"

#include <algorithm>
#include <cerrno>
#include <memory>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

namespace canopus::trace {
namespace {

constexpr std::size_t read_size = 65536;

struct Descriptor {
  explicit Descriptor(int opened) : number(opened) {}
  ~Descriptor() {
    if (number > STDIN_FILENO) (void)::close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number;
};

bool is_pipe(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISFIFO(status.st_mode);
}

/// Reads a file or pipe; it waits for a pipe only while `keep_reading` returns true.
class FileSource {
 public:
  FileSource(int number, std::string silent_name, KeepReading keep_reading)
      : file_(std::make_shared<Descriptor>(number)),
        silent_name_(std::move(silent_name)),
        keep_reading_(std::move(keep_reading)) {}

  std::expected<std::size_t, int> operator()(std::span<char> bytes) {
    constexpr int asked_every = 100;  // ms
    while (keep_reading_ == nullptr || keep_reading_({})) {
      pollfd wanted{.fd = file_->number, .events = POLLIN, .revents = 0};
      const int ready = ::poll(&wanted, 1, asked_every);
      if (ready == 0) {
        const std::string name = std::exchange(silent_name_, {});
        if (!name.empty() && keep_reading_ != nullptr && !keep_reading_(name)) break;
        continue;
      }
      const ssize_t size = ready < 0 ? -1 : ::read(file_->number, bytes.data(), bytes.size());
      if (size < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (size < 0) return std::unexpected(errno);
      silent_name_.clear();
      return static_cast<std::size_t>(size);
    }
    return 0;
  }

 private:
  std::shared_ptr<Descriptor> file_;  // a std::function can be copied
  std::string silent_name_;           // empty: it is no named pipe, or has been written to
  KeepReading keep_reading_;
};

}  // namespace

std::expected<TraceInput, std::string> TraceInput::open(const std::string& path, KeepReading keep_reading) {
  const bool standard_input = path == "-";
  // Else the call would wait here until another program opens the pipe for writing.
  constexpr int flags = O_RDONLY | O_CLOEXEC | O_NONBLOCK;
  const int number = standard_input ? STDIN_FILENO : ::open(path.c_str(), flags);
  if (number < 0) {
    return std::unexpected(path + ": cannot open the trace: " + std::generic_category().message(errno));
  }
  return TraceInput(
      standard_input ? "<stdin>" : path,
      FileSource(number, !standard_input && is_pipe(number) ? path : std::string(), std::move(keep_reading)));
}

TraceInput TraceInput::from_memory(std::string name, std::string bytes) {
  return {std::move(name),
          [bytes = std::move(bytes),
           at = std::size_t{0}](std::span<char> out) mutable -> std::expected<std::size_t, int> {
            const std::size_t size = std::min(out.size(), bytes.size() - at);
            std::copy_n(bytes.data() + at, size, out.data());
            at += size;
            return size;
          }};
}

std::optional<std::string> TraceInput::failure() const {
  if (error_ == 0) return std::nullopt;
  return name_ + ": cannot read the trace: " + std::generic_category().message(error_);
}

bool TraceInput::fill() {
  if (at_end_) return false;
  if (begin_ > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  if (buffer_.size() < end_ + read_size) buffer_.resize(end_ + read_size);
  const auto size = source_(std::span(buffer_).subspan(end_));
  if (!size) error_ = size.error();
  at_end_ = !size || *size == 0;
  if (!at_end_) end_ += *size;
  return !at_end_;
}

std::string_view TraceInput::buffered() const noexcept { return {buffer_.data() + begin_, end_ - begin_}; }

std::string_view TraceInput::peek(std::size_t size) {
  while (end_ - begin_ < size && fill()) {
  }
  return buffered();
}

std::string_view TraceInput::peek_more() {
  (void)fill();
  return buffered();
}

bool TraceInput::skip(std::uint64_t size) {
  while (true) {
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(size, end_ - begin_));
    begin_ += part;
    offset_ += part;
    size -= part;
    if (size == 0) return true;
    if (!fill()) return false;
  }
}

std::optional<std::string_view> TraceInput::line(char end) {
  std::size_t searched = 0;
  cut_ = false;
  while (true) {
    const std::string_view ahead = buffered();
    const std::size_t line_end = ahead.find(end, searched);
    if (line_end != std::string_view::npos && line_end <= trace_max_line) {
      begin_ += line_end + 1;
      offset_ += line_end + 1;
      ++line_number_;
      std::string_view found = ahead.substr(0, line_end);
      if (found.ends_with('\r')) found.remove_suffix(1);
      return found;
    }
    if (ahead.size() > trace_max_line) break;
    searched = ahead.size();
    if (!fill()) {
      const std::string_view last = buffered();  // fill() may have moved it
      if (last.empty()) return std::nullopt;
      begin_ = end_;
      offset_ += last.size();
      ++line_number_;
      return last;
    }
  }
  // the rest of a line that is too long goes by unseen; its begin is gone with it
  cut_ = true;
  ++line_number_;
  while (true) {
    const std::string_view ahead = buffered();
    const std::size_t line_end = ahead.find(end);
    (void)skip(line_end == std::string_view::npos ? ahead.size() : line_end + 1);
    if (line_end != std::string_view::npos || !fill()) return std::string_view{};
  }
}

}  // namespace canopus::trace
