#include "canopus/cli/run/run_output.hpp"

#include <cerrno>

#include <sys/stat.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"

namespace canopus::cli {
namespace {

/// Both standard streams are one terminal, pipe or file.
bool is_one_stream() {
  struct stat out {
  }, error{};
  if (::fstat(STDOUT_FILENO, &out) != 0 || ::fstat(STDERR_FILENO, &error) != 0) return false;
  return out.st_dev == error.st_dev && out.st_ino == error.st_ino;
}

}  // namespace

RunOutput::RunOutput(const Use& use)
    : out_(STDOUT_FILENO, {.lost_line = use.lost_line, .failed = [end = use.failed](int) { end(); }}) {
  if (!is_one_stream()) {
    const auto end_run = [end = use.failed](int error) {
      if (error == EPIPE) end();  // the rest cannot be printed
    };
    error_.emplace(STDERR_FILENO, OutputQueue::Use{.lost_line = use.lost_error_line,
                                                   .failed = end_run,
                                                   .capacity = std::size_t{1} << 18});
  }
  diversion_.emplace(out_, error_output());
}

void RunOutput::wait_for_reader(const std::function<bool()>& goes_on) {
  set_patience([goes_on](auto) { return goes_on(); });
}

void RunOutput::set_patience(const OutputQueue::Patience& patience) {
  out_.set_patience(patience);
  if (error_) error_->set_patience(patience);
}

void RunOutput::gather() {
  out_.gather();
  if (error_) error_->gather();
}

void RunOutput::pass_on() {
  out_.pass_on();
  if (error_) error_->pass_on();
}

void RunOutput::end_gathering() {
  out_.end_gathering();
  if (error_) error_->end_gathering();
}

int RunOutput::finish(const OutputQueue::Patience& patience) {
  const std::uint64_t unread = out_.finish(patience);
  const int error = out_.error();
  if (error_ && unread != 0) {
    error_->line("canopus: {} lost: the output was not read", ascii::counted(unread, "line"));
  }
  if (error_ && error != 0 && error != EPIPE) error_->line("canopus: {}", OutputFailed(error).what());
  const bool no_reader = error == EPIPE || (error_ && error_->error() == EPIPE);
  if (error_) (void)error_->finish(patience);
  diversion_.reset();
  if (no_reader) return reader_gone;
  return error == 0 ? written : failed;
}

}  // namespace canopus::cli
