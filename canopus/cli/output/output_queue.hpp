#pragma once
// A bounded queue of lines in front of a descriptor that may be slow or unread: a pipe, a stopped terminal. A
// thread of its own writes; a caller never waits for the reader, unless it asks for that. The thread starts
// with the first line: system calls and locks of a process with one thread cost less.
//
//   print -> waiting lines (at most `capacity` octets) -> thread -> descriptor
//
// Lines that do not fit are counted, and a line with the count is printed in their place as soon as the
// reader continues. The descriptor's flags stay unchanged: other processes may share it, and O_NONBLOCK would
// affect them, too.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "canopus/cli/output/print.hpp"

namespace canopus::cli {

class OutputQueue final : public Output {
 public:
  struct Use {
    /// Returns the line (with its end) for this number of lost lines. Called by the thread.
    std::function<std::string(std::uint64_t lines)> lost_line{};
    /// The descriptor cannot be written any more; `error` is errno. Called by the thread, once.
    std::function<void(int error)> failed{};
    /// Octets that wait at most, in two buffers.
    std::size_t capacity = std::size_t{1} << 20;
  };
  /// Time since the reader took something -> whether to wait for it any longer.
  using Patience = std::function<bool(std::chrono::steady_clock::duration)>;

  OutputQueue(int descriptor, Use use);
  /// Does not wait for the reader: see finish().
  ~OutputQueue() override;

  /// From now on a line that does not fit waits, as long as the patience lasts; without one it is lost at once.
  void set_patience(Patience patience) { patience_ = std::move(patience); }
  /// From now on the thread is woken by pass_on(), not by each line: a wake costs more than a line.
  void gather() { gathers_ = true; }
  /// Wakes the thread to write the gathered lines.
  void pass_on();
  /// Ends gathering: each line wakes the thread again.
  void end_gathering();
  /// Waits until everything is written, as long as the patience lasts, and ends the thread. Lines printed
  /// later are lost. Returns the number of lost lines that no line has reported.
  std::uint64_t finish(const Patience& patience);
  /// Waits until everything is written. False: the patience ended first.
  bool flush(const Patience& patience);

  /// No line is waiting.
  [[nodiscard]] bool is_idle() const;
  /// errno of the write that failed; 0: none did.
  [[nodiscard]] int error() const;
  /// Lines lost so far, reported or not.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  struct Shared;
  void write(std::string_view text) override;
  void start_thread();

  std::shared_ptr<Shared> shared_;  // the thread's, too: it may be stuck in the kernel when this one goes
  std::thread thread_;
  Patience patience_;
  bool gathers_ = false;
  bool has_gathered_ = false;
};

}  // namespace canopus::cli
